"""Joints that move together: one variable in the place of several, in programs, postures and the check."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from evodesign.human.coupled_joints import rhythms
from evodesign.mechanics.agent import HUMAN
from evodesign.mechanics.scene import Scene
from evodesign.motion.instant import KnotBlocks
from evodesign.nlp.solver import Solver
from evodesign.posture.check import TOLERANCE, AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import posture_program
from evodesign.posture.formulations.person import person_program
from evodesign.posture.seeking.starts import fixed_starts
from evodesign.posture.symmetry import Form, half, symmetric_forms, whole
from evodesign.posture.terms.floating_base import coordinate_ranges, joint_ranges
from evodesign.posture.warm_start import instants_of, layout_of, start_from
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Status
from tests.problem.test_person_keys import PERSON, with_lines

FLEXION = ("jL5S1_roty", "jL4L3_roty", "jL1T12_roty")
HEIGHT = 0.9


@pytest.fixture(scope="module")
def scene(problem: DesignProblem) -> Scene:
    return build_problem(with_lines(problem, PERSON, 'joint_ranges = "rhythm"')).scene


def setting_of(problem: DesignProblem, scene: Scene) -> Setting:
    return Setting(scene, problem.space, problem.weights, problem.options)


@pytest.fixture(scope="module", params=["whole", "half"])
def form(request: pytest.FixtureRequest, scene: Scene) -> Form:
    return half(scene.human) if request.param == "half" else whole(scene.human)


def test_positions_are_shares_of_coordinates_and_come_back(form: Form) -> None:
    """By hand: the lumbar joints, by their shares; all others as they are."""
    rng = np.random.default_rng(3)
    values = rng.uniform(-0.5, 0.5, len(form.coordinates))
    coordinate = dict(zip(form.coordinates, values, strict=True))
    found = dict(zip(form.joints, form.positions(values), strict=True))
    for name, position in found.items():
        led = [
            (each.name, share)
            for each in rhythms()
            for n, share in zip(each.joints, each.shares, strict=True)
            if n == name
        ]
        expected = led[0][1] * coordinate[led[0][0]] if led else coordinate[name]
        assert position == pytest.approx(expected, abs=1e-15)
    symbols = ca.SX.sym("q", len(values))
    image = ca.Function("image", [symbols], [form.positions(symbols)])
    assert np.asarray(image(values)).ravel() == pytest.approx(form.positions(values), abs=1e-15)
    assert len(form.joints) - len(form.coordinates) == (4 if form.mirror is None else 2)


def test_a_rhythm_keeps_within_the_ranges_of_its_joints_and_of_their_sums(form: Form) -> None:
    """At each end of the movement some range of a joint or of several ends, and none is exceeded."""
    ranges = dict(zip(form.joints, joint_ranges(form), strict=True))
    found = dict(zip(form.coordinates, coordinate_ranges(form), strict=True))
    for each in form.rhythms:
        assert found[each.name] == pytest.approx((each.lower, each.upper))
        for end in found[each.name]:
            assert all(
                ranges[n][0] <= share * end <= ranges[n][1]
                for n, share in zip(each.joints, each.shares, strict=True)
            )
    assert np.degrees(found["lumbar_flexion"]) == pytest.approx((-29.0, 45.0 / 0.6295))


def test_without_rhythms_forms_are_what_they_were(problem: DesignProblem) -> None:
    for form in symmetric_forms(problem.scene):
        assert tuple(form.coordinates) == form.joints
        assert coordinate_ranges(form) == joint_ranges(form)
        values = ca.SX.sym("q", len(form.joints))
        assert form.positions(values) is values


def test_the_person_holds_the_load_with_a_spine_that_bends_as_a_whole(
    problem: DesignProblem, scene: Scene
) -> None:
    """Solved, checked, and found again from its own posture."""
    forms = symmetric_forms(scene)
    program = posture_program(forms, setting_of(problem, scene))
    solver = Solver(program, problem.options)
    design = problem.space.values((0.5,) * len(problem.space.parameters))
    parameters = {"design": design, "height": HEIGHT, "mass": scene.payload.mass}
    raws = [solver.solve(parameters, start) for start in fixed_starts(program, [HUMAN])]
    best = min((raw for raw in raws if raw.status is Status.SOLVED), key=lambda raw: raw.cost)
    (instant,) = instants_of(layout_of(program), forms, scene, best.values)
    robot = AgentModel.of(scene.robot, problem.space.resized(scene.robot.tree, design))
    checker = Checker(scene, robot, AgentModel.of(scene.human, scene.human.tree))
    residuals = {each.name: each.size for each in checker.residuals(instant, HEIGHT)}
    assert max(residuals.values()) < TOLERANCE
    assert "human.rhythm" in residuals
    again = solver.solve(parameters, start_from(program, forms, [instant]))
    assert again.cost == pytest.approx(best.cost, rel=1e-6)

    bent = dict(instant.postures[HUMAN].joints)
    bent["jL4L3_roty"] += 0.1
    postures = {**instant.postures, HUMAN: replace(instant.postures[HUMAN], joints=bent)}
    found = {r.name: r.size for r in checker.residuals(replace(instant, postures=postures), HEIGHT)}
    assert found["human.rhythm"] == pytest.approx((1.0 - 0.412) * 0.1, abs=1e-6)


def test_the_cost_of_a_rhythm_moves_as_its_joints_together_do(problem: DesignProblem, scene: Scene) -> None:
    """The chain rule: the slope by the flexion is the sum of the slopes by the joints times their shares."""
    free = scene.with_agents(replace(scene.human, rhythms=()))
    slopes = []
    for each in (scene, free):
        form = half(each.human)
        program = person_program(form, each, 1.0)
        values = {v.name: v.start for v in program.variables}
        coordinates = np.linspace(-0.2, 0.3, len(half(scene.human).coordinates))
        values["human.joints"] = coordinates if form.rhythms else half(scene.human).positions(coordinates)
        rows = ca.Function(
            "f", [program.symbols, program.given], [ca.jacobian(program.rows, program.symbols)]
        )
        parameters = {"height": HEIGHT, "mass": 5.0, "internal_force": 0.0}
        jacobian = np.asarray(rows(program.packed(values), ca.vertcat(*parameters.values())))
        first = sum(v.symbol.numel() for v in program.variables[: names(program).index("human.joints")])
        slopes.append((form, jacobian[:, first : first + len(form.coordinates)]))
    (led, found), (_, by_joint) = slopes
    image = np.column_stack([led.positions(column) for column in np.eye(len(led.coordinates))])
    assert found == pytest.approx(by_joint @ image, abs=1e-9)


def names(program: object) -> list[str]:
    return [variable.name for variable in program.variables]  # type: ignore[attr-defined]


def test_a_lift_moves_the_spine_as_a_whole(problem: DesignProblem, scene: Scene) -> None:
    """Blocks of a lift have a variable for each coordinate, and the speeds of all joints."""
    forms = symmetric_forms(scene)
    blocks = KnotBlocks(forms, setting_of(problem, scene))
    joints = next(v for v in blocks.symbols.moving if v.name == "human.joints")
    assert len(joints.lower) == len(forms[1].coordinates) == len(forms[1].joints) - 2
    assert blocks.symbols.rates["human.joints"].numel() == len(forms[1].coordinates)
    assert blocks.knot.rows.numel() == len(blocks.knot.lower)
