"""The generated person beside the published body of 48 joints: the tables of docs/person.md, computed again.

Both bodies stand in the T-pose (joint position zero). A segment runs from its first joint along one direction
to the next joint or, at the head, hands and toes, to the end of the shape that is seen; its centre of mass is
measured from the first joint along that direction.

Then the published body as the person of a user's problem, and the sources of the generated one.
"""

from __future__ import annotations

import functools
import json
import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.evaluation.evaluate import Evaluator
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import DEFAULT_JOINTS, human_tree
from evodesign.mechanics.agent import HUMAN, SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource, Status
from evodesign.tree.model import Look, Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.human.test_body import placements
from tests.problem.test_notes import strange
from tests.tree.test_icub_robot import reference_text

PUBLISHED = "human_subject04_48dof.urdf"
PERSON = Person(1.82, 72.7, Sex.MALE)
NOTICEABLE = 0.10
"""Share of the published figure past which a difference must have its reason in the table."""

FORWARD, OUTWARD, UP, DOWN = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
TRUNK = "trunk, these five and both shoulders"
HIP, TIP = "LeftUpperLeg", ""
"""The link at the hip's height, and the mark of a segment that ends with its last link's shape."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A row of the table: links from a first joint's link along a direction to an end."""

    name: str
    first: str
    end: str
    direction: tuple[float, float, float]
    links: tuple[str, ...]


SEGMENTS = (
    Segment("pelvis: hips to L5/S1", HIP, "L5", UP, ("Pelvis",)),
    Segment("L5: to joint L4/L3", "L5", "L3", UP, ("L5",)),
    Segment("L3: to joint L1/T12", "L3", "T12", UP, ("L3",)),
    Segment("T12: to joint T9/T8", "T12", "T8", UP, ("T12",)),
    Segment("T8: to joint T1/C7", "T8", "Neck", UP, ("T8",)),
    Segment(
        TRUNK,
        HIP,
        "Neck",
        UP,
        ("Pelvis", "L5", "L3", "T12", "T8", "LeftShoulder", "RightShoulder"),
    ),
    Segment("neck: to joint C1/head", "Neck", "Head", UP, ("Neck",)),
    Segment("head: to the vertex", "Head", TIP, UP, ("Head",)),
    Segment("shoulder (clavicle)", "LeftShoulder", "LeftUpperArm", OUTWARD, ("LeftShoulder",)),
    Segment("upper arm", "LeftUpperArm", "LeftForeArm", OUTWARD, ("LeftUpperArm",)),
    Segment("forearm", "LeftForeArm", "LeftHand", OUTWARD, ("LeftForeArm",)),
    Segment("hand: to the fingertip", "LeftHand", TIP, OUTWARD, ("LeftHand",)),
    Segment("thigh", "LeftUpperLeg", "LeftLowerLeg", DOWN, ("LeftUpperLeg",)),
    Segment("shank", "LeftLowerLeg", "LeftFoot", DOWN, ("LeftLowerLeg",)),
    Segment("foot and toes: ankle to toe tip", "LeftFoot", TIP, FORWARD, ("LeftFoot", "LeftToe")),
)


@dataclass(frozen=True, slots=True)
class Figures:
    """A segment's length [m], mass [kg] and centre of mass from its first joint [m]."""

    length: float
    mass: float
    center: float


@functools.cache
def bodies() -> tuple[Tree, Tree]:
    """The generated person and the published one."""
    return human_tree(PERSON), read_urdf(reference_text(PUBLISHED), PUBLISHED, InertiaRule.FILE)


def half_extent(look: Look, direction: Sequence[float]) -> float:
    """How far a shape reaches from its centre along a direction of its link [m]."""
    along = np.array(look.link_from_look.rotation).T @ np.array(direction)
    match look.shape:
        case Sphere(radius):
            return float(radius)
        case Box(x, y, z):
            return float(np.abs(along) @ np.array([x, y, z])) / 2.0
        case Cylinder(radius, length):
            return float(radius * math.hypot(along[0], along[1]) + abs(along[2]) * length / 2.0)
    raise TypeError(look)


def tip(tree: Tree, at: Mapping[str, Placement], link: str, direction: Sequence[float]) -> float:
    """Where the shapes of a link end along a direction of the root (whose axes all links share) [m]."""
    looks = tree.link_by_name[link].looks
    return max(
        float(np.dot(at[link].apply(look.link_from_look.translation), direction))
        + half_extent(look, direction)
        for look in looks
    )


def figures(tree: Tree, segment: Segment) -> Figures:
    at = placements(tree, {})
    start = float(np.dot(at[segment.first].translation, segment.direction))
    last = segment.links[-1]
    end = (
        tip(tree, at, last, segment.direction)
        if segment.end == TIP
        else float(np.dot(at[segment.end].translation, segment.direction))
    )
    parts = [tree.link_by_name[link].inertia for link in segment.links]
    masses = np.array([part.mass for part in parts])
    centers = np.array([at[k].apply(part.center) for k, part in zip(segment.links, parts, strict=True)])
    center = float(masses @ centers @ np.array(segment.direction) / masses.sum())
    return Figures(end - start, float(masses.sum()), center - start)


def totals(tree: Tree) -> dict[str, float]:
    """Figures of the whole body, heights above the sole of the left foot."""
    at = placements(tree, {})
    floor = -tip(tree, at, "LeftFoot", DOWN)
    masses = np.array([link.inertia.mass for link in tree.links])
    centers = np.array([at[link.name].apply(link.inertia.center) for link in tree.links])
    heel, toes = tip(tree, at, "LeftFoot", (-1.0, 0.0, 0.0)), tip(tree, at, "LeftToe", FORWARD)
    return {
        "height [m]": tip(tree, at, "Head", UP) - floor,
        "mass [kg]": float(masses.sum()),
        "centre of mass, height [m]": float(masses @ centers[:, 2] / masses.sum()) - floor,
        "hip joint, height [m]": at["LeftUpperLeg"].translation[2] - floor,
        "knee, height [m]": at["LeftLowerLeg"].translation[2] - floor,
        "ankle, height [m]": at["LeftFoot"].translation[2] - floor,
        "shoulder joint, height [m]": at["LeftUpperArm"].translation[2] - floor,
        "between hip joints [m]": 2.0 * at["LeftUpperLeg"].translation[1],
        "between shoulder joints [m]": 2.0 * at["LeftUpperArm"].translation[1],
        "fingertip to fingertip [m]": 2.0 * tip(tree, at, "LeftHand", OUTWARD),
        "foot, heel to toe tip [m]": heel + toes,
    }


@pytest.fixture(scope="module")
def documented(repository: Path) -> dict[str, list[str]]:
    """Rows of the Markdown tables in the section, by their first cell."""
    text = (repository / "docs" / "person.md").read_text(encoding="utf-8")
    section = text.split("## Comparison with the published body\n")[1].split("\n## ")[0]
    rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in row] for row in rows]
    return {row[0]: row[1:] for row in cells if row[0] not in ("segment", "whole body", "---")}


def pair(ours: float, published: float, digits: int) -> str:
    return f"{ours:.{digits}f} / {published:.{digits}f}"


def expected_rows() -> dict[str, tuple[list[str], set[str]]]:
    """The figures' cells of each row, and the figures whose difference must have a reason."""
    ours, published = bodies()
    rows: dict[str, tuple[list[str], set[str]]] = {}
    for segment in SEGMENTS:
        a, b = figures(ours, segment), figures(published, segment)
        cells = [pair(a.length, b.length, 3), pair(a.mass, b.mass, 2), pair(a.center, b.center, 3)]
        known = {"length": (a.length, b.length), "mass": (a.mass, b.mass), "centre": (a.center, b.center)}
        rows[segment.name] = (cells, {name for name, values in known.items() if differ(*values)})
    mine, its = totals(ours), totals(published)
    for name, value in mine.items():
        rows[name] = ([pair(value, its[name], 3)], {"figure"} if differ(value, its[name]) else set())
    return rows


def differ(ours: float, published: float) -> bool:
    return abs(ours - published) > NOTICEABLE * published


def test_the_documented_figures_are_those_of_both_bodies(documented: Mapping[str, list[str]]) -> None:
    """A figure that moved is shown in the assertion as the row to write."""
    expected = {name: cells for name, (cells, _) in expected_rows().items()}
    assert {name: row[:-1] for name, row in documented.items()} == expected


def test_every_noticeable_difference_and_no_other_has_its_reason(
    documented: Mapping[str, list[str]],
) -> None:
    """Reasons read `length, centre: ...; mass: ...`, or are free text where a row has one figure."""
    for name, (cells, noticeable) in expected_rows().items():
        reasons = documented[name][-1]
        if len(cells) == 1:
            assert bool(reasons) == bool(noticeable), name
            continue
        explained = [
            word.strip() for part in reasons.split(";") if part for word in part.split(":")[0].split(",")
        ]
        assert sorted(explained) == sorted(noticeable), name


def test_the_segments_leave_no_mass_out_and_count_none_twice() -> None:
    parts = [link for segment in SEGMENTS if segment.name != TRUNK for link in segment.links]
    whole = [*parts, *(link.replace("Left", "Right") for link in parts if link.startswith("Left"))]
    for tree in bodies():
        assert sorted(whole) == sorted(link.name for link in tree.links if link.inertia.mass > 0.0)
        trunk = next(segment for segment in SEGMENTS if segment.name == TRUNK)
        limbs = {link for link in whole if link.startswith(("Left", "Right")) and "Shoulder" not in link}
        assert set(trunk.links) == set(whole) - limbs - {"Neck", "Head"}


Row = tuple[float, float | None, float]
H, M = 1.82, 72.7
FOOT, TOES, BALL, TOE_CENTER = 0.9451, 0.10905, 0.15123, 0.035756

BY_HAND: dict[str, tuple[Row, Row]] = {
    "upper arm": (
        (0.186 * H, 0.0271 * M, 0.5772 * 0.186 * H),
        (0.32874, 2.181, 0.16437),
    ),
    "forearm": (
        (0.146 * H, 0.0162 * M, 0.4574 * 0.146 * H),
        (0.26863, 1.454, 0.13431),
    ),
    "hand: to the fingertip": (
        (0.108 * H, 0.0061 * M, 0.3624 * 0.108 * H),
        (0.200775, 0.4362, 0.10039),
    ),
    "thigh": (
        (0.245 * H, 0.1416 * M, 0.4095 * 0.245 * H),
        (0.48159, 9.0875, 0.2408),
    ),
    "head: to the vertex": (
        (0.130 * H, None, 0.065 * H),
        (2.0 * 0.099558, 2.6172, 0.099558),
    ),
    "foot and toes: ankle to toe tip": (
        (0.75 * 0.152 * H, 0.0137 * M, (0.4415 - 0.25) * 0.152 * H),
        (
            BALL + TOE_CENTER + 0.071513 / 2.0,
            FOOT + TOES,
            (FOOT * 0.05699 + TOES * (BALL + TOE_CENTER)) / (FOOT + TOES),
        ),
    ),
}
"""Length, mass and centre: ours from the printed tables, the published ones from the file's figures."""


@pytest.mark.parametrize("segment", BY_HAND)
def test_figures_are_those_read_by_hand_from_the_tables_and_from_the_published_file(
    segment: str,
) -> None:
    row = next(s for s in SEGMENTS if s.name == segment)
    for tree, by_hand in zip(bodies(), BY_HAND[segment], strict=True):
        found = figures(tree, row)
        assert found.length == pytest.approx(by_hand[0], abs=1e-9)
        assert by_hand[1] is None or found.mass == pytest.approx(by_hand[1], abs=1e-9)
        assert found.center == pytest.approx(by_hand[2], abs=1e-9)


def problem_text(repository: Path) -> str:
    """The point-grasp problem with the published body for its person and one height.

    Soles: on the floor side of the foot's box, midway between its heel and the tip of the toes' box, which
    ends 4.3 mm above the floor but does not move against the foot. Palms: at the centres of the hands' boxes.
    """
    heel, floor = 0.05699 - 0.18849 / 2.0, -0.038957 - 0.077914 / 2.0
    tip = BALL + TOE_CENTER + 0.071513 / 2.0
    frames = {
        "LeftSole": ("LeftFoot", [(heel + tip) / 2.0, 0.0, floor]),
        "RightSole": ("RightFoot", [(heel + tip) / 2.0, 0.0, floor]),
        "LeftPalm": ("LeftHand", [0.0, 0.10039, 0.0]),
        "RightPalm": ("RightHand", [0.0, -0.10039, 0.0]),
    }
    human = [
        "[human]",
        f'urdf = "{PUBLISHED}"',
        'hands = { left = "LeftPalm", right = "RightPalm" }',
        f'soles = {{ left = "LeftSole", right = "RightSole", size_m = [{tip - heel}, 0.088065] }}',
        'trunk = ["Pelvis", "T8"]',
        f"joints = {json.dumps(list(DEFAULT_JOINTS))}",
    ]
    for name, (link, place) in frames.items():
        human += ["[[human.frames]]", f'name = "{name}"', f'link = "{link}"', f"xyz_m = {place}"]
    text = (repository / "problems" / "point_grasp.toml").read_text(encoding="utf-8")
    before, rest = text.split("[human]\n")
    after = rest[rest.index("[payload]") :]
    assert "heights_m = [0.8, 1.0, 1.2]" in after
    after = after.replace("heights_m = [0.8, 1.0, 1.2]", "heights_m = [1.0]")
    solver = ["[solver]", "compile = false  # takes longer than it saves here", ""]
    return "\n".join([before, *human, "", after, *solver])


@pytest.fixture(scope="module")
def users_problem(repository: Path) -> DesignProblem:
    """The point-grasp problem with the published body as a user's person."""
    default = read_source(repository / "problems" / "point_grasp.toml")
    files = {**default.files, PUBLISHED: reference_text(PUBLISHED)}
    return build_problem(ProblemSource(path=default.path, text=problem_text(repository), files=files))


def test_a_users_urdf_is_the_person_of_a_problem(users_problem: DesignProblem) -> None:
    human = users_problem.scene.human
    assert human.joints == DEFAULT_JOINTS
    assert math.fsum(link.inertia.mass for link in human.tree.links) == pytest.approx(72.7, abs=5e-4)
    at = placements(human.tree, {})
    for side in SIDES:
        sole, ankle = at[human.frame(f"{side}_foot")].translation, at[f"{side.title()}Foot"].translation
        assert ankle[2] - sole[2] == pytest.approx(0.077914, abs=1e-12)
        assert sole[0] - ankle[0] == pytest.approx(0.0927, abs=1e-4)
        assert abs(at[human.frame(f"{side}_hand")].translation[1]) == pytest.approx(0.8847, abs=1e-4)


def test_its_turned_limits_of_hip_flexion_and_toes_are_noted_and_no_others(
    users_problem: DesignProblem,
) -> None:
    unread, *limits = strange(users_problem)
    assert "damping and friction of joints are not counted" in unread
    noted = {sentence.split("joint ")[1].split(" ")[0] for sentence in limits}
    turned = ("jLeftHip_roty", "jRightHip_roty", "jLeftBallFoot_roty", "jRightBallFoot_roty")
    assert noted == set(turned)
    assert len(limits) == len(turned)
    assert all(sentence.endswith("its limits seem to have the wrong sign") for sentence in limits)


def test_its_posture_is_found_within_the_limits_as_they_are_written(users_problem: DesignProblem) -> None:
    """At 1.0 m the person stands upright, so that the hips' turned limits do not matter."""
    problem, tree = users_problem, users_problem.scene.human.tree
    result = Evaluator(problem).solve(problem.space.unscaled(problem.scene.robot.tree))
    (height,) = result.cases
    assert height.status is Status.SOLVED, height.reason
    posture = height.postures[HUMAN]
    for name, angle in posture.joints.items():
        assert tree.joint_by_name[name].lower - 1e-6 <= angle <= tree.joint_by_name[name].upper + 1e-6, name
    carried = sum(posture.wrenches[f"{side}_foot"][2] for side in SIDES)
    assert carried == pytest.approx((72.7001 + 2.5) * GRAVITY, abs=1e-4)


def test_every_number_of_the_anthropometric_data_has_a_source() -> None:
    """Read as it lies on the disk, so that a table added later is not forgotten."""
    data = resources.files("evodesign.human").joinpath("data/anthropometry.toml").read_text(encoding="utf-8")
    without = [path for path, sourced in numbers(tomllib.loads(data), "", sourced=False) if not sourced]
    assert without == []


def numbers(value: Any, path: str, *, sourced: bool) -> Iterator[tuple[str, bool]]:
    """Every number with its path, and whether a table around it has a `source` that says something."""
    if isinstance(value, dict):
        here = sourced or bool(str(value.get("source", "")).strip())
        for key, inner in value.items():
            yield from numbers(inner, f"{path}.{key}" if path else key, sourced=here)
    elif isinstance(value, list):
        for position, inner in enumerate(value):
            yield from numbers(inner, f"{path}[{position}]", sourced=sourced)
    elif isinstance(value, int | float):
        yield path, sourced
