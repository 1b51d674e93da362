"""A lift as tables for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from evodesign.cli.output import rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.motion.solution import LiftSolution


def lift_tables(title: str, solutions: Mapping[tuple[str, str], LiftSolution]) -> Iterator[FittedTable]:
    """What a lift takes of robot and person, then torques over time.

    Args:
        title: of the design.
        solutions: by names of person and load.
    """
    for pair, solution in solutions.items():
        words = [title, *(name for name in pair if name), f"{solution.lift}"]
        yield _efforts(", ".join(words), solution)
        if solution.course is not None:
            yield _over_time(solution)


def _efforts(title: str, solution: LiftSolution) -> FittedTable:
    headers = ["mean torque [N m]", "peak torque [N m]", "static share", "work [J]", "peak power [W]"]
    disturbances = {name: None for effort in solution.efforts.values() for name in effort.disturbed}
    headers += [f"peak torque, {name} [N m]" for name in disturbances]
    table = titled(title, [*names("agent"), *numbers(*headers)], caption=_caption(solution))
    for name, effort in solution.efforts.items():
        found = [effort.mean_torque, effort.peak_torque, effort.static_share, effort.work, effort.power.max()]
        found += [effort.disturbed[disturbance].max() for disturbance in disturbances]
        table.add_row(name, *found)
    return table


def _caption(solution: LiftSolution) -> str:
    if solution.checked is None:
        return f"{solution.status}: {solution.reason}"
    checked = solution.checked
    largest = max(checked.between, key=lambda name: checked.between[name])
    residuals = f"largest residual {max(checked.knots.values()):.1e} at {solution.lift.knots} knots"
    residuals += f", {checked.between[largest]:.1e} between them ({largest})"
    energy = f"energy gained {checked.energy:.4g} J, work off by {100.0 * checked.energy_error:.2g} %"
    why = "" if solution.solved else f": {solution.reason}"
    least = "" if solution.least is None else f"; least time {solution.least.seconds:.4g} s"
    return f"{solution.status}{why}; {residuals}; {energy}{least}"


def _over_time(solution: LiftSolution) -> FittedTable:
    headers = [f"{name} torque [N m]" for name in solution.efforts]
    table = titled("over time", [*numbers("time [s]", "height [m]", *headers)])
    course, every = solution.course, max(1, (len(solution.times) - 1) // 11)
    heights = () if course is None else tuple(course.heights(solution.times))
    for place in range(0, len(heights), every):
        torques = [rounded(effort.torques[place]) for effort in solution.efforts.values()]
        table.add_row(f"{solution.times[place]:.2f}", f"{heights[place]:.3f}", *torques)
    return table
