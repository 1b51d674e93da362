"""Every frame and wrench of a stage against CasADi's kinematics, pinocchio and the wrench's own balance."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.mechanics.agent import HUMAN, ROBOT, SIDES
from evodesign.posture.check import AgentModel
from evodesign.problem.build import DesignProblem
from evodesign.report.scene_models import LOAD, ContactWrench, PlacedScene, placed_scene
from evodesign.tree.frames import link_frames
from evodesign.tree.kinematics import Pose, axis_rotation, euler_rotation, forward
from tests.report.scenes import random_cast, random_detail
from tests.tree.crane import crane


@pytest.mark.parametrize("seed", range(3))
def test_links_stand_where_the_kinematics_of_the_solver_puts_them(seed: int, problem: DesignProblem) -> None:
    models = random_cast(problem, seed)
    for height in random_detail(problem, seed).cases:
        stage = placed_scene(models, height)
        for agent in models.agents:
            posture = height.agents[agent.name]
            turn = axis_rotation((0.0, 0.0, 1.0), agent.facing)
            base = Pose(
                turn @ euler_rotation(ca.DM(posture.base_rpy_rad)), turn @ ca.DM(posture.base_position_m)
            )
            poses = forward(models.trees[agent.name], base, posture.joints_rad)
            for link, pose in poses.items():
                frame = stage.frames[agent.name][link]
                assert np.allclose(np.array(pose.position).ravel(), frame.translation, rtol=0.0, atol=1e-12)
                assert np.allclose(np.array(pose.rotation), frame.rotation, rtol=0.0, atol=1e-12)


def test_links_stand_where_pinocchio_puts_them(problem: DesignProblem) -> None:
    models = random_cast(problem, 7)
    height = random_detail(problem, 7).cases[0]
    stage = placed_scene(models, height)
    for agent in models.agents:
        own = height.agents[agent.name]
        state = AgentModel.of(agent, models.trees[agent.name]).at(logged_posture(own))
        for link in models.trees[agent.name].link_by_name:
            rotation, origin = state.pose(link)
            frame = stage.frames[agent.name][link]
            mirrored = agent.turn
            assert np.allclose(mirrored @ origin, frame.translation, rtol=0.0, atol=1e-9)
            assert np.allclose(mirrored @ rotation, frame.rotation, rtol=0.0, atol=1e-9)


def test_sliding_and_turning_joints_move_as_in_the_solver() -> None:
    tree = crane()
    positions = {name: 0.1 + 0.2 * index for index, name in enumerate(tree.actuated)}
    poses = forward(tree, Pose(ca.DM.eye(3), ca.DM.zeros(3)), positions)
    frames = link_frames(tree, Placement(), positions)
    for link, pose in poses.items():
        assert np.allclose(np.array(pose.position).ravel(), frames[link].translation, rtol=0.0, atol=1e-12)
        assert np.allclose(np.array(pose.rotation), frames[link].rotation, rtol=0.0, atol=1e-12)


def test_moved_wrenches_have_the_logged_force_and_moment(problem: DesignProblem) -> None:
    models = random_cast(problem, 3)
    height = random_detail(problem, 3).cases[0]
    stage = placed_scene(models, height)
    for agent in models.agents:
        posture = height.agents[agent.name]
        for side in SIDES:
            foot = wrench_of(stage, agent.name, f"{side}_foot")
            sole = stage.frames[agent.name][agent.frame(f"{side}_foot")]
            rotation = np.array(sole.rotation)
            lever = np.array(foot.point) - np.array(sole.translation)
            moment = np.array(foot.moment) + np.cross(lever, foot.force)
            logged = np.array(posture.wrenches[f"{side}_foot"])
            assert np.allclose(rotation.T @ foot.force, logged[:3])
            assert np.allclose(rotation.T @ moment, logged[3:])
            assert np.allclose((rotation.T @ foot.moment)[:2], 0.0)
            assert (rotation.T @ lever)[2] == pytest.approx(0.0, abs=1e-12)
            hand = wrench_of(stage, agent.name, f"{side}_hand")
            assert hand.point == stage.frames[agent.name][agent.frame(f"{side}_hand")].translation
            sign = np.diag(agent.turn)
            assert np.allclose(
                [*(sign * hand.force), *(sign * hand.moment)], posture.wrenches[f"{side}_hand"]
            )


def test_foot_without_load_keeps_its_wrench_at_the_sole(problem: DesignProblem) -> None:
    models = random_cast(problem, 3)
    height = random_detail(problem, 3).cases[0]
    height.agents[ROBOT].wrenches["left_foot"] = (0.0,) * 6
    stage = placed_scene(models, height)
    sole = stage.frames[ROBOT][problem.scene.robot.frame("left_foot")]
    assert wrench_of(stage, ROBOT, "left_foot").point == sole.translation


def test_everything_with_a_shape_is_seen(problem: DesignProblem) -> None:
    models = random_cast(problem, 1)
    stage = placed_scene(models, random_detail(problem, 1).cases[1])
    seen = [name for name, _, _ in stage.solids]
    assert seen.count(LOAD) == 1
    for name in (ROBOT, HUMAN):
        shapes = sum(len(link.solids) + len(link.looks) for link in models.trees[name].links)
        assert seen.count(name) == shapes > 15
    assert stage.world_from_load.translation == (0.0, 0.0, 1.0)


def wrench_of(stage: PlacedScene, agent: str, contact: str) -> ContactWrench:
    return next(w for w in stage.wrenches if (w.agent, w.contact) == (agent, contact))
