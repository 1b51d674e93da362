"""What `init` writes is believed by default: nobody's torque falls below what forearms weigh on elbows.

With the moment that wrists bear, 7 N m, hands of two agents twist a light load to hold up their forearms, at
no cost where wrists stand still; the moment that `init` writes leaves them to weigh.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.guess.body_plan import body_plan
from evodesign.guess.problem_text import guessed_problem, inertia_rule
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.elbow import elbow
from evodesign.mechanics.load_share import share_interval
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.left_out import left_out
from evodesign.records import ProblemSource
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.guess.humanoid import Build, humanoid
from tests.robots import HUMANOIDS

QUICK = "\n[solver]\ncompile = false\nstart_portfolio = false\n"
APART = "[collisions]  # nothing passes through anything\n"


def guessed(tree: Tree) -> ProblemSource:
    """The problem of `init`, without meshes."""
    text = guessed_problem(tree, "robot.urdf").text.replace("[robot]\n", "[robot]\nmeshes = false\n", 1)
    return ProblemSource(path="p.toml", text=text + QUICK, files={"robot.urdf": urdf_text(tree)})


def free(source: ProblemSource, old: str = "", new: str = "") -> DesignProblem:
    """The problem without `[collisions]`, which would take minutes, and with another change."""
    assert APART in source.text
    assert old in source.text
    text = source.text.replace(APART, "").replace(old, new, 1) if old else source.text.replace(APART, "")
    return build_problem(ProblemSource(path=source.path, text=text, files=source.files))


def weighed(agent: Agent, tree: Tree, posture: AgentPosture) -> float:
    """Norm of the moments of what each elbow carries about it [N m], by pinocchio."""
    model = pin.buildModelFromXML(urdf_text(tree), pin.JointModelFreeFlyer())
    data, q = model.createData(), pin.neutral(model)
    q[:3] = posture.base_position
    q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*posture.base_angles)).coeffs()
    for name, angle in posture.joints.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            angle if joint.nq == 1 else (math.cos(angle), math.sin(angle))
        )
    pin.centerOfMass(model, data, q)
    moments = []
    for hand in agent.hands:
        bend = elbow(agent, hand)
        assert bend is not None
        joint = model.getJointId(bend.joint)
        lever = (data.oMi[joint].act(data.com[joint]) - data.oMi[joint].translation)[:2]
        moments.append(9.80665 * data.mass[joint] * np.linalg.norm(lever))
    return float(np.linalg.norm(moments))


def shares(problem: DesignProblem) -> list[float]:
    """Torque of each agent over what forearms weigh, in every case that weighs as much as 0.3 N m."""
    result = Evaluator(problem).solve(problem.space.unscaled(problem.scene.robot.tree))
    assert all(case.solved for case in result.cases)
    found = []
    for case in result.cases:
        scene, postures = problem.scene_of(case.case), case.instants[0].postures
        for agent, tree in ((scene.robot, result.tree), (scene.human, scene.human.tree)):
            posture = postures[agent.name]
            found.append(posture.torque_norm / max(weighed(agent, tree, posture), 0.3))
    return found


def test_nothing_is_left_out_of_a_new_problem() -> None:
    source = guessed(humanoid(Build()))
    assert left_out(source) == ()
    assert source.text.count("\n[[human]]") == 2
    assert guessed_problem(humanoid(Build()), "robot.urdf").text.endswith("\n")


def test_either_agent_may_carry_three_quarters_of_the_load() -> None:
    """By linear programs over the load's balance, which know nothing of the formula."""
    scene: Scene = free(guessed(humanoid(Build()))).scene
    low, high = share_interval(scene)
    assert low <= 0.25 < 0.75 <= high
    less = replace(scene, payload=replace(scene.payload, hand_moment=scene.payload.hand_moment - 0.1))
    assert share_interval(less)[1] < 0.75, "rounded up to a tenth"


def test_a_load_of_which_moments_are_large_passes_what_wrists_bear() -> None:
    tree = humanoid(Build())
    heavy = replace(tree, links=tuple(_heavier(link, 8.0) if link.solids else link for link in tree.links))
    load = free(guessed(heavy)).scene.payload
    assert load.mass == 15.0, "a tenth of the mass would be more"
    assert load.hand_moment <= 7.0


def _heavier(link, factor):  # type: ignore[no-untyped-def]
    solids = tuple(replace(solid, density=factor * solid.density) for solid in link.solids)
    return replace(link, solids=solids)


@pytest.mark.slow
@pytest.mark.needs_robots
def test_with_a_g1_nobody_has_less_torque_than_forearms_weigh() -> None:
    text = Path(HUMANOIDS["g1"]).read_text(encoding="utf-8")
    tree = read_urdf(text, "g1", InertiaRule.FILE)
    assert inertia_rule(tree) is InertiaRule.FILE
    assert body_plan(tree).arms
    source = guessed(tree)
    assert min(shares(free(source))) > 1.0
    wrists = shares(free(source, "hand_moment_n_m = 0.6", "hand_moment_n_m = 7.0"))
    assert min(wrists) > 1.0, "nor where wrists bear more: measured people do not lean on the load"
