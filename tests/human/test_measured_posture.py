"""The data of measured postures: each row with its source, and computed again from what was measured."""

from __future__ import annotations

import csv
import math
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import DEFAULT_JOINTS, human_tree
from evodesign.human.measured_posture import (
    ASSUMPTION,
    FEATURES,
    NEEDED_JOINTS,
    NEEDED_LINKS,
    PostureRow,
    measured_posture,
    posture_rows,
)
from tests.machine import leave_out

MEASURED = Path(__file__).resolve().parents[3] / "shared" / "reference" / "measured"

BINS = ("0.15-0.30 empty", "0.30-0.45 box", "0.45-0.60 box", "0.60-0.75 box", "0.75-0.90 box")
HAND = 0.0495
"""From wrist to palm, over stature: that of the generated man."""

LEAN = 2.5
"""Of the whole body in quiet standing [degrees]: what is measured is the change from there."""

JOINT_FEATURES = ("trunk_low", "trunk_up", "knee", "shank", "arm", "elbow", "ahead")


def box_lifts() -> list[dict[str, str]]:
    path = MEASURED / "boxlift_bins.csv"
    if not path.exists():
        leave_out("measured people are not in the folder 'shared' beside the checkout")
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def features_of(row: dict[str, str]) -> dict[str, float]:
    """Of a man at a height, as the data file has them; palms from the wrist along the forearm."""
    stature, fore = float(row["stature"]), math.radians(float(row["arm"]) + float(row["elbow"]))
    return {
        "eta": float(row["wrist_z"]) / stature - HAND * math.cos(fore),
        "trunk_low": float(row["trunk_low"]) + LEAN,
        "trunk_up": float(row["trunk_up"]) + LEAN,
        "knee": float(row["knee"]),
        "shank": float(row["ankle"]) + LEAN,
        "arm": float(row["arm"]),
        "elbow": float(row["elbow"]),
        "ahead": float(row["wrist_x"]) / stature + HAND * math.sin(fore),
    }


def rows_without(subject: str | None) -> list[PostureRow]:
    """The data file's rows with those of the box lifts computed anew, without one of the men."""
    men = [row for row in box_lifts() if row["subject"] != subject]
    by_bin = [[features_of(row) for row in men if row["bin"] == name] for name in BINS]
    spread = {
        name: float(np.sqrt(np.mean([np.var([man[name] for man in of], ddof=1) for of in by_bin])))
        for name in JOINT_FEATURES
    }
    found = []
    for of in by_bin:
        mean = {name: float(np.mean([man[name] for man in of])) for name in of[0]}
        found += [
            PostureRow(name, "both", mean["eta"], mean[name], spread[name], len(of), "measured", "boxlift")
            for name in JOINT_FEATURES
        ]
        found.append(PostureRow("sideways", "both", mean["eta"], 0.15, 0.2, 0, ASSUMPTION, "none"))
    return [*found, *(row for row in posture_rows() if row.task != "both" or math.isnan(row.eta))]


def test_the_rows_of_the_box_lifts_are_the_means_of_the_men() -> None:
    again = [row for row in rows_without(None) if row.source == "boxlift"]
    given = [row for row in posture_rows() if row.source == "boxlift"]
    assert [row.quantity for row in given] == [row.quantity for row in again]
    for row, other in zip(given, again, strict=True):
        digits = 6e-5 if row.quantity == "ahead" else 6e-3
        assert row.eta == pytest.approx(other.eta, abs=6e-4)
        assert (row.mean, row.deviation) == pytest.approx((other.mean, other.deviation), abs=digits)
        assert row.people == other.people


def test_settled_rows_are_those_that_were_recommended() -> None:
    box_lifts()
    with (MEASURED / "holding_posture.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        recommended = {
            (row["feature"], float(row["eta"])): (float(row["mean"]), float(row["sd"]))
            for row in rows
            if row["source"].startswith("RECOMMENDED")
        }
    holds = {
        (row.quantity, row.eta): (row.mean, row.deviation)
        for row in posture_rows()
        if row.task == "hold" and row.quantity in JOINT_FEATURES
    }
    assert holds == recommended


def test_each_row_says_what_supports_it_and_its_source_is_described() -> None:
    text = resources.files("evodesign.human").joinpath("data", "measured_posture.csv").read_text("utf-8")
    described = {
        line.split(":")[0].removeprefix("# source ") for line in text.splitlines() if "# source " in line
    }
    for row in posture_rows():
        assert row.source in described
        assert row.task in {"hold", "lift", "both"}
        assert (row.support == ASSUMPTION) == (row.people == 0) == (row.source == "none")
        assert (row.support == "few") == (1 <= row.people <= 3)


@pytest.mark.parametrize("task", ["hold", "lift"])
def test_every_knot_has_all_features_and_a_covariance(task: str) -> None:
    """Inverted anew: deviations and correlations come back."""
    own = [row for row in posture_rows() if row.task in (task, "both") and not math.isnan(row.eta)]
    given = getattr(measured_posture(1.75), task)
    for knot, precision in zip(given.knots, given.precisions, strict=True):
        rows = {row.quantity: row for row in own if row.eta == knot}
        covariance = np.linalg.inv(np.array(precision))
        deviation = np.sqrt(np.diag(covariance))
        assert np.linalg.eigvalsh(covariance).min() > 0.0
        for i, name in enumerate(FEATURES):
            unit = 1.0 if name in ("ahead", "sideways") else math.radians(1.0)
            assert deviation[i] == pytest.approx(unit * rows[name].deviation)
            for j, other in enumerate(FEATURES[:i]):
                pair = rows.get(f"{other} {name}") or rows.get(f"{name} {other}")
                expected = 0.0 if pair is None else pair.mean
                assert covariance[i, j] / deviation[i] / deviation[j] == pytest.approx(expected, abs=1e-9)


def test_the_generated_person_has_what_features_need() -> None:
    tree = human_tree(Person(1.75, 75.0, Sex.FEMALE))
    assert set(NEEDED_JOINTS) <= set(DEFAULT_JOINTS)
    assert set(NEEDED_LINKS) <= set(tree.link_by_name)
    bare = {name.replace("jLeft", "j").replace("jRight", "j") for name in DEFAULT_JOINTS}
    assert set(measured_posture(1.75).joints) <= bare
