"""Who carries how much: rigid grasps, moments of a hand, fixed and chosen shares and weights."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.design.parameter import EFFORT_RATIO, ROBOT_SHARE, DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.mechanics.agent import HUMAN, ROBOT, SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import Solver
from evodesign.posture.allocation import EffortWeights, shared_scene
from evodesign.posture.check import TOLERANCE, AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.codesign import JointProblem
from evodesign.posture.formulations.joint import posture_program
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import AgentPosture, CaseSolution, Instant
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.posture.warm_start import instants_of, layout_of, start_from
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Hold, Status
from tests.posture.violations import violations

ONE = Hold(height_m=1.0)

NO_POLICY = DesignSpace(())
MASS = 10.0
EQUAL = EffortWeights()
Postures = Mapping[str, AgentPosture]


def allocation(name: str, lower: float = 0.0, upper: float = 1.0) -> DesignSpace:
    return DesignSpace((DesignParameter(ParameterKind.ALLOCATION, name, (), lower, upper),))


def rigid(problem: DesignProblem, moment: float = math.inf, share: float | None = None) -> Scene:
    payload = replace(problem.scene.payload, mass=MASS, grasp=Grasp.RIGID, hand_moment=moment)
    return replace(problem.scene, payload=payload, robot_share=share)


def solve(
    problem: DesignProblem,
    scene: Scene,
    height: float = 1.0,
    weights: EffortWeights = EQUAL,
    space: DesignSpace = NO_POLICY,
    values: Sequence[float] = (),
    symmetry: Symmetry = Symmetry.ON,
) -> CaseSolution:
    """The unscaled robot's posture; everything that is checked holds."""
    options = replace(problem.options, tolerance=1e-10)
    posture = PostureProblem(Setting(scene, space, weights, options), symmetry)
    found = posture.solve(values, Hold(height_m=height), checker(shared_scene(scene, space, values)))
    assert found.solved, found.reason
    assert max(found.residuals.values()) <= TOLERANCE
    return found


def checker(scene: Scene) -> Checker:
    return Checker(
        scene, AgentModel.of(scene.robot, scene.robot.tree), AgentModel.of(scene.human, scene.human.tree)
    )


def share(solution: CaseSolution) -> float:
    wrenches = solution.postures[ROBOT].wrenches
    return -float(sum(wrenches[f"{side}_hand"][2] for side in SIDES)) / (MASS * GRAVITY)


def moments(solution: CaseSolution) -> float:
    wrenches = [posture.wrenches[f"{side}_hand"] for posture in solution.postures.values() for side in SIDES]
    return float(np.abs([wrench[3:] for wrench in wrenches]).max())


def torques(solution: CaseSolution) -> list[float]:
    return [torque for posture in solution.postures.values() for torque in posture.torques.values()]


def norms(solution: CaseSolution) -> tuple[float, float]:
    return solution.postures[ROBOT].torque_norm, solution.postures[HUMAN].torque_norm


@pytest.mark.parametrize(
    ("height", "symmetric"),
    [(1.0, True), (1.2, False), *(pytest.param(each, True, marks=pytest.mark.slow) for each in (0.8, 1.2))],
)
@pytest.mark.parametrize(("moment", "close"), [(0.0, 1e-4), (1e-3, 0.05)])
def test_rigid_grasps_without_moments_and_with_an_equal_share_are_point_grasps(
    height: float, symmetric: bool, moment: float, close: float, problem: DesignProblem
) -> None:
    """As a problem file asks for it; begun at the point grasps' optimum, for there are several.

    Without any moment the balance leaves no other share; with a little, the share is forced by a row.
    """
    scene = asked_for(problem, f'grasp = "rigid"\nhand_moment_n_m = {moment}', "robot_share = 0.5")
    point = asked_for(problem, 'grasp = "point"', "robot_share = 0.5")
    assert (scene.robot_share, point.robot_share) == (0.5 if moment else None, None)
    begun = solve(problem, point, height, symmetry=Symmetry.ON if symmetric else Symmetry.OFF).postures
    forms = symmetric_forms(scene) if symmetric else (whole(scene.robot), whole(scene.human))
    optimum = end(problem, forms, point, height, begun)
    forced = end(problem, forms, scene, height, optimum)
    for agent in (ROBOT, HUMAN):
        expected = pytest.approx(list(optimum[agent].torques.values()), abs=close)
        assert list(forced[agent].torques.values()) == expected
        wrenches = [forced[agent].wrenches[f"{side}_hand"] for side in SIDES]
        assert -sum(wrench[2] for wrench in wrenches) == pytest.approx(MASS * GRAVITY / 2.0)
        assert max(np.abs(wrench[3:]).max() for wrench in wrenches) <= moment + 1e-7


def asked_for(problem: DesignProblem, grasp: str, task: str) -> Scene:
    """The scene of the point-grasp problem's file with another grasp, 10 kg and another task."""
    text = problem.source.text.replace('grasp = "point"', grasp).replace("mass_kg = 5.0", "mass_kg = 10.0")
    text = text.replace("heights_m =", f"{task}\nheights_m =")
    return build_problem(msgspec.structs.replace(problem.source, text=text)).scene


def end(
    problem: DesignProblem, forms: tuple[Form, Form], scene: Scene, height: float, postures: Postures
) -> Postures:
    """The optimum next to some postures; it passes the check."""
    options = replace(problem.options, tolerance=1e-10, near=True)
    solver = Solver(posture_program(forms, Setting(scene, NO_POLICY, EQUAL, options)), options)
    start = start_from(solver.program, forms, [Instant(0.0, postures)])
    raw = solver.solve({"design": [], "height": height, "mass": MASS}, start)
    assert raw.status is Status.SOLVED, raw.reason
    found = instants_of(layout_of(solver.program), forms, scene, raw.values)[0].postures
    assert max(violations(checker(scene), found, height).values()) <= TOLERANCE
    return found


@pytest.mark.slow
@pytest.mark.parametrize("symmetry", [Symmetry.ON, Symmetry.OFF])
def test_the_robot_carries_the_share_that_it_is_given(symmetry: Symmetry, problem: DesignProblem) -> None:
    for given in (0.0, 0.3, 1.0):
        found = solve(problem, rigid(problem, share=given), symmetry=symmetry)
        assert share(found) == pytest.approx(given, abs=1e-6)
        assert found.residuals["load.share"] <= TOLERANCE


def test_no_hand_transmits_more_than_its_limit(problem: DesignProblem) -> None:
    free, bounded = solve(problem, rigid(problem)), solve(problem, rigid(problem, moment=4.0))
    assert moments(free) > 10.0
    assert moments(bounded) == pytest.approx(4.0, abs=1e-6)
    assert sum(np.square(norms(bounded))) > sum(np.square(norms(free)))


def test_the_check_sees_shares_and_moments_that_were_not_asked_for(problem: DesignProblem) -> None:
    postures = solve(problem, rigid(problem, share=0.7)).postures
    other = violations(checker(rigid(problem, moment=3.0, share=0.4)), postures, 1.0)
    assert other["load.share"] == pytest.approx(0.3 * MASS * GRAVITY, rel=1e-6)
    wrenches = [p.wrenches[f"{side}_hand"][3:] for p in postures.values() for side in SIDES]
    assert other["load.hand_moment"] == pytest.approx(np.abs(wrenches).max() - 3.0)


def test_no_agent_lifts_the_other_by_the_load(problem: DesignProblem) -> None:
    """A person 10,000 times as precious would be carried by the robot, with several times the load."""
    found = solve(problem, rigid(problem), 0.6, EffortWeights(2e-4, 2.0))
    assert share(found) == pytest.approx(1.0, abs=1e-6)
    lifted = {
        name: replace(p, wrenches={n: (1.5 if "hand" in n else 1.0) * w for n, w in p.wrenches.items()})
        for name, p in found.postures.items()
    }
    residuals = violations(checker(rigid(problem)), lifted, 0.6)
    assert residuals["load.share"] == pytest.approx(0.5 * MASS * GRAVITY, rel=1e-5)


def test_a_share_chosen_by_the_design_is_the_same_share_fixed(problem: DesignProblem) -> None:
    fixed = solve(problem, rigid(problem, moment=7.0, share=0.3))
    chosen = solve(problem, rigid(problem, moment=7.0), space=allocation(ROBOT_SHARE), values=(0.3,))
    assert torques(chosen) == pytest.approx(torques(fixed), abs=1e-6)


def test_a_ratio_chosen_by_the_design_is_the_same_weights_fixed(problem: DesignProblem) -> None:
    weights = EffortWeights(2.0 * 10.0 / 11.0, 2.0 / 11.0)
    fixed = solve(problem, rigid(problem, moment=7.0), weights=weights)
    chosen = solve(
        problem, rigid(problem, moment=7.0), space=allocation(EFFORT_RATIO, -2.0, 2.0), values=(1.0,)
    )
    assert torques(chosen) == pytest.approx(torques(fixed), abs=1e-6)


def test_weights_add_up_to_two_and_have_their_ratio() -> None:
    for exponent in (-3.0, 0.0, 0.5, 6.0):
        weights = EffortWeights.of_ratio(exponent)
        assert weights.robot + weights.human == pytest.approx(2.0)
        assert math.log10(weights.robot / weights.human) == pytest.approx(exponent, abs=1e-9)


def test_robot_torque_falls_with_the_weight_of_its_effort(problem: DesignProblem) -> None:
    """An optimum of a weighted sum: the robot's part falls as its weight grows, the person's rises."""
    space, scene = allocation(EFFORT_RATIO, -2.0, 2.0), rigid(problem, moment=7.0)
    found = [norms(solve(problem, scene, 0.8, space=space, values=(e,))) for e in (-2.0, 0.0, 2.0)]
    robot, human = zip(*found, strict=True)
    assert robot[0] > 2.0 * robot[1] > 4.0 * robot[2]
    assert human[0] < human[1] < human[2]


def test_who_must_carry_more_reaches_less(problem: DesignProblem) -> None:
    setting = Setting(rigid(problem, moment=7.0), allocation(ROBOT_SHARE), EQUAL, problem.options)
    reach = ReachProblem(setting, symmetric=True)
    highest = [reach.solve((given,)).highest or 0.0 for given in (0.0, 1.0)]
    assert 1.0 < highest[1] <= highest[0] + 1e-6


def test_the_joint_problem_gives_shares_to_its_postures(problem: DesignProblem) -> None:
    """Held at a share, one height: the optimum of the posture problem."""
    scene, space = rigid(problem, moment=7.0), allocation(ROBOT_SHARE)
    alone = solve(problem, scene, space=space, values=(0.3,))
    joint = JointProblem(
        scene,
        space,
        (ONE,),
        replace(problem.joint, options=replace(problem.options, near=True)),
        (0.3,),
    )
    together = joint.polish((0.3,), [alone.instants[0]])
    assert together.solved, together.attempt.reason
    assert share(together.cases[0]) == pytest.approx(0.3, abs=1e-6)
    assert norms(together.cases[0]) == pytest.approx(norms(alone), abs=1e-3)


def test_the_joint_problem_finds_the_best_share(problem: DesignProblem) -> None:
    """Free to choose, it does no worse than the posture problem whose share is free."""
    scene, space = rigid(problem, moment=7.0), allocation(ROBOT_SHARE)
    alone = solve(problem, scene)
    joint = JointProblem(
        scene,
        space,
        (ONE,),
        replace(problem.joint, options=replace(problem.options, near=True)),
    )
    together = joint.polish((share(alone),), [alone.instants[0]])
    assert together.solved, together.attempt.reason
    assert together.design[0] == pytest.approx(share(alone), abs=1e-3)
    cost = min(attempt.cost for attempt in alone.attempts if attempt.status is Status.SOLVED)
    assert together.attempt.cost == pytest.approx(cost, rel=1e-4)


def test_shares_and_moments_bind_under_disturbances_too(problem: DesignProblem) -> None:
    heavier, pushed = Disturbance("heavier", mass_share=0.2), Disturbance("pushed", push=(-20.0, 0.0, -10.0))
    scene = replace(rigid(problem, 7.0, share=0.4), disturbances=Disturbances((heavier, pushed)))
    found = solve(problem, scene)
    for name, down in (("heavier", 1.2 * MASS * GRAVITY), ("pushed", MASS * GRAVITY + 10.0)):
        agents = found.disturbed[name]
        carried = {a: -sum(agents[a].wrenches[f"{side}_hand"][2] for side in SIDES) for a in (ROBOT, HUMAN)}
        assert carried[ROBOT] == pytest.approx(0.4 * down, abs=1e-5)
        assert carried[HUMAN] == pytest.approx(0.6 * down, abs=1e-5)
        assert (
            max(np.abs(p.wrenches[f"{side}_hand"][3:]).max() for p in agents.values() for side in SIDES)
            < 7.0 + 1e-6
        )
        assert found.residuals[f"{name}: load.share"] <= TOLERANCE
