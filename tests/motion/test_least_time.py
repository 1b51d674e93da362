"""The least time of a lift: against lifts of a given time, and its gradient against differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from evodesign.motion import least_time, lift_program
from evodesign.motion.instant import KnotBlocks, fastest_joints
from evodesign.motion.least_time import LeastTime
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.lifting import LiftProblem
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.solver import status_of
from evodesign.posture.check import AgentModel
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.records import Status
from tests.motion.lifted import LIFT, Lifted

pytestmark = pytest.mark.slow

MOST = 20.0
"""Torque of any of the robot's joints [N m]."""


@pytest.fixture(scope="module")
def limited(lifted: Lifted) -> Lifted:
    """The same robot with torque limits; least times are looked for."""
    scene = lifted.setting.scene
    limits = dict.fromkeys(scene.robot.joints, MOST)
    robot = replace(scene.robot, torque_limits=limits, limits_torques=True)
    setting = replace(lifted.setting, scene=scene.with_agents(robot))
    return replace(
        lifted,
        setting=setting,
        robot=AgentModel.of(robot, scene.robot.tree),
        lifts=LiftProblem(setting, symmetric=True, timed=True),
    )


@pytest.fixture(scope="module")
def quickest(limited: Lifted) -> LiftSolution:
    return limited.solve(LIFT)


@pytest.fixture(scope="module")
def least(quickest: LiftSolution) -> LeastTime:
    assert (quickest.status, quickest.reason) == (Status.SOLVED, "solved")
    assert quickest.least is not None
    return quickest.least


def test_the_least_time_is_that_of_a_checked_motion_at_its_limits(limited: Lifted, least: LeastTime) -> None:
    course = least.course
    assert course is not None
    assert least.checked is not None
    assert least.checked.wrong == ""
    assert 0.1 < course.lift.seconds <= least.seconds < 1.01 * course.lift.seconds
    assert course.lift.seconds < 0.4 * LIFT.seconds
    instants = course.instants(np.linspace(0.0, course.lift.seconds, 400))
    torques = [abs(torque) for each in instants for torque in each.postures["robot"].torques.values()]
    assert MOST - 1e-3 < max(torques) < MOST + 1e-3
    for model in (limited.robot, limited.human):
        fastest = fastest_joints(whole(model.agent), model.tree)
        for each in instants:
            for joint, speed in each.postures[model.agent.name].speeds.items():
                assert abs(speed) < float(fastest[joint]) + 1e-6
    heights = course.heights([0.0, course.lift.seconds / 2.0, course.lift.seconds])
    assert heights == pytest.approx([LIFT.from_m, 1.0, LIFT.to_m])


def timed(limited: Lifted, least: LeastTime) -> LiftProgram:
    """Begun at a solution and solved to 1e-10."""
    blocks = KnotBlocks(symmetric_forms(limited.setting.scene), limited.setting, timed=True)
    options = replace(limited.setting.options, tolerance=1e-10, iterations=500, near=True)
    return LiftProgram(blocks, least.lift.knots, options)


def test_a_lift_of_a_little_more_time_is_found_and_one_of_less_is_not(
    limited: Lifted, least: LeastTime, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the program whose time may not be less, or not more, from the quickest motion."""
    start, found = least.start, {}
    assert start is not None
    share, program = float(start.symbols[-1]), timed(limited, least)
    for between in ((1.02, 2.0), (0.1, 0.9)):
        monkeypatch.setattr(lift_program, "SHARES", tuple(share * side for side in between))
        ending, _ = program.solve(least.lift, start, limited.design, limited.setting.scene.payload.mass)
        found[between] = status_of(ending.word), float(ending.symbols[-1]) / share
    slower, _ = found.values()
    assert slower == (Status.SOLVED, pytest.approx(1.02, abs=1e-3))
    assert found[0.1, 0.9][0] is not Status.SOLVED


def test_the_least_time_moves_with_the_design_as_solves_of_neighbours_do(
    limited: Lifted, least: LeastTime
) -> None:
    """Along two directions, by central differences at two steps, extrapolated to none (Richardson)."""
    program, start = timed(limited, least), least.start
    assert start is not None
    at, rng, step = np.array(limited.design), np.random.default_rng(7), 1e-4

    def seconds(design: np.ndarray) -> float:
        ending, _ = program.solve(least.lift, start, design, limited.setting.scene.payload.mass)
        assert ending.word == "Solve_Succeeded"
        return least.lift.seconds * ending.cost

    assert seconds(at) == pytest.approx(least.seconds, rel=1e-5)
    size = float(np.abs(least.slope * at).max())
    for _ in range(2):
        along = rng.standard_normal(len(at)) * at
        far, near = (
            (seconds(at + h * along) - seconds(at - h * along)) / (2.0 * h) for h in (step, step / 2.0)
        )
        assert float(least.slope @ along) == pytest.approx((4.0 * near - far) / 3.0, abs=1e-4 * size)


def test_a_least_time_that_is_not_found_is_a_status_with_a_sentence(
    limited: Lifted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(least_time, "MOST_KNOTS", LIFT.knots)
    found = limited.solve(LIFT)
    assert found.status is Status.NUMERICAL_FAILURE
    assert found.reason.startswith("the least time of 0.9 to 1.1 m in 1.5 s was not found: between knots")
    assert found.least is None
    assert found.attempts[-1].formulation == "least time"


def test_nothing_looks_for_a_least_time_unasked(solution: LiftSolution) -> None:
    assert solution.least is None
