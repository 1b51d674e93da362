"""Postures that the solver returns hold in a computation that shares nothing with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import HUMAN, ROBOT, SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.posture.check import TOLERANCE, AgentModel, Checker
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Status
from tests.posture.violations import violations


@pytest.fixture(scope="module")
def unscaled(problem: DesignProblem, evaluator: Evaluator) -> DesignResult:
    return evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))


@pytest.fixture(scope="module")
def checker(problem: DesignProblem, unscaled: DesignResult) -> Checker:
    scene = problem.scene
    return Checker(
        scene, AgentModel.of(scene.robot, unscaled.tree), AgentModel.of(scene.human, scene.human.tree)
    )


def random_designs(problem: DesignProblem, count: int) -> list[tuple[float, ...]]:
    rng = np.random.default_rng(3)
    size = len(problem.space.parameters)
    return [problem.space.values(tuple(rng.uniform(size=size))) for _ in range(count)]


def test_every_residual_of_solved_postures_is_small(problem: DesignProblem, evaluator: Evaluator) -> None:
    for values in random_designs(problem, 4):
        result = evaluator.solve(values)
        for height in result.cases:
            assert height.status is Status.SOLVED, height.reason
            assert max(height.residuals.values()) < 1e-5


def test_the_feet_carry_robot_person_and_load(unscaled: DesignResult, problem: DesignProblem) -> None:
    trees = (unscaled.tree, problem.scene.human.tree)
    mass = sum(link.inertia.mass for tree in trees for link in tree.links) + problem.scene.payload.mass
    for height in unscaled.cases:
        carried = sum(p.wrenches[f"{side}_foot"][2] for p in height.postures.values() for side in SIDES)
        assert carried == pytest.approx(mass * GRAVITY, abs=1e-4)


def test_each_agent_carries_half_of_a_centred_load(unscaled: DesignResult, problem: DesignProblem) -> None:
    half = problem.scene.payload.mass * GRAVITY / 2.0
    for height in unscaled.cases:
        for posture in height.postures.values():
            assert -sum(posture.wrenches[f"{side}_hand"][2] for side in SIDES) == pytest.approx(
                half, abs=1e-5
            )


def shifted(posture: AgentPosture, part: str) -> AgentPosture:
    """The posture with one part of it wrong by a little."""
    first = next(iter(posture.joints))
    push = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    changes = {
        "joints": {"joints": {**posture.joints, first: posture.joints[first] + 0.01}},
        "torques": {"torques": {**posture.torques, first: posture.torques[first] + 0.01}},
        "hand": {"wrenches": {**posture.wrenches, "left_hand": posture.wrenches["left_hand"] + push}},
        "foot": {
            "wrenches": {**posture.wrenches, "left_foot": posture.wrenches["left_foot"] * -1.0},
        },
        "base": {"base_position": posture.base_position + 0.001},
        "limits": {"joints": {**posture.joints, first: 4.0}},
    }
    return replace(posture, **changes[part])


@pytest.mark.parametrize("agent", [ROBOT, HUMAN])
@pytest.mark.parametrize(
    ("part", "residuals"),
    [
        ("joints", {"hands_on_load", "force_balance", "moment_balance", "feet_flat"}),
        ("torques", {"torque"}),
        ("hand", {"torque", "force_balance"}),
        ("foot", {"foot_contact", "force_balance"}),
        ("base", {"hands_on_load", "feet_on_ground"}),
        ("limits", {"joint_limits"}),
    ],
)
def test_the_check_sees_what_is_wrong(
    agent: str, part: str, residuals: set[str], unscaled: DesignResult, checker: Checker
) -> None:
    height = unscaled.cases[1]
    postures = {**height.postures, agent: shifted(height.postures[agent], part)}
    found = violations(checker, postures, height.case.task.height_m)
    large = {name.split(".")[1] for name, value in found.items() if value > TOLERANCE}
    assert residuals & large
    assert all(
        value <= TOLERANCE
        for value in violations(checker, height.postures, height.case.task.height_m).values()
    )


def test_an_evaluation_does_not_depend_on_what_was_evaluated_before(
    problem: DesignProblem, evaluator: Evaluator, known: Precomputed
) -> None:
    genome = tuple(0.3 for _ in problem.space.parameters)
    first = evaluator.assess(genome)
    evaluator.assess(tuple(0.9 for _ in problem.space.parameters))
    assert evaluator.assess(genome) == first
    assert Evaluator(problem, known).assess(genome) == first


def test_mirrored_wrenches_and_joints_are_as_good(
    problem: DesignProblem, unscaled: DesignResult, checker: Checker
) -> None:
    """Robot, person and load are mirror-symmetric, so the mirror image of a posture holds too."""
    height = unscaled.cases[0]
    images = {name: mirrored(posture) for name, posture in height.postures.items()}
    assert max(violations(checker, images, height.case.task.height_m).values()) <= TOLERANCE
    for name, image in images.items():
        assert image.torque_norm == pytest.approx(height.postures[name].torque_norm)


def mirrored(posture: AgentPosture) -> AgentPosture:
    """The mirror image in the plane y = 0."""
    polar, axial = np.array([1.0, -1.0, 1.0]), np.array([-1.0, 1.0, -1.0])
    wrench = np.concatenate([polar, axial])
    return AgentPosture(
        base_position=posture.base_position * polar,
        base_angles=posture.base_angles * axial,
        joints={partner(name): sign(name) * value for name, value in posture.joints.items()},
        torques={partner(name): sign(name) * value for name, value in posture.torques.items()},
        wrenches={
            f"{side}_{part}": posture.wrenches[f"{other}_{part}"] * wrench
            for part in ("hand", "foot")
            for side, other in (SIDES, SIDES[::-1])
        },
    )


def partner(name: str) -> str:
    if name.startswith(("l_", "r_")):
        return {"l": "r", "r": "l"}[name[0]] + name[1:]
    if "Left" in name:
        return name.replace("Left", "Right")
    return name.replace("Right", "Left")


def sign(name: str) -> float:
    """The robot's joints mirror with equal angles beside the middle line; the person's turn about x and z."""
    if name.startswith("j"):
        return 1.0 if name.endswith("y") else -1.0
    return -1.0 if name in ("torso_roll", "torso_yaw") else 1.0
