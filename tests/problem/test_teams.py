"""Problem files of teams: several robots, people at several sides, wheels, one hand."""

from __future__ import annotations

import copy
import math
import tomllib
from dataclasses import replace
from itertools import combinations, product
from pathlib import Path
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest

from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.collision.rules import partner_side
from evodesign.control.gains import Feedback
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator, case_outcome
from evodesign.evaluation.evaluation_json import evaluation_json
from evodesign.evaluation.factory import cached_precomputed
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.precompute import staged_pieces
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.evaluation.simulations import simulated_holds
from evodesign.guess.preflight import preflight
from evodesign.mechanics.agent import Agent, Role
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.posture.formulations.reach import person_reach
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.model_json import model_json
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import source_of
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value
from evodesign.quantities.person_quantities import compression
from evodesign.report.figures.design import write_design_figures
from evodesign.report.page.bodies import bodies
from evodesign.report.replay.layout import layout_text
from evodesign.report.replay.messages import messages
from evodesign.report.scene_models import SceneSet
from evodesign.tasks import Lift
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

G = 9.81
IPOPT = {"start_portfolio": False, "compile": False, "method": "ipopt"}


def shipped(name: str, **changes: Any) -> dict[str, Any]:
    found = tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8"))
    found["solver"] = IPOPT
    found.pop("collisions")  # programs know what to keep apart once the problem is made ready
    return {**found, **changes}


def built(tables: dict[str, Any]) -> DesignProblem:
    problem = build_problem(source_of(tables))
    return replace(problem, options=replace(problem.options, compiled=False))


@pytest.fixture(scope="module")
def table_top() -> DesignProblem:
    return built(shipped("table_top", task={"heights_m": [1.0]}))


@pytest.fixture(scope="module")
def result(table_top: DesignProblem) -> DesignResult:
    found = Evaluator(table_top).solve(table_top.space.unscaled(table_top.scene.robot.tree))
    assert [solution.solved for solution in found.cases] == [True], found.cases[0].reason
    return found


def world_of(agent: Agent) -> np.ndarray:
    angle = agent.quarters * math.pi / 2.0
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def placed(agent: Agent, tree: Tree, posture: Any) -> dict[str, pin.SE3]:
    """Links in the world, by pinocchio."""
    model = pin.buildModelFromXML(urdf_text(tree), pin.JointModelFreeFlyer())
    q = pin.neutral(model)
    turn = world_of(agent) @ pin.rpy.rpyToMatrix(*posture.base_angles)
    q[:3], q[3:7] = world_of(agent) @ posture.base_position, pin.Quaternion(turn).coeffs()
    for name, angle in posture.joints.items():
        q[model.joints[model.getJointId(name)].idx_q] = angle
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return {link.name: data.oMf[model.getFrameId(link.name)] for link in tree.links}


def shapes(agent: Agent, tree: Tree, posture: Any) -> list[tuple[str, Any, Any]]:
    """Solids in the world, as coal knows them."""
    frames, found = placed(agent, tree, posture), []
    for link in tree.links:
        for solid in link.solids:
            shape = solid.shape
            if isinstance(shape, Box):
                form: Any = coal.Box(*map(float, shape.sides))
            elif isinstance(shape, Cylinder):
                form = coal.Cylinder(float(shape.radius), float(shape.length))
            else:
                assert isinstance(shape, Sphere)
                form = coal.Sphere(float(shape.radius))
            place = solid.link_from_solid
            at = frames[link.name] * pin.SE3(
                np.array(place.rotation, float), np.array(place.translation, float)
            )
            found.append((f"{agent.name} {link.name}", form, coal.Transform3s(at.rotation, at.translation)))
    return found


def test_two_robots_and_a_person_stand_at_three_sides(table_top: DesignProblem) -> None:
    scene = table_top.scene
    assert [(agent.name, agent.role, agent.quarters) for agent in scene.agents] == [
        ("robot", Role.ROBOT, 1),
        ("robot_2", Role.ROBOT, 3),
        ("human", Role.PERSON, 2),
    ]
    assert scene.designed == scene.robots
    assert scene.robots[0].tree is scene.robots[1].tree or scene.robots[0].tree == scene.robots[1].tree


def test_everyone_holds_the_table_top(table_top: DesignProblem, result: DesignResult) -> None:
    """Pinocchio places everyone, and weights are added by hand."""
    (solution,) = result.cases
    scene, center = table_top.scene, np.array([0.0, 0.0, 1.0])
    force, moment = np.array([0.0, 0.0, -G * scene.payload.mass]), np.zeros(3)
    for agent in scene.agents:
        posture = solution.postures[agent.name]
        tree = result.tree if agent.role is Role.ROBOT else agent.tree
        links, turn = placed(agent, tree, posture), world_of(agent)
        for hand in agent.hands:
            own = -turn @ posture.wrenches[hand.name][:3]
            force += own
            moment += np.cross(links[hand.frame].translation - center, own)
            moment -= turn @ posture.wrenches[hand.name][3:]
            side = -turn[:, 0] * np.abs(turn.T @ scene.payload.size)[0] / 2.0
            away = links[hand.frame].translation - center - side
            assert float(turn[:, 0] @ away) == pytest.approx(0.0, abs=1e-5), "at the agent's own edge"
    assert force == pytest.approx(0.0, abs=1e-4)
    assert moment == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("size", [(0.8, 0.7, 0.03), (0.3, 1.2, 0.2)])
@pytest.mark.parametrize(("one", "other"), [(0, 1), (1, 2), (3, 0), (0, 2), (1, 3)])
def test_two_agents_are_parted_by_one_plane(size: tuple[float, ...], one: int, other: int) -> None:
    """Each is told the way to the other's side; both have their middle, and their edge's, on their own."""
    ways = []
    for own, its in ((one, other), (other, one)):
        faced = size if own % 2 == 0 else (size[1], size[0], size[2])
        way = np.array(partner_side(faced, its - own))
        assert way @ [-faced[0] / 2.0, 0.0, 0.0] < 0.0
        turn = math.pi / 2.0 * own
        cos, sin = math.cos(turn), math.sin(turn)
        ways.append(np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ way)
    assert np.linalg.norm(ways[0]) == pytest.approx(1.0)
    assert ways[0] == pytest.approx(-ways[1], abs=1e-12)


@pytest.mark.slow
def test_nobody_touches_anybody_of_a_team_that_was_made_ready() -> None:
    """Coal measures all bodies of different agents."""
    tables = tomllib.loads((SHIPPED / "table_top.toml").read_text(encoding="utf-8"))
    tables["task"]["heights_m"], tables["design"]["length"] = [1.0], tables["design"]["length"][:1]
    problem = built({**tables, "solver": IPOPT})
    with JoblibPool(1) as pool:
        known = cached_precomputed(problem, pool)
    result = Evaluator(problem, known).solve(problem.space.unscaled(problem.scene.robot.tree))
    asked, found = coal.DistanceRequest(), coal.DistanceResult()
    (solution,) = result.cases
    assert solution.solved, solution.reason
    everyone = [
        shapes(agent, result.tree if agent.designed else agent.tree, solution.postures[agent.name])
        for agent in problem.scene.agents
    ]
    for own, other in combinations(everyone, 2):
        for (name, form, at), (beside, second, there) in product(own, other):
            found.clear()
            assert coal.distance(form, at, second, there, asked, found) > 0.0, f"{name}, {beside}"


def test_torques_are_those_of_all_robots_together(table_top: DesignProblem, result: DesignResult) -> None:
    (solution,) = result.cases
    own = {name: list(posture.torques.values()) for name, posture in solution.postures.items()}
    both = math.sqrt(sum(torque**2 for torque in own["robot"] + own["robot_2"]))
    assert objective_value("robot_torque", result) == pytest.approx(both, rel=1e-12)
    alone = math.sqrt(sum(torque**2 for torque in own["human"]))
    assert objective_value("human_torque", result) == pytest.approx(alone, rel=1e-12)
    outcome = case_outcome(solution)
    assert outcome.robot_torque_norm == pytest.approx(both, rel=1e-12)
    assert outcome.human_torque_norm == pytest.approx(alone, rel=1e-12)


def test_gradients_of_both_robots_are_those_of_differences(
    table_top: DesignProblem, result: DesignResult
) -> None:
    evaluator = Evaluator(table_top)
    sensitivities = Sensitivities(table_top, evaluator.known, evaluator.inner)
    found = assessed_gradients(table_top, sensitivities, result.values, result)
    parameter = table_top.space.parameters[0]
    (solution,), step = result.cases, 1e-4
    ends = []
    for sign in (1.0, -1.0):
        values = (result.values[0] + sign * step, *result.values[1:])
        formulation = evaluator.inner.postures[solution.case.pair]
        moved = formulation.followed(values, solution)
        assert moved is not None
        norms = [moved.postures[name].torque_norm for name in ("robot", "robot_2")]
        ends.append(math.hypot(*norms))
    slope = (ends[0] - ends[1]) / (2.0 * step) * (parameter.upper - parameter.lower)
    assert found.values["robot_torque"][parameter.name] == pytest.approx(slope, rel=1e-3)


@pytest.mark.slow
def test_it_is_told_drawn_and_replayed(
    table_top: DesignProblem, result: DesignResult, tmp_path: Path
) -> None:
    evaluator = Evaluator(table_top)
    assessment, details = evaluator.assessment(result.values, result), evaluator.details(result)
    told = evaluation_json(table_top, result.values, result, assessment, {}, details)
    assert told["objectives"]
    assert [agent["name"] for agent in model_json(table_top)["agents"]] == ["robot", "robot_2", "human"]
    drawn = bodies(table_top)
    assert [(each.name, each.role, each.quarters, each.designed) for each in drawn.agents] == [
        ("robot", "robot", 1, True),
        ("robot_2", "robot", 3, True),
        ("human", "person", 2, False),
    ]
    assert drawn.others.keys() == {""}
    assert drawn.others[""].keys() == {"human"}
    cast = SceneSet.of(table_top.scenes, result.tree)
    stage = cast.placed_scene(details[0])
    assert {wrench.agent for wrench in stage.wrenches} == {"robot", "robot_2", "human"}
    topics = [topic for topic, _ in messages(stage, details[0], 0)]
    assert {"/scene/robot_2", "/joint_states/robot_2"} <= set(topics)
    assert "Plot!robot_2" in layout_text(cast, details)
    assert all(path.stat().st_size > 10_000 for path in write_design_figures("team", cast, details, tmp_path))


@pytest.mark.slow
def test_the_simulator_holds_the_table_top(table_top: DesignProblem, result: DesignResult) -> None:
    details = Evaluator(table_top).details(result)
    (held,) = simulated_holds(table_top.scenes, result.tree, details, 1.0, Feedback())
    assert not any(agent.fell for agent in held.outcome.agents.values())
    assert held.outcome.drift < 1e-3


@pytest.mark.parametrize(
    ("robot", "human", "key", "found"),
    [
        (["-x", "-x"], "+x", "robot.sides[1]", "'-x', where a robot (robot) stands"),
        (["-x", "+x"], "+x", "human.side", "'+x', where a robot (robot) stands"),
        ([], "+x", "robot.sides", "()"),
    ],
)
def test_two_at_one_side_are_refused(robot: list[str], human: str, key: str, found: str) -> None:
    tables = shipped("table_top")
    tables["robot"]["sides"], tables["human"][0]["side"] = robot, human
    tables["human"] = tables["human"][0]
    with pytest.raises(InputError) as error:
        build_problem(source_of(tables))
    assert error.value.key == key
    assert found.strip("()") in error.value.found


def person(side: str, **changes: Any) -> dict[str, Any]:
    return {"stature_m": 1.75, "mass_kg": 75.0, "sex": "male", "side": side, **changes}


def test_people_at_one_side_take_turns_and_those_at_others_hold_together() -> None:
    people = [person("+x", name="tall", stature_m=1.9), person("+x", name="short", stature_m=1.6)]
    people.append(person("-y", name="beside"))
    tables = shipped("table_top", human=people)
    tables["robot"]["sides"] = ["-x"]
    problem = built(tables)
    assert [[agent.label for agent in scene.people] for scene in problem.scenes] == [
        ["tall", "beside"],
        ["short", "beside"],
    ]
    assert [agent.name for agent in problem.scene.people] == ["human", "human_2"]
    assert [scene.pair[0] for scene in problem.scenes] == ["tall and beside", "short and beside"]
    told = {agent["who"]: agent["stature_m"] for agent in model_json(problem)["agents"] if "who" in agent}
    assert told == {"tall": 1.9, "short": 1.6, "beside": 1.75}


def test_a_robot_of_another_file_is_no_part_of_the_design(result: DesignResult) -> None:
    tables = shipped("table_top", task={"heights_m": [1.0]})
    own = {**tables["robot"], "sides": ["-x"]}
    tables["robot"] = [own, {**copy.deepcopy(own), "sides": ["-y"]}]
    problem = built(tables)
    first, second = problem.scene.robots
    assert (first.designed, second.designed) == (True, False)
    assert problem.scene.designed == (first,)
    longer = tuple(1.2 for _ in problem.space.parameters)
    models = SceneSet.of(problem.scenes, problem.space.resized(first.tree, longer)).models[0]
    assert models.trees["robot"].mass > 1.01 * models.trees["robot_2"].mass
    assert "robot_2.urdf" in SceneSet.of(problem.scenes, first.tree).others_files


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"task": {"lift": [{"from_m": 0.8, "to_m": 1.0, "seconds": 2.0}]}}, "task.lift"),
        ({"search": {"algorithm": "joint-starts"}}, "search.algorithm"),
    ],
)
def test_what_one_robot_and_one_person_do_is_refused_of_others(change: dict[str, Any], key: str) -> None:
    wanted = "wanted one robot and one person with it, found 2 robots and 1 person"
    with pytest.raises(InputError, match=wanted) as error:
        build_problem(source_of(shipped("table_top", **change)))
    assert error.value.key == key


def test_grasps_of_a_role_are_refused_where_several_have_it() -> None:
    tables = shipped("table_top")
    tables["payload"]["robot_grasps_m"] = {"left": [0.0, 0.1, 0.0], "right": [0.0, -0.1, 0.0]}
    with pytest.raises(InputError, match="wanted one agent whose hands these are") as error:
        build_problem(source_of(tables))
    assert error.value.key == "payload.robot_grasps_m"


@pytest.fixture(scope="module")
def one_hand() -> DesignProblem:
    return built(shipped("one_hand", task={"heights_m": [0.8]}))


@pytest.mark.parametrize("sides", [("left", "right"), ("left",), ()])
def test_a_grasp_is_given_for_each_hand_and_no_other(sides: tuple[str, ...]) -> None:
    tables = shipped("one_hand", task={"heights_m": [0.8]})
    tables["payload"]["robot_grasps_m"] = {side: [0.0, 0.1, 0.0] for side in sides}
    with pytest.raises(InputError, match="wanted a point for each hand: right, found") as error:
        build_problem(source_of(tables))
    assert error.value.key == "payload.robot_grasps_m"
    tables["payload"]["robot_grasps_m"] = {"right": [-0.2, 0.1, 0.0]}
    load = build_problem(source_of(tables)).scene.payload
    assert load.grasp_points["robot", "right_hand"] == (-0.2, 0.1, 0.0)


def test_a_robot_holds_its_end_with_one_hand(one_hand: DesignProblem) -> None:
    """The hand is in the middle of the robot's edge, and what both people's hands and it pass balances."""
    robot, human = one_hand.scene.agents
    assert [hand.name for hand in robot.hands] == ["right_hand"]
    result = Evaluator(one_hand).solve(one_hand.space.unscaled(robot.tree))
    (solution,) = result.cases
    assert solution.solved, solution.reason
    wrenches = solution.postures["robot"].wrenches
    assert wrenches.keys() == {"left_foot", "right_foot", "right_hand"}
    links = placed(robot, result.tree, solution.postures["robot"])
    depth, _, height = one_hand.scene.payload.size
    grip = links[robot.hands[0].frame].translation
    assert grip == pytest.approx([-depth / 2.0, 0.0, 0.8 + height / 2.0], abs=1e-5)
    carried = -sum(
        float(posture.wrenches[hand.name][2])
        for agent, posture in ((robot, solution.postures["robot"]), (human, solution.postures["human"]))
        for hand in agent.hands
    )
    assert carried == pytest.approx(G * one_hand.scene.payload.mass, abs=1e-4)
    details = Evaluator(one_hand).details(result)
    assert details[0].agents["robot"].wrenches.keys() == wrenches.keys()


def test_a_hand_must_hold_the_load() -> None:
    tables = shipped("one_hand")
    tables["robot"]["hands"] = {}
    with pytest.raises(InputError, match="wanted left, right, or both, found neither") as error:
        build_problem(source_of(tables))
    assert error.value.key == "robot.hands"


def on_a_plate() -> dict[str, Any]:
    """The iCub without its legs' joints, on a plate of half a metre under its left sole's height."""
    tables = shipped("one_hand", task={"heights_m": [0.8]})
    robot = tables["robot"]
    robot.pop("hands")
    robot.pop("knee_flexion_deg")
    robot["joints"] = [
        name for name in robot["joints"] if not any(p in name for p in ("hip", "knee", "ankle"))
    ]
    robot["frames"] = [{"name": "plate", "link": "root_link", "xyz_m": [0.0, 0.0, -0.6]}]
    robot["base"] = {"frame": "plate", "size_m": [0.5, 0.5]}
    return tables


def test_a_robot_on_wheels_stands_within_its_rectangle() -> None:
    problem = built(on_a_plate())
    robot = problem.scene.robot
    assert [(foot.name, foot.side) for foot in robot.feet] == [("base", "")]
    assert not robot.on_feet
    result = Evaluator(problem).solve(problem.space.unscaled(robot.tree))
    (solution,) = result.cases
    assert solution.solved, solution.reason
    posture = solution.postures["robot"]
    plate = placed(robot, result.tree, posture)["plate"]
    assert plate.translation[2] == pytest.approx(0.0, abs=1e-5)
    assert plate.rotation[:, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-5)
    wrench = posture.wrenches["base"]
    pressure = np.array([-wrench[4], wrench[3]]) / wrench[2]
    assert np.abs(pressure).max() <= 0.25 + 1e-6
    hands = sum(float(posture.wrenches[hand.name][2]) for hand in robot.hands)
    assert wrench[2] + hands == pytest.approx(G * float(result.tree.mass), abs=1e-3)


@pytest.mark.parametrize("other", ["soles", "knee_flexion_deg"])
def test_wheels_and_feet_exclude_each_other(other: str) -> None:
    tables = on_a_plate()
    tables["robot"][other] = 15.0 if other == "knee_flexion_deg" else {"left": "l_sole", "right": "r_sole"}
    with pytest.raises(InputError, match="wanted either this key or base, found both") as error:
        build_problem(source_of(tables))
    assert error.value.key == f"robot.{other}"


@pytest.fixture(scope="module")
def two_people() -> DesignProblem:
    return built(shipped("two_people", task={"heights_m": [0.8, 1.0]}))


@pytest.mark.slow
def test_two_people_hold_a_load_without_a_robot(two_people: DesignProblem) -> None:
    """Hands and weight balance in the world; a quantity is that of both, or of the one who bears most."""
    scene = two_people.scene
    assert [(agent.name, agent.role) for agent in scene.agents] == [
        ("human", Role.PERSON),
        ("human_2", Role.PERSON),
    ]
    assert two_people.space.parameters == ()
    evaluator = Evaluator(two_people)
    result = evaluator.solve(())
    assert all(solution.solved for solution in result.cases), [each.reason for each in result.cases]
    norms, backs = [], []
    for solution in result.cases:
        center = np.array([0.0, 0.0, solution.case.task.heights[0]])
        force, moment = np.array([0.0, 0.0, -G * scene.payload.mass]), np.zeros(3)
        for agent in scene.agents:
            posture, turn = solution.postures[agent.name], world_of(agent)
            links = placed(agent, agent.tree, posture)
            for hand in agent.hands:
                own = -turn @ posture.wrenches[hand.name][:3]
                force += own
                moment += np.cross(links[hand.frame].translation - center, own)
                moment -= turn @ posture.wrenches[hand.name][3:]
        assert force == pytest.approx(0.0, abs=1e-4)
        assert moment == pytest.approx(0.0, abs=1e-4)
        norms.append(math.hypot(*(each.torque_norm for each in solution.postures.values())))
        people = [(agent, solution.postures[agent.name]) for agent in scene.agents]
        backs.append(max(compression(*each) for each in people))
    assert objective_value("human_torque", result) == pytest.approx(np.mean(norms), rel=1e-12)
    assert objective_value("back_compression", result) == pytest.approx(np.mean(backs), rel=1e-12)
    assessment, details = evaluator.assessment((), result), evaluator.details(result)
    told = evaluation_json(two_people, (), result, assessment, {}, details)
    assert told["cases"][0]["ergonomics"].keys() == {"human", "human_2"}
    assert model_json(two_people)["links"] == []
    (finding,) = preflight(two_people)
    assert finding.fault == ""


@pytest.mark.slow
def test_a_person_alone_reaches_as_far_as_beside_a_robot() -> None:
    """The reach that is found of a person beside a robot, by another route."""
    problem = built(shipped("person_alone", task={"heights_m": [1.0]}))
    found = Evaluator(replace(problem, whole_reach=True)).solve(()).reach
    alone = person_reach(problem.scene, "human", problem.options, symmetric=True)
    assert alone is not None
    assert found.highest == pytest.approx(alone.highest, abs=1e-4)
    assert found.lowest == pytest.approx(alone.lowest, abs=1e-4)


def test_people_alone_are_not_searched(two_people: DesignProblem) -> None:
    with pytest.raises(InputError, match="a parameter of it to search, found people alone"):
        two_people.settings()


@pytest.mark.parametrize(
    ("change", "key", "wanted"),
    [
        ({"objectives": {"minimise": ["robot_torque"]}}, "objectives.minimise[0]", "a [robot] for"),
        ({"constraints": {"mass_kg": {"upper": 60.0}}}, "constraints.mass_kg", "a [robot] for 'mass'"),
        (
            {"design": {"length": [{"name": "a", "links": ["b"], "lower": 0.5, "upper": 2.0}]}},
            "design",
            "a [robot] that it changes",
        ),
        ({"task": {"heights_m": [1.0], "robot_share": 0.5}}, "task.robot_share", "a [robot] with it"),
        ({"human": ()}, "human", ""),
    ],
)
def test_what_needs_a_robot_is_refused_of_people(change: dict[str, Any], key: str, wanted: str) -> None:
    with pytest.raises(InputError) as error:
        build_problem(source_of(shipped("two_people", **change)))
    assert error.value.key == key
    assert wanted in error.value.wanted


def test_somebody_must_hold_the_load() -> None:
    tables = shipped("two_people")
    tables.pop("human")
    with pytest.raises(InputError, match=r"wanted a \[robot\] or a \[human\] who holds the load") as error:
        build_problem(source_of(tables))
    assert error.value.key == "robot"


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("table_top", "2 robots and 1 person"),
        ("two_people", "no robots and 2 people"),
        ("robot_alone", "1 robot and no people"),
    ],
)
def test_a_lift_of_others_is_refused(name: str, found: str) -> None:
    problem = build_problem(source_of(shipped(name)))
    lift = Lift(from_m=0.8, to_m=1.0, seconds=1.5)
    with pytest.raises(
        InputError, match=f"wanted one robot and one person, who lift the load, found {found}"
    ):
        staged_pieces(problem, [lift])


@pytest.mark.slow
def test_the_reach_of_people_who_take_turns_is_that_of_all_whatever_their_order() -> None:
    sizes = [person("-x", name="tall", stature_m=1.9), person("-x", name="short", stature_m=1.5)]
    one, other = (
        Evaluator(replace(problem, tasks=problem.tasks[:1]))
        for problem in (
            built(shipped("two_people", human=[*people, person("+x", name="other")]))
            for people in (sizes, sizes[::-1])
        )
    )
    reaches = [reach.solve(()) for reach in one.inner.reaches.values()]
    assert len(reaches) == len(other.inner.reaches) == 4
    found = one.solve(()).reach.highest
    assert found == min(reach.highest for reach in reaches if reach.highest is not None)
    assert found == pytest.approx(other.solve(()).reach.highest, abs=1e-6)


@pytest.mark.parametrize(("table", "key"), [("robot", "robot.sides[0]"), ("human", "human.side")])
def test_another_word_than_a_side_is_refused_with_those_that_there_are(table: str, key: str) -> None:
    tables = shipped("table_top")
    tables["human"] = tables["human"][0]
    if table == "robot":
        tables["robot"]["sides"] = ["x"]
    else:
        tables["human"]["side"] = "left"
    with pytest.raises(InputError, match=r"wanted one of -x, -y, \+x, \+y, found") as error:
        build_problem(source_of(tables))
    assert error.value.key == key


def test_hands_of_a_generated_person_are_refused() -> None:
    tables = shipped("two_people", human=person("+x", hands={"right": "RightHand"}))
    with pytest.raises(InputError, match="a generated person has hands and soles of its own") as error:
        build_problem(source_of(tables))
    assert error.value.key == "human.hands"
