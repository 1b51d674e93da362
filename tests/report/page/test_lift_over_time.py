"""The lift of a page over its time, in a real browser, against what the log holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import casadi as ca
import msgspec
import numpy as np
import pinocchio as pin
import pytest

from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.balance import AppliedWrench, cut
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import (
    AgentDetail,
    Assessment,
    CaseDetail,
    CaseOutcome,
    Detail,
    Evaluation,
    InstantDetail,
    Lift,
    ReachOutcome,
    Status,
)
from evodesign.report.page import page_content, page_html
from evodesign.report.page.card import StaticTorques
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from evodesign.tree.kinematics import Pose, forward
from evodesign.tree.model import Tree
from evodesign.tree.words import in_words
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page
from tests.report.scenes import random_instant, random_values

pytestmark = [pytest.mark.needs_chromium, pytest.mark.slow]

AT_REST = ", at rest"

LIFT = Lift(0.8, 1.2, 1.5, knots=4)


def moved(problem: DesignProblem) -> CaseDetail:
    """A lift through random postures with random speeds."""
    scene, rng, instants = problem.scene, np.random.default_rng(3), list[InstantDetail]()
    for time in LIFT.result_times:
        instant = random_instant(scene, rng)
        agents = {
            name: msgspec.structs.replace(
                agent, speeds_rad_s={joint: float(rng.normal()) for joint in agent.joints_rad}
            )
            for name, agent in instant.agents.items()
        }
        instants.append(msgspec.structs.replace(instant, time_s=time, agents=agents, load_height_m=1.0))
    return CaseDetail(case=scene.case(LIFT), instants=tuple(instants))


@pytest.fixture(scope="module")
def run(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    source = read_source(repository / "problems" / "icub_lift.toml")
    problem = build_problem(
        msgspec.structs.replace(source, text=source.text.replace("seconds = 1.5", "seconds = 1.5\nknots = 4"))
    )
    detail, values = moved(problem), random_values(problem, 1)
    place = tmp_path_factory.mktemp("lift") / "run"
    with RunWriter(place, header_of(problem, problem.settings("random", 4, 1), budget=4)) as log:
        assessment = Assessment(
            design=dict(problem.space.named(values)),
            objectives={"robot_torque": 1.0, "human_torque": 9.0, "reach_height": 1.25},
            violation=0.0,
            status=Status.SOLVED,
            reason="solved",
            reach=ReachOutcome(lowest_m=0.1, highest_m=1.25, status=Status.SOLVED, reason=""),
            cases=(
                CaseOutcome(detail.case, Status.SOLVED, "solved", 30.0, 9.0, iterations=7, residual=1e-9),
            ),
        )
        genome = problem.space.genome(values)
        log.write(Detail(evaluation=0, cases=(detail,)))
        log.write(Evaluation(0, 0, genome, assessment, seconds=0.1, worker="here"))
    return read_run(place)


@pytest.fixture(scope="module")
def page(chromium: Tab, run: RunLog) -> Iterator[Tab]:
    path = run.directory / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    open_page(chromium, path)
    yield chromium
    assert chromium.complaints() == []


def drawn(page: Tab, plot: int) -> dict[str, tuple[list[float], list[float]]]:
    """Times and values of the lines of a plot, by name."""
    script = f"document.querySelectorAll('#over-time .joint-plot')[{plot}].data.map(d => [d.name, d.x, d.y])"
    return {name: (x, y) for name, x, y in page.value(script)}


@pytest.mark.parametrize(("option", "who"), [(0, "robot"), (1, "human")])
def test_torques_power_and_forces_on_hands_are_those_of_the_log(
    page: Tab, run: RunLog, option: int, who: str
) -> None:
    page.value(f"document.querySelectorAll('input[name=over-time]')[{option}].click()")
    instants = [instant.agents[who] for instant in run.details[0].cases[0].instants]

    def over(value: Callable[[AgentDetail], float]) -> list[float]:
        return pytest.approx([value(each) for each in instants], rel=1e-5, abs=1e-5)

    torques = {name: line for name, line in drawn(page, 0).items() if not name.endswith(AT_REST)}
    most = {joint: max(abs(each.torques_n_m[joint]) for each in instants) for joint in instants[0].joints_rad}
    torques = {joint: torques[in_words(joint)] for joint in most if in_words(joint) in torques}
    assert sorted(torques) == sorted(sorted(most, key=most.__getitem__, reverse=True)[:8])
    for joint, (times, values) in torques.items():
        assert times == pytest.approx(LIFT.result_times, rel=1e-6)
        assert values == over(lambda each, joint=joint: each.torques_n_m[joint])

    def powers(each: AgentDetail) -> list[float]:
        return [each.torques_n_m[joint] * speed for joint, speed in each.speeds_rad_s.items()]

    power = drawn(page, 1)
    assert power["all joints"][1] == over(lambda each: sum(powers(each)))
    assert power["joints that drive"][1] == over(lambda each: sum(max(one, 0.0) for one in powers(each)))
    for side in ("left", "right"):
        force = drawn(page, 2)[f"{side} hand"][1]
        assert force == over(lambda each, side=side: math.hypot(*each.wrenches[f"{side}_hand"][:3]))


def statics(agent: Agent, tree: Tree, own: AgentDetail) -> dict[str, float]:
    """Joint torques at rest, by cutting the tree where the page asks pinocchio [N m]."""
    base = Pose(ca.DM(pin.rpy.rpyToMatrix(np.array(own.base_rpy_rad))), ca.DM(own.base_position_m))
    poses = forward(tree, base, {joint: ca.DM(angle) for joint, angle in own.joints_rad.items()})
    applied = []
    for side in SIDES:
        hand, sole = poses[agent.frame(f"{side}_hand")], poses[agent.frame(f"{side}_foot")]
        force, moment = np.split(np.array(own.wrenches[f"{side}_hand"]), 2)
        applied.append(AppliedWrench(agent.frame(f"{side}_hand"), hand.position, ca.DM(force), ca.DM(moment)))
        force, moment = np.split(np.array(own.wrenches[f"{side}_foot"]), 2)
        wrench = sole.rotation @ force, sole.rotation @ moment
        applied.append(AppliedWrench(agent.frame(f"{side}_foot"), sole.position, *wrench))
    found = cut(tree, poses, applied).torques
    return {joint: float(found[joint]) for joint in agent.joints}


@pytest.mark.parametrize(("option", "who"), [(0, "robot"), (1, "human")])
def test_torques_at_rest_are_those_of_statics_in_the_same_moments(
    page: Tab, run: RunLog, problem: DesignProblem, option: int, who: str
) -> None:
    page.value(f"document.querySelectorAll('input[name=over-time]')[{option}].click()")
    agent = problem.scene.robot if who == "robot" else problem.scene.human
    values = list(run.evaluations[0].assessment.design.values())
    tree = problem.space.resized(agent.tree, values) if who == "robot" else agent.tree
    wanted = [statics(agent, tree, each.agents[who]) for each in run.details[0].cases[0].instants]
    lines = {name: line for name, line in drawn(page, 0).items() if name.endswith(AT_REST)}
    assert len(lines) == 8
    for name, (times, values) in lines.items():
        assert times == pytest.approx(LIFT.result_times, rel=1e-6)
        (joint,) = (each for each in agent.joints if in_words(each) == name.removesuffix(AT_REST))
        assert values == pytest.approx([each[joint] for each in wanted], rel=1e-4, abs=1e-4)


def test_centres_of_pressure_are_where_the_ground_pushes(
    page: Tab, run: RunLog, problem: DesignProblem
) -> None:
    page.value("document.querySelectorAll('input[name=over-time]')[0].click()")
    lines = drawn(page, 3)
    width = problem.scene.robot.feet[0].sole.width
    for side, middle in (("left", -0.75 * width), ("right", 0.75 * width)):
        across, forward = lines[f"centre of pressure, {side}"]
        outline = lines[f"{side} sole"]
        assert max(outline[0]) - min(outline[0]) == pytest.approx(width)
        assert max(outline[1]) - min(outline[1]) == pytest.approx(problem.scene.robot.feet[0].sole.length)
        for instant, right, ahead in zip(run.details[0].cases[0].instants, across, forward, strict=True):
            force, moment = np.split(np.array(instant.agents["robot"].wrenches[f"{side}_foot"]), 2)
            there = np.array([ahead, middle - right, 0.0])
            assert (moment - np.cross(there, force))[:2] == pytest.approx([0.0, 0.0], abs=1e-3)


def test_limits_of_torques_are_told_beside_the_joints(problem: DesignProblem) -> None:
    robot = replace(problem.scene.robot, torque_limits={"l_knee": 40.0}, limits_torques=True)
    limited = [scene.with_agents(robot) for scene in problem.scenes]
    cases = [moved(problem)]
    assert StaticTorques(limited).of(robot.tree, cases)[1] == {"l_knee": 40.0}
    assert StaticTorques(problem.scenes).of(robot.tree, cases)[1] == {}
    assert StaticTorques(limited).of(robot.tree, []) == ((), {})
