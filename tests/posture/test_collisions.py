"""Rows that keep bodies apart, against coal, finite differences and points of shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.collision.clearance import BodyDistance, SolidBodies, places_of
from evodesign.collision.pairs import checked_pairs
from evodesign.collision.rules import FLOOR, LOAD, PARTNER, CollisionRules
from evodesign.collision.scene_bodies import CheckedBodies, SceneBodies
from evodesign.collision.supports import ConvexShape, shapes_of
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.nlp.method import MethodName
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.check import AgentModel, near_bodies
from evodesign.posture.design_checkers import DesignCheckers
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.person import person_program
from evodesign.posture.formulations.reach import (
    HEIGHT,
    LEAST,
    LOWEST,
    ReachProblem,
    reach_program,
    robot_reach_program,
)
from evodesign.posture.parting import Parted
from evodesign.posture.placed_shape import ROUNDING, SHAPE, PlacedShape, placed_shape
from evodesign.posture.postures import SYMMETRIC, PostureProblem, Symmetry
from evodesign.posture.precompute.meetings import _Finder, found_meetings, with_meetings
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED
from evodesign.posture.results import Instant
from evodesign.posture.separating_axes import ways_of
from evodesign.posture.solution_derivative import PostureDerivative
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.posture.terms.collisions import NUMBERS, directed, placed_pairs
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status
from evodesign.tree.kinematics import Pose
from evodesign.tree.model import Link, Look, Tree

pytestmark = pytest.mark.slow

MARGIN = 0.005
SHAPES: tuple[Shape, ...] = (Sphere(0.06), Cylinder(0.05, 0.3), Box(0.1, 0.24, 0.16), Cylinder(0.08, 0.05))


def link(shape: Shape) -> Link:
    return Link("one", own_inertia=Inertia(1.0), looks=(Look(shape, Placement()),))


def turned(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A rotation from a quaternion, and a place up to 0.3 m away."""
    w, x, y, z = (lambda q: q / np.linalg.norm(q))(rng.standard_normal(4))
    rotation = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rotation), rng.uniform(-0.3, 0.3, 3)


def numbers(shape: Shape, rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    (support,) = shapes_of(link(shape))
    pose = Pose(ca.SX(ca.DM(rotation)), ca.SX(ca.DM(position)))
    return np.array(ca.evalf(placed_shape(support, pose).numbers)).ravel()


def by_coal(one: Shape, other: Shape, rotation: np.ndarray, position: np.ndarray) -> float:
    bodies = SolidBodies(
        ("one", "other"),
        tuple(SolidBodies.of_tree(tree_of(shape)).solids[0] for shape in (one, other)),
    )
    at = Placement(tuple(map(tuple, rotation.tolist())), tuple(position.tolist()))
    placed = bodies.placed({"one": Placement(), "other": at})
    return placed.nearest(places_of(bodies.names, [("one", "other")])).distance


def tree_of(shape: Shape) -> Tree:
    return Tree("one", (link(shape),), ())


@pytest.mark.parametrize("one", SHAPES)
@pytest.mark.parametrize("other", SHAPES)
def test_the_best_direction_parts_bodies_as_far_as_they_are_apart(one: Shape, other: Shape) -> None:
    """Never farther than coal says; where coal finds 10 mm, they are told to be clear."""
    rng = np.random.default_rng(1)
    here = numbers(one, np.eye(3), np.zeros(3))
    for _ in range(60):
        rotation, position = turned(rng)
        apart = by_coal(one, other, rotation, position)
        pair = np.stack([here, numbers(other, rotation, position)])[None]
        found = ways_of([pair])[0].distance
        assert found <= apart + 1e-6
        assert found > 0.0 or apart < 0.01


def test_supports_reach_as_far_as_the_points_of_a_shape() -> None:
    rng = np.random.default_rng(2)
    circle = np.linspace(0.0, 2.0 * np.pi, 721)
    ring = np.stack([np.cos(circle), np.sin(circle), 0.0 * circle], axis=1)
    ends = np.concatenate([0.05 * ring + [0.0, 0.0, side] for side in (-0.15, 0.15)])
    corners = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.12, 0.12) for z in (-0.08, 0.08)])
    for shape, points in ((Cylinder(0.05, 0.3), ends), (Box(0.1, 0.24, 0.16), corners)):
        (support,) = shapes_of(link(shape))
        rotation, position = turned(rng)
        pose = Pose(ca.SX(ca.DM(rotation)), ca.SX(ca.DM(position)))
        placed: PlacedShape = placed_shape(support, pose)
        for direction in rng.standard_normal((20, 3)):
            unit = direction / np.linalg.norm(direction)
            farthest = float(np.max(points @ rotation.T @ unit))
            rounded = float(ca.evalf(placed.support(ca.DM(unit))))
            assert farthest - 2e-6 <= rounded <= farthest + ROUNDING * np.abs(points).max(axis=0).sum()


def test_what_fits_a_mesh_holds_all_of_its_points() -> None:
    from evodesign.collision.supports import _least

    rng = np.random.default_rng(3)
    for _ in range(5):
        points = rng.standard_normal((40, 3)) * [0.2, 0.05, 0.06]
        fit: ConvexShape = _least(points)
        pose = Pose(ca.SX.eye(3), ca.SX.zeros(3))
        placed = placed_shape(fit, pose)
        centre = np.array(ca.evalf(placed.centre)).ravel()
        for direction in rng.standard_normal((20, 3)):
            unit = direction / np.linalg.norm(direction)
            reach = float(ca.evalf(placed.support(ca.DM(unit))))
            assert np.max((points - centre) @ unit) <= reach + 1e-9


def kept_apart(problem: DesignProblem) -> DesignProblem:
    """The problem with pairs of all agents kept apart."""
    people = {
        id(agent): replace(
            agent,
            collisions=CollisionRules(
                MARGIN, checked_pairs(agent.tree, agent.joints, agent.hand_frames, agent.foot_frames)
            ),
        )
        for scene in problem.scenes
        for agent in scene.agents
    }
    scenes = tuple(
        scene.with_agents(*[people[id(agent)] for agent in scene.agents]) for scene in problem.scenes
    )
    return replace(problem, scenes=scenes)


@pytest.fixture(scope="module")
def apart(problem: DesignProblem) -> DesignProblem:
    return kept_apart(problem)


def setting_of(problem: DesignProblem) -> Setting:
    options = replace(problem.options, compiled=False, method=MethodName.IPOPT)
    return Setting(problem.scene, problem.space, EffortWeights(1.0, 1.0), options)


@pytest.fixture(scope="module")
def met(apart: DesignProblem) -> dict:
    """Looked for in a third of the usual designs, for time."""
    found = found_meetings(setting_of(apart), apart.tasks[:1], symmetric=True)
    return {(name, ""): tuple(pairs) for name, pairs in found.items()}


def test_pairs_that_come_near_are_found_without_being_named(met: dict, apart: DesignProblem) -> None:
    checked = {agent.name: agent.collisions.checked for agent in apart.scene.agents}
    assert ("l_foot_front", "r_foot_front") in met["robot", ""]
    assert set(met["robot", ""]) <= set(checked["robot"])
    assert set(met["human", ""]) <= set(checked["human"])
    assert 0 < len(met["reach", ""]) < len(checked["robot"]) / 4
    for other in (LOAD, FLOOR, PARTNER):
        assert ("head", other) in checked["robot"]
        assert ("l_hand", LOAD) not in checked["robot"]
    assert ("l_foot_front", FLOOR) not in checked["robot"]


def test_what_meets_at_corners_of_the_space_is_found_too(
    apart: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Searches end there, where shoulders come down to the hips above a short trunk."""

    setting, place = setting_of(apart), "evodesign.posture.precompute.meetings"
    monkeypatch.setattr(f"{place}.DESIGNS", 6)
    monkeypatch.setattr(f"{place}.FEWEST", 0)
    finder = _Finder(setting, True, 0, 1)
    inside, corners = finder._designs[:6], finder._designs[6:]
    assert len(corners) == 6
    lowest, highest = (apart.space.values((end,) * len(apart.space.parameters)) for end in (0.0, 1.0))
    ends = zip(apart.space.given(lowest, {}), apart.space.given(highest, {}), strict=True)
    for values, own in zip(zip(*corners, strict=True), ends, strict=True):
        assert set(values) <= set(own)
    everywhere = finder.held(apart.tasks[:1])
    finder._designs = inside
    assert finder.held(apart.tasks[:1]) < everywhere


def test_links_are_as_far_apart_as_in_the_world(apart: DesignProblem) -> None:
    """Every pair of links of the person, placed in the frame of a link that carries both and in the world."""
    human, scene = apart.scene.human, apart.scene
    assert human.collisions is not None
    rules = replace(human.collisions, parted=human.collisions.checked)
    form = symmetric_forms(scene.with_agents(replace(human, collisions=rules)))[1]
    program = person_program(form, scene, 1.0, switched=True)
    assert isinstance(program.switches, Parted)
    (parted,) = program.switches._bodies
    middle = (ca.DM([0.0, 1.0, 0.0]), 0.0)
    here, there = [], []
    for meeting in directed(form):
        if meeting.second == LOAD:
            continue
        shapes = [
            [
                placed_shape(shape, parted.body.poses[link])
                for shape in shapes_of(human.tree.link_by_name[link])
            ]
            for link in (meeting.first, meeting.second)
        ]
        seconds = [each.mirrored(middle) for each in shapes[1]] if meeting.mirrored else shapes[1]
        direction = ca.DM([1.0, *np.random.default_rng(len(here)).standard_normal(6)])
        for pairs, found in (
            (placed_pairs(parted.body, meeting), here),
            ([(one, other) for one in shapes[0] for other in seconds], there),
        ):
            found += [one.apart_along(other, direction) for one, other in pairs]
    labels = [meeting.label(form).split(" and ") for meeting in directed(form) if meeting.mirrored]
    assert labels
    for first, twin in labels:
        assert {first, twin} <= set(human.tree.link_by_name)
        assert twin not in {meeting.first for meeting in directed(form)}, (
            "a mirror image is a link of the other side"
        )
    apart_by = ca.Function("apart", [program.symbols, program.given], [ca.horzcat(*here, *there)])
    rng = np.random.default_rng(6)
    for _ in range(5):
        free = program.bounds[0] < program.bounds[1]  # of the base, what keeps the middle plane where it is
        at = program.packed({}) + free * rng.uniform(-0.5, 0.5, len(free))
        relative, world = np.split(np.array(apart_by(at, np.ones(program.given.numel()))).ravel(), 2)
        assert len(world) > 50
        assert np.allclose(relative, world, atol=1e-12)


def test_derivatives_of_rows_are_differences_of_rows(met: dict, apart: DesignProblem) -> None:
    scene = with_meetings(apart.scene, met)
    program = robot_reach_program(symmetric_forms(scene)[0], replace(setting_of(apart), scene=scene))
    assert program.switches is not None
    full = program.switches.program
    names = {"robot.clear", "robot.clear_of_mirror_image"}
    rows = ca.vertcat(*[block.expression for block in full.constraints if block.name in names])
    assert rows.numel() > 4
    value = ca.Function("rows", [full.symbols, full.given], [rows])
    slope = ca.Function("slope", [full.symbols, full.given], [ca.jacobian(rows, full.symbols)])
    rng = np.random.default_rng(4)
    design = np.array(apart.space.unscaled(apart.scene.robot.tree))
    given = {
        name: design if name == "design" else rng.uniform(0.5, 1.0, symbol.numel())
        for name, symbol in full.parameters.items()
        if name not in program.switches.names
    }
    start = full.unpacked(full.packed({}) + rng.uniform(-0.2, 0.2, full.symbols.numel()))
    on = program.switches.begun(start, given)
    point, parameters = full.packed({**start, **on}), full.packed_parameters(given, {**start, **on})
    exact = np.array(slope(point, parameters))
    step = 1e-6
    for column in range(len(point)):
        ahead, behind = point.copy(), point.copy()
        ahead[column] += step
        behind[column] -= step
        difference = np.array(value(ahead, parameters) - value(behind, parameters)).ravel() / (2 * step)
        assert np.allclose(exact[:, column], difference, atol=1e-6)


def test_the_posture_at_the_end_of_reach_fits_programs_that_part_other_bodies(
    apart: DesignProblem, met: dict
) -> None:
    known = replace(Evaluator(apart).known, meetings={**met, ("robot", ""): met["robot", ""][:-1]})
    evaluator = Evaluator(apart, known)
    values = apart.space.unscaled(apart.scene.robot.tree)
    reach, postures = evaluator.inner.reaches["", ROBOT, ""], evaluator.inner.postures[apart.scene.pair]
    (start,) = reach.extreme_posture(values, LOWEST)
    assert reach.extreme(values, LOWEST)[1].values.keys() - start.keys() > {HEIGHT}, "how bodies are parted"
    solved = postures.landscape(apart.tasks[0]).solve(tuple(values), start)
    assert solved.values.keys() >= start.keys()


def test_no_bodies_of_a_solved_posture_overlap(
    problem: DesignProblem, apart: DesignProblem, met: dict
) -> None:
    known = replace(Evaluator(apart).known, meetings=met)
    free, kept = Evaluator(problem), Evaluator(apart, known)
    rng = np.random.default_rng(5)
    changed = 0
    for design in [
        problem.space.values(tuple(point))
        for point in rng.uniform(0.2, 0.8, (3, len(problem.space.parameters)))
    ]:
        before, after = free.solve(design), kept.solve(design)
        for one, other in zip(before.cases, after.cases, strict=True):
            if other.solved:
                assert other.residuals["overlap"] == 0.0
                changed += other.attempt.cost > one.attempt.cost + 1e-6
    assert changed > 0


def test_a_solution_stays_without_the_rows_that_do_not_hold_it(apart: DesignProblem, met: dict) -> None:
    """With every row on, and with those that are needed: the same posture; without those, another one."""
    setting = replace(setting_of(apart), scene=with_meetings(apart.scene, met))
    seeker = ReachProblem(setting, symmetric=True)._seeker
    solver = seeker.solver
    (name,) = solver.program.switches.names
    values = apart.space.unscaled(apart.scene.robot.tree)
    parameters = {"design": values, "mass": apart.scene.payload.mass, "sense": LOWEST, LEAST: 0.0}
    start = {HEIGHT: [1.0], **solver.program.switches.begun({HEIGHT: [1.0]}, parameters)}
    found = seeker.settled(parameters, solver.solve(parameters, start))
    assert found.status is Status.SOLVED
    needed = seeker.needed(found)
    on, kept = (np.array(each[name]).reshape(-1, NUMBERS)[:, 0] != 0.0 for each in (found.values, needed))
    assert 0 < kept.sum() < on.sum()
    again = solver.near.solve(parameters, needed)
    assert again.cost == pytest.approx(found.cost, abs=1e-5)
    bare = {**found.values, name: np.zeros(len(found.values[name]))}
    assert solver.near.solve(parameters, bare).cost < found.cost - 1e-3


def test_postures_in_which_bodies_overlap_are_told(problem: DesignProblem, apart: DesignProblem) -> None:
    """Those of the problem without rows, by the checkers of the one that asks for parted bodies."""
    values = tuple(problem.space.unscaled(problem.scene.robot.tree))
    checkers = DesignCheckers(apart.scene, apart.space)
    told = []
    for case in Evaluator(problem).solve(values).cases:
        checker = checkers.of(values)
        assert checkers.of(values) is checker
        residuals = checker.task_residuals(case.instants, case.case.task.heights)
        deep = next(each.size for each in residuals if each.name == "overlap")
        ((*overlaps,),) = [checker.overlaps(case.instants, case.case.task.heights)]
        assert max((-gap.distance for gap in overlaps[0]), default=0.0) == deep
        told.append(deep > 1e-5)
    assert any(told)
    assert DesignCheckers(problem.scene, problem.space).of(values).overlaps(case.instants, (1.0,)) == [[]]


def test_bodies_that_are_wider_than_their_shapes_are_parted_farther(apart: DesignProblem, met: dict) -> None:
    """A check to which the chest reaches 0.2 m farther: the hands' rows ask for so much more."""
    scene, task, wide = with_meetings(apart.scene, met), Hold(height_m=1.0), 0.2
    problem = PostureProblem(replace(setting_of(apart), scene=scene), Symmetry.ON)
    values = tuple(apart.space.unscaled(scene.robot.tree))
    models = [AgentModel.of(agent, agent.tree) for agent in scene.agents]
    hands = {(f"{ROBOT} chest", f"{ROBOT} {hand}") for hand in ("l_hand", "r_hand")}
    asked: list[list[BodyDistance]] = []

    def near(instants: Sequence[Instant], heights: Sequence[float]) -> list[list[BodyDistance]]:
        ((instant,), (height,)) = instants, heights
        gaps = near_bodies(models, instant.postures, scene.payload.size, height, wide - 1e-5)
        own = [gap for gap in gaps if (gap.first, gap.second) in hands]
        asked.append([replace(gap, distance=gap.distance - wide) for gap in own])
        return asked[-1:]

    formulation = problem._formulation(SYMMETRIC, task, MethodName.IPOPT)
    found = problem.landscape(task).solve(values, {})
    cleared = formulation.cleared(values, found, task, SimpleNamespace(overlaps=near))
    assert len(asked[0]) == 2
    assert cleared.status is Status.SOLVED
    assert asked[-1] == []
    assert cleared.cost > found.cost + 1e-6
    always = SimpleNamespace(overlaps=lambda *_: [[replace(asked[0][0], distance=-0.01)]])
    assert formulation.cleared(values, found, task, always).status is not Status.SOLVED


def test_bodies_that_no_row_keeps_apart_are_no_matter_of_the_method(
    problem: DesignProblem, apart: DesignProblem
) -> None:
    """With rows for nothing, what overlaps is refused by the check, and IPOPT is not asked for the same."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    without = replace(apart, symmetry=Symmetry.ON)
    refused = [
        case for case in Evaluator(without, NOTHING_PRECOMPUTED).solve(values).cases if not case.solved
    ]
    assert refused
    for case in refused:
        assert "overlap" in case.reason
        assert {attempt.method for attempt in case.attempts} == {problem.options.method}


def test_the_lowest_load_is_higher_where_bodies_are_kept_apart(
    problem: DesignProblem, apart: DesignProblem, met: dict
) -> None:
    design = problem.space.unscaled(problem.scene.robot.tree)
    free = ReachProblem(setting_of(problem), symmetric=True)
    kept = ReachProblem(replace(setting_of(apart), scene=with_meetings(apart.scene, met)), symmetric=True)
    through, around = free.extreme(design, LOWEST)[0], kept.extreme(design, LOWEST)[0]
    assert through is not None
    assert around is not None
    assert through < around < 0.8


def test_costs_of_postures_that_rows_hold_move_as_their_derivatives_say(
    apart: DesignProblem, met: dict
) -> None:
    known = replace(Evaluator(apart).known, meetings=met)
    evaluator, rng = Evaluator(apart, known), np.random.default_rng(6)
    tangents = Sensitivities(apart, known, evaluator.inner)
    compared = 0
    for _ in range(3):
        point = tuple(rng.uniform(0.2, 0.8, len(apart.space.parameters)).tolist())
        values = np.array(apart.space.values(point))
        step = 1e-4 * values * rng.standard_normal(len(values))
        here, ahead, behind = (evaluator.solve(values + sign * step) for sign in (0.0, 1.0, -1.0))
        for solution, after, before in zip(here.cases, ahead.cases, behind.cases, strict=True):
            found = tangents.of_case(values, solution) if solution.solved else None
            assert not isinstance(found, NotDifferentiable) or "found again" not in found.reason
            if isinstance(found, PostureDerivative) and after.solved and before.solved:
                ends = [each.attempt.cost for each in (before, solution, after)]
                if abs(ends[0] - 2.0 * ends[1] + ends[2]) > 1e-4 * ends[1]:  # from another fixed start
                    continue
                difference = (ends[2] - ends[0]) / 2.0
                assert float(found.cost_slope @ step) == pytest.approx(difference, rel=1e-4, abs=1e-8)
                compared += 1
    assert compared >= 7


def test_another_way_is_worth_what_the_rows_it_relaxes_cost(apart: DesignProblem, met: dict) -> None:
    """Rows loosened by a little: the lowest load moves by their price times that."""
    setting = replace(setting_of(apart), scene=with_meetings(apart.scene, met))
    reach = ReachProblem(setting, symmetric=True)
    values = apart.space.unscaled(apart.scene.robot.tree)
    _, best = reach.extreme(values, LOWEST)
    switches = reach.program.switches
    assert isinstance(switches, Parted)
    prices = switches._meetings.prices(best.multipliers.constraints)
    parameters = {"design": values, "mass": apart.scene.payload.mass, "sense": LOWEST, LEAST: 0.0}
    (name,) = switches.names
    costs = []
    for loosened in (-1e-4, 1e-4):  # by less or more than the 10 m that switch a row off
        held = np.array(best.values[name]).reshape(-1, NUMBERS)
        held[held[:, 0] != 0.0, 0] -= loosened / 10.0
        costs.append(reach._solver.solve(parameters, {**best.values, name: held.ravel()}).cost)
    assert prices.sum() > 0.1
    assert costs[0] - costs[1] == pytest.approx(2e-4 * prices.sum(), rel=1e-2)


@pytest.mark.parametrize("name", [ROBOT, HUMAN])
def test_signs_are_those_of_coal_in_random_postures(name: str, apart: DesignProblem, met: dict) -> None:
    """Clear where coal finds 10 mm, and never farther apart than coal finds, in 1,000 postures of each."""
    scene = with_meetings(apart.scene, met)
    agent = {ROBOT: scene.robot, HUMAN: scene.human}[name]
    assert agent.collisions is not None
    form, tree = whole(agent), agent.tree
    program = reach_program(form, tree, scene, {}, switched=True)
    assert isinstance(program.switches, Parted)
    meetings = program.switches._meetings
    (body,) = program.switches._bodies
    labels = [(meeting.first, meeting.second) for meeting in directed(body.body.form)]
    model = AgentModel.of(agent, tree)
    bodies = CheckedBodies.of(tree, labels)
    solids = SceneBodies({name: bodies}, scene.payload.size)
    zeros = {each: np.zeros(program.parameters[each].numel()) for each in program.switches.names}
    rng, compared = np.random.default_rng(5), 0
    for _ in range(1_000):
        values = {each.name: rng.uniform(each.lower, each.upper) for each in program.variables}
        height = float(values[HEIGHT][0])
        numbers = (
            program.packed(values),
            program.packed_parameters({"mass": 1.0, "sense": 1.0, LEAST: 0.0}, zeros),
        )
        pairs = meetings.shapes(*numbers)[0].reshape(-1, 2, SHAPE)
        ways = ways_of([pairs[meetings.places == place] for place in range(len(labels))])
        least = meetings._screened(pairs, np.zeros((len(labels), NUMBERS))).least
        assert np.all(least <= np.array([way.distance for way in ways]) + 1e-9)
        assert np.all(least > -1.0)
        parts = {part.partition(".")[2]: value for part, value in values.items()}
        poses = {name: (agent.turn, model.at(form.expand(parts)).poses)}
        gaps = {
            tuple(each.rpartition(" ")[2] for each in (gap.first, gap.second)): gap.distance
            for gap in solids.near(poses, height, 0.05)
        }
        for label, way in zip(labels, ways, strict=True):
            by_coal = gaps.get(label, gaps.get(label[::-1]))
            if by_coal is not None:
                compared += 1
                assert way.distance <= by_coal + 1e-5, label
                assert way.distance > 0.0 or by_coal < 0.01, label
            else:
                assert way.distance > 0.0, label
    assert compared > 1_000
