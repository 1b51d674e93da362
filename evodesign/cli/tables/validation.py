"""What was measured beside statics and predictions, as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import fmean

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.human.measured_posture import HumanPosture
from evodesign.validation.agreement import WAYS, Agreement, Agreements, agreements
from evodesign.validation.compare import POSTURES, ComparedCase
from evodesign.validation.holds import LOAD, SOMEONE, ComparedHold, hold_differences
from evodesign.validation.measured import HANGING, HOLDING
from evodesign.validation.posed import Posed

COLUMNS = ("statics", "predicted", "least torque")
"""In the order of `WAYS`."""

EXPLAINED = (
    "statics: ours in the measured postures; predicted: a still hold at this height\n"
    'with posture = "measured"; least torque: with posture = "least_torque"'
)

SHOWN = {"trunk_up": "upper trunk", "knee": "knee", "arm": "upper arm", "elbow": "elbow"}
"""Angles of holds that find room."""


def validation_tables(
    compared: Sequence[ComparedCase], holds: Sequence[ComparedHold]
) -> Iterator[FittedTable]:
    """Of each lift its moments by height and how far all figures agree; then holds, where there are any."""
    found = agreements(compared)
    for lift in dict.fromkeys(each.case.lift for each in compared):
        yield _moments(lift, [each for each in compared if each.case.lift == lift])
        own = [each for each in found if each.lift == lift]
        if own:
            yield _agreements(lift, own)
    if holds:
        yield _holds(holds)


def _moments(lift: str, compared: Sequence[ComparedCase]) -> FittedTable:
    table = titled(
        f"{lift}: moment at L5/S1 [N m], means by height",
        [*names("hands"), *numbers("wrists [m]", "cases", "measured", *COLUMNS)],
        keys=2,
        caption=EXPLAINED,
    )
    order = sorted(compared, key=lambda each: (each.case.hands == HANGING, each.case.hands, each.case.bin))
    rows: dict[tuple[str, str], list[ComparedCase]] = {}
    for each in order:
        rows.setdefault((each.case.hands, each.case.range), []).append(each)
    for (hands, heights), of in rows.items():
        known = [each.moments["l5s1"] for each in of if "l5s1" in each.moments]
        cells = [_mean([each.given(way) for each in of]) for way in WAYS]
        label = hands if hands == HOLDING else "empty"
        table.add_row(label, heights, len(of), _whole(fmean(known)) if known else "-", *cells)
    return table


def _mean(of: Sequence[Posed | None]) -> str:
    known = [each.moments["l5s1"] for each in of if each is not None]
    return _whole(fmean(known)) if known else "-"


def _agreements(lift: str, of: Sequence[Agreements]) -> FittedTable:
    table = titled(
        f"{lift}: slope against measurement and rms difference, {of[0].cases} cases with a box",
        [*names("quantity"), *numbers(*COLUMNS)],
    )
    for each in of:
        unit = {"degrees": "deg"}.get(each.unit, each.unit)
        table.add_row(each.quantity, *(_agreement(found, unit) for found in each.by_way))
    return table


def _agreement(found: Agreement | None, unit: str) -> str:
    if found is None:
        return "-"
    slope = "" if found.slope is None else f"{found.slope:.2f}, "
    return f"{slope}{found.off:.0f} {unit}"


def _holds(holds: Sequence[ComparedHold]) -> FittedTable:
    table = titled(
        "still holds: angles measured / predicted [degrees]",
        [*names("who"), *numbers("palms", *SHOWN.values())],
        caption=(
            "palms: height over stature\n"
            f"predicted: a man of {SOMEONE.stature:g} m and {SOMEONE.mass:g} kg who holds {LOAD:g} kg"
        ),
    )
    for each in holds:
        angles = each.predicted[HumanPosture.MEASURED] or {}
        pairs = [f"{_whole(each.measured.get(name))} / {_whole(angles.get(name))}" for name in SHOWN]
        table.add_row(f"{each.source} {each.who}", f"{each.eta:.2f}", *pairs)
    table.add_section()
    for kind, label in zip(POSTURES, COLUMNS[1:], strict=True):
        off = hold_differences(holds, kind)
        table.add_row(f"rms, {label}", "", *(_whole(off.get(name)) for name in SHOWN))
    return table


def _whole(number: float | None) -> str:
    return "-" if number is None else str(round(number))
