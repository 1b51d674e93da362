"""The ranges that joints of the spine share, against the figures that their sources print."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from evodesign.human.anthropometry import Person, landmarks
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.body import DEFAULT_JOINTS, human_tree
from evodesign.human.coupled_joints import coupled_joints, rhythms, shared_ranges

SCALE = 0.5
"""One over the stature [m] of a person whose lengths are printed as fractions of it."""

TREE = human_tree(Person(1.75, 75.0, Sex.MALE))

MEASURED = {
    "lower_lumbar_flexion": ((20.6, 13.3), (35.0, 10.0)),
    "upper_lumbar_flexion": ((8.9, 11.1), (30.8, 9.9)),
    "lumbar_flexion": ((29.0, 0.0), (73.0, 0.0)),
    "lumbar_bending": ((28.0, 0.0), (28.0, 0.0)),
    "thoracic_flexion": ((8.7, 3.7), (11.5, 3.7)),
}
"""Mean and standard deviation in the negative and the positive direction [degrees], as printed."""


def test_a_range_is_a_mean_widened_by_one_standard_deviation() -> None:
    found = {each.name: (each.lower, each.upper) for each in coupled_joints()}
    for name, ((back, spread), (ahead, other)) in MEASURED.items():
        expected = (-math.radians(back + spread), math.radians(ahead + other))
        assert found.pop(name) == pytest.approx(expected)
    assert not found


def test_sources_print_the_figures_that_ranges_are_made_of() -> None:
    ranges = shared_ranges()
    assert {each.source for each in (*ranges.ranges, *ranges.rhythms)} == set(ranges.sources)
    for each in ranges.ranges:
        printed = re.findall(r"\d+(?:\.\d+)?", ranges.sources[each.source])
        for figure in (part for pair in MEASURED[each.name] for part in pair if part):
            assert {f"{figure:g}", f"{figure:.1f}"} & set(printed), (each.name, figure)


LEVELS = {
    "lumbar_flexion": (0.125, 0.185, 0.204, 0.231, 0.255),
    "lumbar_bending": (0.1356, 0.1812, 0.2452, 0.25, 0.188),
}
"""Shares of L5/S1, L4/L5, L3/L4, L2/L3 and L1/L2, as the authors' model has them."""


def test_shares_are_those_of_the_levels_that_a_joint_stands_for() -> None:
    """Each level goes to the joint of ours at its place; one between two of ours half to each."""
    printed = re.findall(r"0\.\d+", shared_ranges().sources["christophy_2012"])
    for each in rhythms():
        l5s1, l4l5, l3l4, l2l3, l1l2 = LEVELS[each.name]
        assert {f"{level:g}" for level in LEVELS[each.name]} <= set(printed)
        expected = (l5s1 + l4l5 / 2.0, l4l5 / 2.0 + l3l4 + l2l3 / 2.0, l2l3 / 2.0 + l1l2)
        assert each.shares == pytest.approx(expected, abs=1e-12)
        assert sum(each.shares) == pytest.approx(1.0, abs=1e-12)


def test_a_rhythm_ends_where_the_first_shared_range_of_its_joints_ends() -> None:
    """Bisected: as far as the movement goes with every shared range kept, and no farther."""
    for each in rhythms():

        def kept(movement: float, shares: dict[str, float]) -> bool:
            sums = [(r, sum(shares.get(n, 0.0) for n in r.joints) * movement) for r in coupled_joints()]
            return all(r.lower <= total <= r.upper for r, total in sums)

        shares = dict(zip(each.joints, each.shares, strict=True))
        for end in (each.lower, each.upper):
            assert kept(end * (1.0 - 1e-9), shares)
            assert not kept(end * (1.0 + 1e-6), shares)


def test_shared_ranges_are_of_moving_joints_about_one_axis_and_hold_less_than_their_sums() -> None:
    for each in coupled_joints():
        joints = [TREE.joint_by_name[name] for name in each.joints]
        assert set(each.joints) <= set(DEFAULT_JOINTS)
        assert len({joint.axis for joint in joints}) == 1
        assert each.lower < 0.0 < each.upper
        assert sum(joint.upper for joint in joints) > each.upper


def test_the_page_of_the_person_prints_the_ranges_and_the_widths_that_are_used(repository: Path) -> None:
    lines = (repository / "docs" / "person.md").read_text(encoding="utf-8").splitlines()
    for each in shared_ranges().ranges:
        lower, upper = (f"{limit:.1f}" for limit in each.range_deg)
        assert f"| {each.name} | {' + '.join(each.joints)} | {lower} | {upper} | {each.source} |" in lines
    for each in rhythms():
        shares = " | ".join(f"{share:.4f}" for share in each.shares)
        assert f"| {each.name} | {shares} | christophy_2012 |" in lines
    for width in ShoulderWidth:
        points = landmarks(Person(1.0 / SCALE, 70.0, Sex.MALE, width))
        joints, span = (2.0 * SCALE * points[name][1] for name in ("LeftUpperArm", "LeftFingertip"))
        (line,) = [line for line in lines if f'`"{width}"`' in line and line.startswith("| ")]
        assert line.endswith(f"| {joints:.3f} | {span:.3f} |")
