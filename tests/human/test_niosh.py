"""The lifting equation against the manual's worked examples, and written again in inches and pounds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.human.niosh import Coupling, Duration, LiftingTask, multipliers

INCH, POUND = 0.0254, 0.45359237

FREQUENCY_ROWS = """
0.2 1.00 1.00  .95  .95  .85  .85
0.5  .97  .97  .92  .92  .81  .81
1    .94  .94  .88  .88  .75  .75
2    .91  .91  .84  .84  .65  .65
3    .88  .88  .79  .79  .55  .55
4    .84  .84  .72  .72  .45  .45
5    .80  .80  .60  .60  .35  .35
6    .75  .75  .50  .50  .27  .27
7    .70  .70  .42  .42  .22  .22
8    .60  .60  .35  .35  .18  .18
9    .52  .52  .30  .30  .00  .15
10   .45  .45  .26  .26  .00  .13
11   .41  .41  .00  .23  .00  .00
12   .37  .37  .00  .21  .00  .00
13   .00  .34  .00  .00  .00  .00
14   .00  .31  .00  .00  .00  .00
15   .00  .28  .00  .00  .00  .00
"""
"""Table 5 as it is laid out: for each duration, V below 30 inches and from there on."""

TABLE_5 = np.array([[float(entry) for entry in row.split()] for row in FREQUENCY_ROWS.split("\n") if row])


def pounds(
    horizontal: float,
    vertical: float,
    travel: float,
    angle: float,
    lifts: float,
    column: int,
    coupling: tuple[float, float],
) -> float:
    """The limit [lb] in the manual's other units [in], written independently."""
    if horizontal > 25.0 or vertical > 70.0 or travel > 70.0 or angle > 135.0:
        return 0.0
    high = vertical >= 30.0
    factor = float(np.interp(lifts, TABLE_5[:, 0], TABLE_5[:, 1 + 2 * column + high]))
    return (
        51.0
        * min(1.0, 10.0 / max(horizontal, 1e-9))
        * (1.0 - 0.0075 * abs(vertical - 30.0))
        * (0.82 + 1.8 / max(travel, 10.0))
        * (1.0 - 0.0032 * angle)
        * factor
        * coupling[high]
    )


FAIR = (0.95, 1.0)
EXAMPLES = (
    # example 4, package inspection: origin and destination
    (10.0, 22.0, 37.0, 0.0, 3.0, 0, FAIR, 34.9),
    (20.0, 59.0, 37.0, 0.0, 3.0, 0, FAIR, 15.2),
)
"""H, V, D [in], A [degrees], lifts per minute, duration's column, coupling, printed limit [lb].

The print (Figure 14, page 46) multiplies factors rounded to two places; read in a public transcription of the
manual (nbarr1/ErgonomicTool). No other example could be read.
"""


@pytest.mark.parametrize("example", EXAMPLES)
def test_the_manuals_worked_examples_come_out(example: tuple[float, ...]) -> None:
    *inputs, printed = example
    horizontal, vertical, travel, angle, lifts, _, _ = inputs
    customary = pounds(*inputs)
    assert customary == pytest.approx(printed, abs=0.4)
    task = LiftingTask(
        horizontal * INCH, vertical * INCH, angle, travel * INCH, lifts, Duration.SHORT, Coupling.FAIR
    )
    assert multipliers(task).recommended_weight == pytest.approx(customary * POUND, rel=0.05)


@given(
    st.floats(0.05, 0.60),
    st.floats(0.0, 1.74),
    st.floats(0.0, 1.7),
    st.floats(0.0, 134.0),
    st.floats(0.0, 8.0),
    st.sampled_from(list(Duration)),
    st.sampled_from([(Coupling.GOOD, (1.0, 1.0)), (Coupling.FAIR, FAIR), (Coupling.POOR, (0.9, 0.9))]),
)
def test_metric_and_customary_forms_agree_within_the_rounding_of_their_constants(
    horizontal: float,
    vertical: float,
    travel: float,
    angle: float,
    lifts: float,
    duration: Duration,
    coupling: tuple[Coupling, tuple[float, float]],
) -> None:
    """Not exactly: 25 cm are not 10 inches, and 51 lb weigh 23.13 kg. Near 75 cm the two change columns."""
    if 0.745 < vertical < 0.77:
        vertical = 0.80
    task = LiftingTask(horizontal, vertical, angle, travel, lifts, duration, coupling[0])
    column = list(Duration).index(duration)
    other = pounds(horizontal / INCH, vertical / INCH, travel / INCH, angle, lifts, column, coupling[1])
    assert multipliers(task).recommended_weight == pytest.approx(other * POUND, rel=0.05)


def test_the_best_place_for_a_load_is_close_at_knuckle_height() -> None:
    found = multipliers(LiftingTask(0.25, 0.75, coupling=Coupling.GOOD))
    assert found.recommended_weight == pytest.approx(23.0)
    assert multipliers(LiftingTask(0.10, 0.75)).horizontal == 1.0


def test_a_load_held_still_counts_as_the_shortest_travel_and_the_rarest_lift() -> None:
    found = multipliers(LiftingTask(0.50, 1.25))
    assert (found.distance, found.frequency, found.coupling) == (pytest.approx(1.0), 1.0, 0.90)
    assert found.recommended_weight == pytest.approx(23.0 * 0.5 * 0.85 * 0.90)


@pytest.mark.parametrize(
    "task",
    [
        LiftingTask(0.64, 1.0),
        LiftingTask(0.40, 1.76),
        LiftingTask(0.40, -0.01),
        LiftingTask(0.40, 1.0, asymmetry=136.0),
        LiftingTask(0.40, 1.0, travel=1.76),
        LiftingTask(0.40, 1.0, frequency=16.0),
        LiftingTask(0.40, 0.7, frequency=8.5, duration=Duration.LONG),
        LiftingTask(0.40, 1.0, frequency=12.5, duration=Duration.MODERATE),
    ],
)
def test_beyond_the_equations_limits_nothing_is_recommended(task: LiftingTask) -> None:
    assert multipliers(task).recommended_weight == 0.0


def test_every_row_of_the_frequency_table_is_read() -> None:
    for lifts, *row in TABLE_5:
        for place, printed in enumerate(row):
            duration = list(Duration)[place // 2]
            task = LiftingTask(0.3, 0.8 if place % 2 else 0.7, frequency=lifts, duration=duration)
            assert multipliers(task).frequency == pytest.approx(printed)
    assert multipliers(LiftingTask(0.3, 0.8, frequency=2.4)).frequency == pytest.approx(0.898)
