"""Every term of the registry: its rows are its residuals, and its residuals fire when it is violated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import pytest

from evodesign.human.coupled_joints import coupled_joints
from evodesign.human.measured_posture import measured_posture
from evodesign.mechanics.agent import HUMAN, ROBOT, Gaze
from evodesign.mechanics.disturbance import Disturbance, Disturbances, PushedAt
from evodesign.mechanics.payload import Grasp, GraspDirection
from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import Program
from evodesign.posture.assemble import Assembly, CaseSymbols, Embodied, assemble
from evodesign.posture.check import TOLERANCE, AgentModel, Checker
from evodesign.posture.limit_groups import Enforced, LimitGroup
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.posture.terms.base import BodyTerm, Coupled, Row, SystemTerm
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.problem.build import DesignProblem

HEIGHT = 0.9
CLOSE = 1e-9


class Everything(Enforced):
    """All groups, with the rows that hold feet upright where joint limits do not."""

    def covers(self, group: LimitGroup) -> bool:
        return True


EVERY_ROW = Everything()

DISTURBED = Disturbances(
    (
        Disturbance("heavier", mass_share=0.2, center_of_mass=(0.03, 0.0, 0.01)),
        Disturbance("robot pushed", push=(-15.0, 0.0, 4.0), at=PushedAt.ROBOT),
        Disturbance("load pushed", push=(9.0, 0.0, -7.0)),
    )
)

SAME_MEASURE = {
    "hands_on_load", "foot_contact", "feet_apart", "feet_stagger", "trunk_clear", "torque",
    "load.push", "load.share", "coupled_joints",
}  # fmt: skip
"""Residuals that measure just what their rows do; others take other axes, or another function of an angle."""


def scene_of(problem: DesignProblem) -> Scene:
    payload = replace(problem.scene.payload, grasp=Grasp.RIGID, hand_moment=5.0)
    payload = replace(payload, grasp_direction=GraspDirection.SIDE)
    gaze = Gaze("Head", (0.02, 0.0, 0.12), 0.6)
    human = replace(problem.scene.human, coupled_joints=coupled_joints(), gaze=gaze)
    human = replace(human, measured=measured_posture(1.82))
    stance = replace(problem.scene.stance, feet_gap=0.005)
    scene = problem.scene.with_agents(human)
    return replace(scene, payload=payload, stance=stance, disturbances=DISTURBED)


def random_values(program: Program, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Somewhat beyond the bounds of joints and base, and wrenches of usual size."""
    values = {}
    for variable in program.variables:
        middle = np.clip((variable.lower + variable.upper) / 2.0, -1.0, 1.0)
        span = np.minimum((variable.upper - variable.lower) / 2.0, 0.6 * max(1.0, variable.scale))
        held = variable.lower == variable.upper
        noise = np.where(held, 0.0, 1.2 * span * rng.uniform(-1.0, 1.0, len(span)))
        values[variable.name] = variable.start + np.where(held, 0.0, 0.3 * middle) + noise
    return values


@pytest.fixture(scope="module", params=["whole", "half"])
def forms(request: pytest.FixtureRequest, problem: DesignProblem) -> tuple[Form, Form]:
    scene = scene_of(problem)
    return symmetric_forms(scene) if request.param == "half" else (whole(scene.robot), whole(scene.human))


def assembled(scene: Scene, forms: tuple[Form, Form]) -> Assembly:
    parties = (Embodied(forms[0], scene.robot.tree), Embodied(forms[1], scene.human.tree))
    return assemble(parties, TERMS.values(), CaseSymbols(scene, (HEIGHT,)), EVERY_ROW)


def program_of(made: Assembly) -> Program:
    return Program("all", made.variables, made.constraints, ca.SX(0.0), {})


@dataclass(frozen=True)
class Posed:
    """The scene with everything in it, assembled once for all terms and seeds."""

    scene: Scene
    forms: tuple[Form, Form]
    made: Assembly
    undisturbed: Assembly

    @cached_property
    def program(self) -> Program:
        return program_of(self.made)


@pytest.fixture(scope="module")
def posed(problem: DesignProblem, forms: tuple[Form, Form]) -> Posed:
    scene = scene_of(problem)
    undisturbed = replace(scene, disturbances=Disturbances())
    return Posed(scene, forms, assembled(scene, forms), assembled(undisturbed, forms))


def seen_rows(term: BodyTerm | SystemTerm, posed: Posed) -> Iterator[tuple[str, Row]]:
    """The rows of a term in the undisturbed load case, with the name of whom they are about."""
    undisturbed, forms = replace(posed.scene, disturbances=Disturbances()), posed.forms
    load_case = posed.undisturbed.undisturbed
    if isinstance(term, BodyTerm):
        for name, body in load_case.bodies.items():
            yield from ((f"{name}.", row) for row in term.rows(body))
    else:
        body = next(iter(load_case.bodies.values()))
        coupled = Coupled(
            undisturbed, load_case.bodies, load_case.hands, forms[0].mirror is not None, body.disturbance
        )
        yield from (("", row) for row in term.rows(coupled))


def test_registry_and_terms_agree_on_names() -> None:
    assert {name: term.name for name, term in TERMS.items()} == {name: name for name in TERMS}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_rows_say_what_the_residuals_say(posed: Posed, seed: int) -> None:
    """At random values of all variables, in every load case: another library finds the same violations."""
    scene, program, forms = posed.scene, posed.program, posed.forms
    values = random_values(program, np.random.default_rng(seed))
    rows = ca.Function("rows", [program.symbols], [c.expression for c in program.constraints])
    numbers = rows(program.packed(values))
    instant = instants_of(layout_of(program), forms, scene, values)[0]
    checker = checker_of(scene)
    found = {residual.name: residual for residual in checker.residuals(instant, HEIGHT)}
    said = {f"{owner}{row.name}": (owner, row) for t in TERMS.values() for owner, row in seen_rows(t, posed)}
    measured: dict[str, float] = {}
    compared = set()
    for constraint, number in zip(program.constraints, numbers, strict=True):
        case, name = split_case(constraint.name, scene)
        owner, row = said[name]
        column = np.asarray(number).ravel() * row.unit
        beyond = np.maximum(row.lower * row.unit - column, column - row.upper * row.unit)
        violation = max(0.0, float(np.abs(column).max() if row.lower == row.upper else beyond.max()))
        names = [f"{case}{owner}{residual}" for residual in row.residuals]
        if owner == "" and name == "feet.upright":
            names = [f"{agent}.feet_flat" for agent in (ROBOT, HUMAN)]
        assert set(names) <= set(found), (constraint.name, names)
        for each in names:
            measured[each] = max(measured.get(each, 0.0), violation)
            compared.add(each)
        if violation > 1e-6:
            assert max(found[each].size for each in names) > 1e-7, constraint.name
    for each in compared:
        kind = each.rsplit(": ", 1)[-1]
        kind = kind if kind.startswith("load.") else kind.split(".", 1)[1]
        if kind in SAME_MEASURE and kind not in {
            "feet_on_ground",
            "load.force_balance",
            "load.moment_balance",
        }:
            expected = pytest.approx(measured[each], rel=1e-7, abs=CLOSE)
            assert found[each].size == expected, each
    assert len(compared) > 30


def split_case(name: str, scene: Scene) -> tuple[str, str]:
    """A constraint's load case, as residuals say it, and the rest of its name."""
    for number, disturbance in enumerate(scene.disturbances.cases):
        prefix = f"disturbed_{number}."
        if name.startswith(prefix):
            return f"{disturbance.name}: ", name.removeprefix(prefix)
    return "", name


def test_every_residual_fires(problem: DesignProblem) -> None:
    """Each of every term, undisturbed and not, for some random posture; no residual is always silent."""
    scene, seen = scene_of(problem), set[str]()
    forms = (whole(scene.robot), whole(scene.human))
    program = program_of(assembled(scene, forms))
    checker = checker_of(scene)
    silent: set[str] = set()
    for seed in range(12):
        values = random_values(program, np.random.default_rng(seed))
        instant = instants_of(layout_of(program), forms, scene, values)[0]
        pushed = dict(instant.disturbed)
        name, postures = next(iter(pushed.items()))
        moved = {k: replace(p, base_position=p.base_position + 0.01) for k, p in postures.items()}
        instant = replace(instant, disturbed={**pushed, name: moved})
        found = checker.residuals(instant, HEIGHT)
        seen |= {residual.name for residual in found if residual.size > TOLERANCE}
        silent |= {residual.name for residual in found}
    never = {name for name in silent - seen if not name.endswith(("moved", "load.grasp"))}
    assert never == set(), "residuals that no posture violates"
    assert {f"{name}: {agent}.moved" for agent in (ROBOT, HUMAN)} <= seen


def test_a_point_grasp_that_passes_a_moment_is_seen(problem: DesignProblem) -> None:
    scene = problem.scene
    forms = (whole(scene.robot), whole(scene.human))
    program = program_of(assembled(scene, forms))
    values = random_values(program, np.random.default_rng(1))
    instant = instants_of(layout_of(program), forms, scene, values)[0]
    robot = instant.postures[ROBOT]
    moment = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    twisted = {name: wrench + ("hand" in name) * moment for name, wrench in robot.wrenches.items()}
    postures = {**instant.postures, ROBOT: replace(robot, wrenches=twisted)}
    found = {r.name: r.size for r in checker_of(scene).residuals(replace(instant, postures=postures), HEIGHT)}
    assert found["load.grasp"] == pytest.approx(1.0)


def test_torques_beyond_their_limits_are_seen(problem: DesignProblem) -> None:
    joint = problem.scene.robot.joints[0]
    robot = replace(problem.scene.robot, torque_limits={joint: 1.0}, limits_torques=True)
    scene = problem.scene.with_agents(robot)
    forms = (whole(robot), whole(scene.human))
    program = program_of(assembled(scene, forms))
    values = random_values(program, np.random.default_rng(1))
    values["robot.torques"] = np.full(len(robot.joints), 3.5)
    instant = instants_of(layout_of(program), forms, scene, values)[0]
    found = {residual.name: residual.size for residual in checker_of(scene).residuals(instant, HEIGHT)}
    assert found["robot.torque_limits"] == pytest.approx(2.5)
    assert "human.torque_limits" not in found


@pytest.mark.slow
@pytest.mark.parametrize("name", TERMS)
def test_derivatives_of_a_term_agree_with_differences(name: str, posed: Posed) -> None:
    """Rows and costs of one term, with respect to every variable, at random values."""
    scene, program, forms, made = posed.scene, posed.program, posed.forms, posed.made
    term, (undisturbed, *_) = TERMS[name], made.instants[0]
    if isinstance(term, BodyTerm):
        said = [part for body in undisturbed.bodies.values() for part in parts_of(term, body)]
    else:
        body = next(iter(undisturbed.bodies.values()))
        symmetric = forms[0].mirror is not None
        coupled = Coupled(scene, undisturbed.bodies, undisturbed.hands, symmetric, body.disturbance)
        said = parts_of(term, coupled)
    if not said:
        return  # bounds alone
    symbols = ca.vertcat(*[variable.symbol for variable in made.variables])
    stacked = ca.vertcat(*said)
    function = ca.Function("said", [symbols], [stacked, ca.jacobian(stacked, symbols)])
    at = program.packed(random_values(program, np.random.default_rng(7)))
    jacobian = np.asarray(function(at)[1])
    for _ in range(6):
        way = np.random.default_rng(_).standard_normal(len(at))
        way /= np.linalg.norm(way)
        step = 1e-5
        ahead, behind = (np.asarray(function(at + sign * step * way)[0]).ravel() for sign in (1.0, -1.0))
        differences = (ahead - behind) / (2.0 * step)
        exact = jacobian @ way
        assert np.abs(differences - exact).max() <= 1e-6 * max(1.0, np.abs(exact).max())


def parts_of(term: BodyTerm | SystemTerm, seen: Any) -> list[Any]:
    """Rows and costs of a term."""
    costs = [term.posture_cost(seen), term.cost(seen)]
    return [*(row.expression for row in term.rows(seen)), *(cost for cost in costs if cost is not None)]


def checker_of(scene: Scene) -> Checker:
    return Checker(
        scene, AgentModel.of(scene.robot, scene.robot.tree), AgentModel.of(scene.human, scene.human.tree)
    )


SAID = {LimitGroup.STANCE, LimitGroup.CONTACT, LimitGroup.JOINT_LIMITS, LimitGroup.COLLISIONS}
"""Groups of limits that a user may set, or has from a robot's file."""


@pytest.mark.parametrize("name", TERMS)
def test_rows_with_limits_say_which_these_are(posed: Posed, name: str) -> None:
    """In words, and in units that a price can be per; those of the stance with their keys."""
    for _, row in seen_rows(TERMS[name], posed):
        for limit, bounds in ((row.lower, row.least), (row.upper, row.most)):
            if row.lower == row.upper or not np.isfinite(limit) or row.group not in SAID:
                continue
            assert len(bounds) in (1, row.expression.numel())
            assert {bound.unit for bound in bounds} <= {"m", "rad", "N", "N m", "1"}
            assert all(bound.name for bound in bounds)
            assert row.group is not LimitGroup.STANCE or all(bound.key for bound in bounds)
