"""The shipped figures are those of the measurements; each file has its source and licence."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from importlib import resources
from pathlib import Path

import pytest

from evodesign.human.measured_posture import posture_rows
from evodesign.validation.compare import rows_without
from evodesign.validation.measured import BIN, EMPTY, HANGING, HOLDING, box_lifts, data_rows, shipped_cases
from tests.machine import leave_out

SHARED = Path(__file__).resolve().parents[3] / "shared" / "reference" / "measured"
FILES = sorted(
    entry.name for entry in resources.files("evodesign.validation").joinpath("data").iterdir()
)  # fmt: skip


def shared(name: str) -> Iterator[dict[str, str]]:
    if not (SHARED / name).exists():
        leave_out("measured people are not in the folder 'shared' beside the checkout")
    with (SHARED / name).open(encoding="utf-8") as file:
        yield from csv.DictReader(line for line in file if not line.startswith("#"))


@pytest.mark.parametrize("name", FILES)
def test_each_file_names_its_source_and_licence(name: str) -> None:
    text = resources.files("evodesign.validation").joinpath("data", name).read_text("utf-8")
    remarks = [line for line in text.splitlines() if line.startswith("#")]
    assert any(line.startswith("# source") for line in remarks)
    assert any(word in line for line in remarks for word in ("licence: ", "(Apache-2.0)"))
    assert len(text) < 10_000, "figures, not recordings"
    assert {*FILES} == {"box_lifts.csv", "settled_holds.csv", "stoop_lifts.csv"}


def test_cases_cover_their_ranges_of_height() -> None:
    cases = shipped_cases()
    assert len(cases) == 49
    for case in cases:
        for frame in case.frames:
            assert case.bin * BIN <= frame.wrist < (case.bin + 1) * BIN
            assert (frame.hand_force < 80.0) == (case.hands != HOLDING)
    assert {case.hands for case in cases} == {HOLDING, EMPTY, HANGING}


def test_box_lifts_are_those_of_the_measurements() -> None:
    given = {(row["subject"], row["bin"]): row for row in shared("boxlift_bins.csv")}
    names = {HOLDING: "box", EMPTY: "empty"}
    for case in box_lifts():
        label = "standing, no load" if case.hands == HANGING else f"{case.range} {names[case.hands]}"
        row, (frame,) = given[case.who.removeprefix("man "), label], case.frames
        assert (case.person.stature, case.person.mass) == (float(row["stature"]), float(row["mass"]))
        assert frame.wrist == pytest.approx(float(row["wrist_z"]), abs=5e-4)
        assert frame.moments["l5s1"] == pytest.approx(float(row["plate_L5S1"]), abs=0.06)
        assert frame.moments["knees"] == pytest.approx(float(row["plate_knee"]), abs=0.06)
        assert math.degrees(frame.features["trunk_up"]) == pytest.approx(
            float(row["trunk_up"]) + 2.5, abs=0.01
        )
        assert math.degrees(frame.features["knee"]) == pytest.approx(float(row["knee"]), abs=0.01)


def test_stoop_lifts_are_every_sixth_frame() -> None:
    rows = [*data_rows("stoop_lifts.csv")]
    for number in (1, 2):
        given = [*shared(f"stoop{number}.csv")][::6]
        own = [row for row in rows if row["recording"] == f"lift {number}"]
        assert len(own) == len(given)
        for row, other in zip(own, given, strict=True):
            assert float(row["time_s"]) == pytest.approx(float(other["t_s"]))
            assert row["l5s1_n_m"] == other["l5s1_bottom_up_n_m"]
            both = [float(other[f"wrist_{side}_x_m"]) for side in ("left", "right")]
            assert float(row["wrist_x_m"]) == pytest.approx(sum(both) / 2.0, abs=1e-4)


def test_with_nobody_left_out_the_measured_postures_are_those_of_the_data_file() -> None:
    again = [row for row in rows_without("nobody") if row.source == "boxlift"]
    given = [row for row in posture_rows() if row.source == "boxlift"]
    assert [row.quantity for row in given] == [row.quantity for row in again]
    for row, other in zip(given, again, strict=True):
        digits = 6e-5 if row.quantity == "ahead" else 0.012
        assert (row.mean, row.deviation) == pytest.approx((other.mean, other.deviation), abs=digits)
        assert row.eta == pytest.approx(other.eta, abs=6e-4)
        assert row.people == other.people


def test_a_man_who_is_left_out_counts_no_more() -> None:
    people = {row.people for row in rows_without("man 4") if row.source == "boxlift"}
    assert people == {3, 4}
