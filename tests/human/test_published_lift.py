"""A lift whose moments were published (docs/people.md), held by a person of ours.

The joint centres of the batch example of 3DSSPP (University of Michigan) give the directions of trunk, upper
arm and forearm. Our person, of the same stature, mass and sex, takes them with segments of its own lengths.
Their moments without the load follow from theirs with it: the load's weight times its distance is taken off.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT, BodyState, Configuration, FloatingBody

Array = NDArray[np.float64]

INCH, POUND, POUND_FORCE = 0.0254, 0.45359237, 4.4482216
STATURE, MASS = 69.45 * INCH, 190.48 * POUND
LOAD = 10.0 * POUND_FORCE
"""In each hand [N]."""

C7_T1, HAND = (2.02, 0.0, 48.49), (18.48, 8.14, 26.87)
CENTRES = {
    "L5/S1": (-11.99, 0.0, 35.92),
    "shoulder": (2.82, 8.19, 48.03),
    "elbow": (8.90, 10.53, 36.74),
    "wrist": (16.10, 8.74, 29.32),
}
"""Of the left side: ahead, to the left, up [in]."""

MOMENTS = {"L5/S1": 1947.89, "shoulder": 222.06, "elbow": 116.41, "wrist": 26.04}
"""About the lateral axis, with the load [lbf in]."""

LINKS = {"L5/S1": "L5", "shoulder": "LeftUpperArm", "elbow": "LeftForeArm", "wrist": "LeftHand"}
SIDES = {"L5/S1": ("Left", "Right"), "shoulder": ("Left",), "elbow": ("Left",), "wrist": ("Left",)}
"""Of the hands beyond each joint."""

Moments = dict[tuple[str, bool], float]


def published(joint: str, *, loaded: bool) -> float:
    """Moment [N m]."""
    moment = MOMENTS[joint] * INCH * POUND_FORCE
    lever = (HAND[0] - CENTRES[joint][0]) * INCH
    return moment if loaded else moment - len(SIDES[joint]) * LOAD * lever


def direction(start: tuple[float, ...], end: tuple[float, ...]) -> Array:
    line = np.array(end) - np.array(start)
    return np.asarray(line / np.linalg.norm(line))


def turn(axis: int, angle: float) -> Array:
    """Rotation about an axis, counted from x."""
    c, s = math.cos(angle), math.sin(angle)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[[first, first, second, second], [first, second, first, second]] = c, -s, s, c
    return matrix


def joints() -> dict[str, float]:
    """Joint positions [rad] with these directions; the pelvis stays upright, and L5/S1 bends alone."""
    trunk = direction(CENTRES["L5/S1"], C7_T1)
    pitch = math.atan2(trunk[0], trunk[2])
    in_trunk = turn(1, pitch).T @ direction(CENTRES["shoulder"], CENTRES["elbow"])
    raised, ahead = math.atan2(in_trunk[2], in_trunk[1]), -math.asin(in_trunk[0])
    arm = turn(1, pitch) @ turn(0, raised) @ turn(2, ahead)
    in_arm = arm.T @ direction(CENTRES["elbow"], CENTRES["wrist"])
    left = {
        "jLeftShoulder_rotx": raised,
        "jLeftShoulder_rotz": ahead,
        "jLeftElbow_roty": math.atan2(-in_arm[2], in_arm[0]),
        "jLeftElbow_rotz": -math.acos(in_arm[1]),
    }
    mirrored = {name: angle if name.endswith("y") else -angle for name, angle in left.items()}
    right = {name.replace("Left", "Right"): angle for name, angle in mirrored.items()}
    return {"jL5S1_roty": pitch, **left, **right}


@pytest.fixture(scope="module")
def state() -> BodyState:
    positions = joints()
    body = FloatingBody.of_tree(human_tree(Person(STATURE, MASS, Sex.MALE)), tuple(positions), np.eye(3))
    return body.at(Configuration(np.zeros(3), np.zeros(3), positions), np.zeros(body.size))


@pytest.fixture(scope="module")
def ours(state: BodyState) -> Moments:
    """Moments about the lateral axis [N m], by joint and whether there is a load."""
    found = {}
    for joint, link in LINKS.items():
        _, centre = state.pose(link)
        hands = [state.pose(f"{side}Palm")[1] - centre for side in SIDES[joint]]
        found[joint, False] = weight_moment(state, link, centre)
        found[joint, True] = found[joint, False] + sum(LOAD * hand[0] for hand in hands)
    return found


def weight_moment(state: BodyState, link: str, centre: Array) -> float:
    """Of the weights of a link and all beyond it, about the lateral axis through a point [N m]."""
    tree, waiting, moment = state.body.built.tree, [link], 0.0
    while waiting:
        name = waiting.pop()
        waiting += [joint.child for joint in tree.child_joints[name]]
        inertia = tree.link_by_name[name].inertia
        rotation, origin = state.pose(name)
        lever = rotation @ np.array(inertia.center, dtype=float) + origin - centre
        moment += float(inertia.mass) * GRAVITY * lever[0]
    return moment


def test_the_torque_of_the_joint_is_the_moment_of_what_is_beyond_it(state: BodyState, ours: Moments) -> None:
    down = np.array([0.0, 0.0, -LOAD])
    jacobians = [state.jacobian_in_world(f"{side}Palm")[:3] for side in SIDES["L5/S1"]]
    torques = state.bias - sum(jacobian.T @ down for jacobian in jacobians)
    place = ROOT + state.body.joints.index("jL5S1_roty")
    assert -torques[place] == pytest.approx(ours["L5/S1", True], rel=1e-9)


def test_arms_are_as_heavy_and_the_trunk_is_a_little_shorter(ours: Moments) -> None:
    for joint in ("shoulder", "elbow", "wrist"):
        assert ours[joint, True] == pytest.approx(published(joint, loaded=True), rel=0.05)
    assert 0.80 < ours["L5/S1", True] / published("L5/S1", loaded=True) < 0.85


@pytest.mark.parametrize("loaded", [True, False])
@pytest.mark.parametrize("joint", ["L5/S1", "shoulder", "elbow", "wrist"])
def test_the_table_says_so(repository: Path, ours: Moments, joint: str, loaded: bool) -> None:
    theirs, mine = published(joint, loaded=loaded), ours[joint, loaded]
    row = f"| {joint} | {'with' if loaded else 'without'} | {theirs:.1f} | {mine:.1f} | {mine / theirs:.2f} |"
    assert row in (repository / "docs" / "people.md").read_text(encoding="utf-8").splitlines()
