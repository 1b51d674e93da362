"""Which limits hold the postures of a design, and what they cost, as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import ActiveLimit, CaseDetail

TITLE = "limits that are active, and by how many N m each step more changes the effort"

MOST_COLUMNS = 6
"""Cases that have a column each."""

CAPTION = (
    "effort: root of the least weighted sum of squared torques (docs/model.md)\n"
    "negative: a larger value saves; of a pair of joints, the price of both"
)

Identity = tuple[str, str, str, bool]


def limits_table(cases: Sequence[CaseDetail]) -> FittedTable:
    """A row for each limit that is active in some of the cases, those of the largest price first."""
    by_case = [{limit.identity: limit for limit in case.limits} for case in cases]
    known = {identity: limit for limits in by_case for identity, limit in limits.items()}
    changes: dict[Identity, list[float | None]] = {
        identity: [_change(limits, identity) for limits in by_case] for identity in known
    }
    few = len(cases) <= MOST_COLUMNS
    measured = (
        numbers(*(case.case.name for case in cases)) if few else numbers("active in", "mean", "largest")
    )
    table = titled(TITLE, [*names("agent", "limit", "step"), *measured], keys=3, caption=CAPTION)
    for agent in dict.fromkeys(limit.agent for limit in known.values()):
        own = [identity for identity in known if identity[0] == agent]
        own.sort(key=lambda identity: -max(abs(change or 0.0) for change in changes[identity]))
        for identity in own:
            limit, found = known[identity], changes[identity]
            cells = [_text(change) for change in found] if few else _summary(found)
            table.add_row(agent or "both", limit.words, limit.step[1], *cells)
        table.add_section()
    return table


def _change(limits: Mapping[Identity, ActiveLimit], identity: Identity) -> float | None:
    limit = limits.get(identity)
    return None if limit is None else limit.change_n_m


def _summary(changes: Sequence[float | None]) -> list[str]:
    """In how many cases, and the mean and largest change of these."""
    found = [change for change in changes if change is not None]
    mean = sum(found) / len(found)
    return [f"{len(found)} of {len(changes)}", _text(mean), _text(max(found, key=abs))]


def _text(change: float | None) -> str:
    return "-" if change is None else f"{change:+.2g}"
