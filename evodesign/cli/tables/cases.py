"""One design's postures in short, as tables for people."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.records import Assessment, CaseOutcome, Lift, Status


def case_tables(assessment: Assessment, remark: str = "") -> list[FittedTable]:
    """A design's postures in short, height by height; of several people or loads a summary, then each case.

    Args:
        assessment: of the design.
        remark: what follows the title of the cases.
    """
    if any(outcome.case.label for outcome in assessment.cases):
        title = f"the load in each case, torques in N m{remark}"
        return [summary_table(assessment), cases_table(assessment, title)]
    return [cases_table(assessment, f"the load at each height{remark}")]


def cases_table(assessment: Assessment, title: str) -> FittedTable:
    """A row for each case; of a lift the largest torques count."""
    outcomes = assessment.cases
    labels, moves = _name_columns(outcomes), any(isinstance(each.case.task, Lift) for each in outcomes)
    roles, unit = _roles(outcomes), "" if labels else " [N m]"
    height = "height" if labels else "load" if moves else "height [m]"
    found = (
        height,
        *(f"{role} |tau|{unit}" for role in roles),
        *(() if labels else ("iterations",)),
        "residual",
    )
    columns = [*names(*labels), *numbers(*found), *names("status")]
    table = titled(title, columns, keys=len(labels) + 1)
    for outcome, following in zip(outcomes, (*outcomes[1:], None), strict=False):
        iterations = [] if labels else [str(outcome.iterations)]
        table.add_row(
            *(name_of(outcome) for name_of in labels.values()),
            _height(outcome) if labels or moves else outcome.case.task.heights[0],
            *(_undisturbed(outcome, role) for role in roles),
            *iterations,
            "-" if outcome.residual is None else f"{outcome.residual:.1e}",
            outcome.status if outcome.status is Status.SOLVED else f"{outcome.status}: {outcome.reason}",
        )
        for name, norms in outcome.disturbed.items():
            own = [norms.get(role) for role in roles]
            blank = ["" for _ in iterations]
            table.add_row(*("" for _ in labels), "", *own, *blank, "", f"under '{name}'")
        if following is not None and outcome.case.pair != following.case.pair:
            table.add_section()
    return table


def summary_table(assessment: Assessment) -> FittedTable:
    """Torque norms [N m] over all cases, and over those with each person or load, or at each height.

    Torques under disturbances count as the objectives count them, each beside the undisturbed one.
    """
    outcomes = assessment.cases
    measured = (column for role in _roles(outcomes) for column in (f"{role} mean", "worst"))
    columns = [*names("cases"), *numbers("solved", *measured)]
    table = titled("torque norms |tau| over the cases [N m]", columns)
    roles = _roles(outcomes)
    _add_summary(table, "all", outcomes, roles, last=True)
    groups = [*_name_columns(outcomes).values(), _height]
    for name_of in groups:
        found = [*dict.fromkeys(name_of(outcome) for outcome in outcomes)]
        for name in found:
            same = [outcome for outcome in outcomes if name_of(outcome) == name]
            _add_summary(table, name, same, roles, last=name == found[-1])
    return table


def _add_summary(
    table: FittedTable, name: str, outcomes: Sequence[CaseOutcome], roles: Sequence[str], *, last: bool
) -> None:
    solved = [outcome for outcome in outcomes if outcome.status is Status.SOLVED]
    measured = [
        number
        for role in roles
        for number in _mean_and_worst([norm for outcome in solved for norm in _norms(outcome, role)])
    ]
    share = f"{len(solved)} of {len(outcomes)}"
    table.add_row(name, share, *measured, end_section=last)


def _roles(outcomes: Sequence[CaseOutcome]) -> list[str]:
    """Whose torques there are; both where there are none."""
    known = [
        role for role in (ROBOT, HUMAN) if any(_undisturbed(each, role) is not None for each in outcomes)
    ]
    return known or [ROBOT, HUMAN]


def _undisturbed(outcome: CaseOutcome, role: str) -> float | None:
    return outcome.robot_torque_norm if role == ROBOT else outcome.human_torque_norm


def _norms(outcome: CaseOutcome, role: str) -> Iterator[float]:
    """Torque norms of those of a role in a case, undisturbed and disturbed."""
    undisturbed = _undisturbed(outcome, role)
    if undisturbed is not None:
        yield undisturbed
    yield from (norms[role] for norms in outcome.disturbed.values() if role in norms)


def _mean_and_worst(norms: Sequence[float]) -> Iterator[float | None]:
    yield sum(norms) / len(norms) if norms else None
    yield max(norms, default=None)


def _name_columns(outcomes: Sequence[CaseOutcome]) -> dict[str, Callable[[CaseOutcome], str]]:
    """Columns of names that tell cases apart, with what stands in them."""
    columns: dict[str, Callable[[CaseOutcome], str]] = {
        "person": lambda outcome: outcome.case.person,
        "load": lambda outcome: outcome.case.payload,
    }
    return {column: name for column, name in columns.items() if any(map(name, outcomes))}


def _height(outcome: CaseOutcome) -> str:
    return str(outcome.case.task)
