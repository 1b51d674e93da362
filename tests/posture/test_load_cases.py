"""One posture under disturbances: equilibrium in every case, and what the cases cost together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from evodesign.errors import ModelError
from evodesign.mechanics.agent import HUMAN, ROBOT, SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.disturbance import Disturbance, Disturbances, OverCases, PushedAt
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import SolverCache
from evodesign.posture.check import TOLERANCE, AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import AgentPosture, CaseSolution, Instant
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.posture.terms.base import TORQUE_UNIT
from evodesign.posture.warm_start import start_from
from evodesign.problem.build import DesignProblem
from evodesign.records import Case, Hold, Status
from tests.posture.test_joint import shifted
from tests.posture.violations import violations

HEAVIER = Disturbance("heavier", mass_share=0.2)
AWAY = Disturbance("pushed away", push=(20.0, 0.0, 0.0))
LEANING = Disturbance("leaning", center_of_mass=(0.05, 0.0, 0.0))
ROBOT_BACK = Disturbance("robot pushed", push=(-15.0, 0.0, 0.0), at=PushedAt.ROBOT)
HUMAN_BACK = Disturbance("human pushed", push=(15.0, 0.0, -5.0), at=PushedAt.HUMAN)
EVERY = (HEAVIER, AWAY, LEANING, ROBOT_BACK, HUMAN_BACK)
HEIGHT = 1.0
HOLD = Hold(height_m=HEIGHT)

Postures = Mapping[str, AgentPosture]


def disturbed(problem: DesignProblem, *cases: Disturbance, effort: OverCases = OverCases.WORST) -> Scene:
    return replace(problem.scene, disturbances=Disturbances(cases, effort))


def postures_in(
    scene: Scene, problem: DesignProblem, symmetry: Symmetry = Symmetry.ON, like: Postures | None = None
) -> PostureProblem:
    """A scene's posture problem, which begins at its own starts or at other postures."""
    solvers, setting = SolverCache(), Setting(scene, problem.space, problem.weights, problem.options)
    bare = PostureProblem(setting, symmetry, solvers=solvers)
    if like is None:
        return bare
    landscape = bare.landscape(HOLD)
    forms = symmetric_forms(scene) if symmetry is Symmetry.ON else (whole(scene.robot), whole(scene.human))
    start = start_from(landscape.seeker.program, forms, [Instant(0.0, like)])
    portfolio = StartPortfolio((start,), Coverage(0, 0, 0.0))
    return PostureProblem(
        setting, symmetry, Precomputed(postures={Case(person="", payload="", task=HOLD): portfolio}), solvers
    )


def checker_of(scene: Scene, problem: DesignProblem, values: tuple[float, ...]) -> Checker:
    tree = problem.space.resized(scene.robot.tree, values)
    return Checker(scene, AgentModel.of(scene.robot, tree), AgentModel.of(scene.human, scene.human.tree))


def solved(
    scene: Scene, problem: DesignProblem, symmetry: Symmetry = Symmetry.ON, like: CaseSolution | None = None
) -> CaseSolution:
    """Of the unscaled robot; begun at another solution's postures if there is one."""
    values = problem.space.unscaled(scene.robot.tree)
    checker = checker_of(scene, problem, values)
    postures = postures_in(scene, problem, symmetry, None if like is None else like.postures)
    solution = postures.solve(values, HOLD, checker)
    assert solution.status is Status.SOLVED, solution.reason
    assert max(solution.residuals.values()) < TOLERANCE
    return solution


def cost_of(solution: CaseSolution) -> float:
    return min(attempt.cost for attempt in solution.attempts if attempt.status is Status.SOLVED)


@pytest.fixture(scope="module")
def undisturbed(problem: DesignProblem) -> CaseSolution:
    return solved(problem.scene, problem)


@pytest.fixture(scope="module")
def borne(problem: DesignProblem) -> CaseSolution:
    """The unscaled robot under every kind of disturbance."""
    return solved(disturbed(problem, *EVERY), problem)


@pytest.mark.parametrize("effort", list(OverCases))
def test_disturbances_of_size_zero_are_none(
    effort: OverCases, problem: DesignProblem, undisturbed: CaseSolution
) -> None:
    nothing = (Disturbance("a"), Disturbance("b", at=PushedAt.HUMAN))
    solution = solved(disturbed(problem, *nothing, effort=effort), problem, like=undisturbed)
    assert cost_of(solution) == pytest.approx(cost_of(undisturbed), abs=1e-6)
    for postures in (solution.postures, *solution.disturbed.values()):
        for agent, posture in undisturbed.postures.items():
            torques = [postures[agent].torques[joint] for joint in posture.torques]
            assert torques == pytest.approx(list(posture.torques.values()), abs=1e-3)
            for side in SIDES:
                assert postures[agent].wrenches[f"{side}_foot"] == pytest.approx(
                    posture.wrenches[f"{side}_foot"], abs=1e-2
                )


def test_the_posture_is_the_same_in_every_case(borne: CaseSolution) -> None:
    assert list(borne.disturbed) == [case.name for case in EVERY]
    for postures in borne.disturbed.values():
        for agent, posture in postures.items():
            assert posture.joints == borne.postures[agent].joints
            assert np.array_equal(posture.base_position, borne.postures[agent].base_position)
            assert posture.torques != borne.postures[agent].torques


def test_hands_and_feet_carry_weight_and_push(borne: CaseSolution, problem: DesignProblem) -> None:
    """Closed forms: forces on the load, and vertical ones on the agents (soles are flat)."""
    scene = problem.scene
    for case in EVERY:
        postures, on_load = borne.disturbed[case.name], case.push_on(PushedAt.LOAD)
        forward = {
            agent.name: -agent.turn[0][0]
            * sum(postures[agent.name].wrenches[f"{side}_hand"][0] for side in SIDES)
            for agent in scene.agents
        }
        held = -sum(postures[agent].wrenches[f"{side}_hand"][2] for agent in forward for side in SIDES)
        load = scene.payload.mass * (1.0 + case.mass_share) * GRAVITY
        assert held == pytest.approx(load - on_load[2], abs=1e-4)
        assert sum(forward.values()) == pytest.approx(-on_load[0], abs=1e-4)
        assert abs(forward[ROBOT] - forward[HUMAN]) / 2.0 <= scene.stance.push + 1e-4
        for agent in scene.agents:
            posture, push = postures[agent.name], case.push_on(PushedAt(agent.name))
            up = sum(float(posture.wrenches[f"{side}_foot"][2]) for side in SIDES)
            down = sum(float(posture.wrenches[f"{side}_hand"][2]) for side in SIDES) + push[2]
            mass = sum(link.inertia.mass for link in agent.tree.links)
            assert up == pytest.approx(mass * GRAVITY - down, abs=1e-3)


def test_an_offset_load_leans_on_whom_it_is_nearer_to(borne: CaseSolution, problem: DesignProblem) -> None:
    """Lever rule of a beam half a metre long, but for the moment of the push between the agents."""
    hands = borne.disturbed[LEANING.name][HUMAN].wrenches
    carried = -sum(float(hands[f"{side}_hand"][2]) for side in SIDES)
    expected = problem.scene.payload.mass * GRAVITY * (0.25 + 0.05) / 0.5
    lever = problem.scene.payload.size[2]  # both grasps lie this much above the middle, twice
    assert carried == pytest.approx(expected, abs=problem.scene.stance.push * lever / 0.5 + 1e-4)


def test_worst_and_mean_are_each_best_at_what_they_minimise(
    problem: DesignProblem, borne: CaseSolution
) -> None:
    mean = solved(disturbed(problem, *EVERY, effort=OverCases.MEAN), problem, like=borne)
    worst = solved(disturbed(problem, *EVERY, effort=OverCases.WORST), problem, like=mean)

    def efforts(solution: CaseSolution) -> list[float]:
        cases = (solution.postures, *solution.disturbed.values())
        return [sum(p.torque_norm**2 for p in postures.values()) / TORQUE_UNIT**2 for postures in cases]

    comfort = 0.05
    assert np.mean(efforts(mean)) <= np.mean(efforts(worst)) + comfort
    assert max(efforts(worst)) <= max(efforts(mean)) + comfort
    assert max(efforts(worst)) <= cost_of(worst) + 0.02 * max(efforts(worst)), "the cost holds the worst case"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_growing_disturbances_never_lower_the_worst_case_optimum(seed: int, problem: DesignProblem) -> None:
    """Smaller ones begin at the posture that is best for larger ones, which holds them as well."""
    rng = np.random.default_rng(seed)
    values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
    costs: list[float] = []
    like: Postures | None = None
    for size in (1.0, 0.5, 0.0):
        cases = (
            Disturbance("heavier", mass_share=0.2 * size),
            Disturbance("away", push=(20.0 * size, 0.0, 0.0)),
        )
        scene = disturbed(problem, *cases)
        best = postures_in(scene, problem, like=like).solve(values, HOLD, checker_of(scene, problem, values))
        costs.append(cost_of(best))
        like = best.postures
    assert costs[0] > costs[1] > costs[2]


@pytest.mark.parametrize("agent", [ROBOT, HUMAN])
@pytest.mark.parametrize(
    ("part", "residual"),
    [("joints", "moved"), ("torques", "torque"), ("hand", "force_balance"), ("foot", "foot_contact")],
)
def test_the_check_sees_what_is_wrong_under_a_disturbance(
    agent: str, part: str, residual: str, borne: CaseSolution, problem: DesignProblem
) -> None:
    scene = disturbed(problem, *EVERY)
    checker = checker_of(scene, problem, problem.space.unscaled(scene.robot.tree))
    name = AWAY.name
    wrong = {**borne.disturbed[name], agent: shifted(borne.disturbed[name][agent], part)}
    found = violations(checker, borne.postures, HEIGHT, {**borne.disturbed, name: wrong})
    assert found[f"{name}: {agent}.{residual}"] > TOLERANCE
    assert all(size <= TOLERANCE for key, size in found.items() if not key.startswith(name))


@pytest.mark.parametrize("case", EVERY)
def test_the_check_sees_a_disturbance_of_another_size(
    case: Disturbance, borne: CaseSolution, problem: DesignProblem
) -> None:
    stronger = replace(
        case,
        mass_share=1.1 * case.mass_share,
        center_of_mass=(1.1 * case.center_of_mass[0], 0.0, 0.0),
        push=(1.1 * case.push[0], 0.0, 1.1 * case.push[2]),
    )
    others = tuple(stronger if other is case else other for other in EVERY)
    scene = disturbed(problem, *others)
    checker = checker_of(scene, problem, problem.space.unscaled(scene.robot.tree))
    found = violations(checker, borne.postures, HEIGHT, borne.disturbed)
    assert max(size for key, size in found.items() if key.startswith(case.name)) > 0.1


def test_a_sideways_disturbance_is_refused_by_name_in_symmetric_postures(problem: DesignProblem) -> None:
    aside = Disturbance("gust", push=(0.0, 10.0, 0.0))
    with pytest.raises(ModelError, match="disturbance 'gust': wanted y = 0 everywhere"):
        symmetric_forms(disturbed(problem, HEAVIER, aside))


def test_a_push_beside_the_middle_line_is_refused_by_name_in_symmetric_postures(
    problem: DesignProblem,
) -> None:
    scene = disturbed(problem, ROBOT_BACK)
    beside = scene.with_agents(replace(scene.robot, trunk=("chest", "l_upper_arm")))
    with pytest.raises(ModelError, match=r"'robot pushed': wanted a push on the middle line.*'l_upper_arm'"):
        symmetric_forms(beside)


def test_free_postures_resist_a_sideways_push(problem: DesignProblem, undisturbed: CaseSolution) -> None:
    aside = Disturbance("gust", push=(0.0, 10.0, 0.0))
    solution = solved(disturbed(problem, aside), problem, Symmetry.OFF, like=undisturbed)
    hands = solution.disturbed["gust"]
    scene = problem.scene
    sideways = sum(
        -agent.turn[1][1] * float(hands[agent.name].wrenches[f"{side}_hand"][1])
        for agent in scene.agents
        for side in SIDES
    )
    assert sideways == pytest.approx(-10.0, abs=1e-4)


def test_with_rigid_grasps_a_push_needs_torques_that_the_undisturbed_posture_does_not(
    problem: DesignProblem,
) -> None:
    """Joints stacked on the line of gravity need hardly any torque, until somebody pushes."""
    payload = replace(problem.scene.payload, grasp=Grasp.RIGID)
    undisturbed = solved(replace(problem.scene, payload=payload), problem)
    assert undisturbed.postures[ROBOT].torque_norm < 1.5
    pushed = solved(replace(disturbed(problem, AWAY), payload=payload), problem, like=undisturbed)
    assert pushed.disturbed[AWAY.name][ROBOT].torque_norm > undisturbed.postures[ROBOT].torque_norm + 1.0


@pytest.mark.slow
def test_postures_at_the_reach_with_disturbances_are_in_balance(problem: DesignProblem) -> None:
    """Pushes on the chest from both sides ask for a low stand and the middle of the soles."""
    values = problem.space.unscaled(problem.scene.robot.tree)
    pushes = tuple(replace(ROBOT_BACK, name=f"{x:g} N", push=(x, 0.0, 0.0)) for x in (-110.0, 110.0))
    scenes = [disturbed(problem, *cases) for cases in ((), (HUMAN_BACK,), pushes)]
    undisturbed, beside, shaken = (
        ReachProblem(Setting(scene, problem.space, problem.weights, problem.options), symmetric=True).solve(
            values
        )
        for scene in scenes
    )
    assert (beside.lowest, beside.highest) == (undisturbed.lowest, undisturbed.highest), (
        "it is the person who is pushed"
    )
    assert undisturbed.lowest is not None
    assert undisturbed.highest is not None
    assert shaken.lowest is not None
    assert shaken.highest is not None
    assert undisturbed.lowest + 0.05 < shaken.lowest < shaken.highest < undisturbed.highest - 0.01
    postures, checker = postures_in(scenes[2], problem), checker_of(scenes[2], problem, values)
    assert postures.solve(values, Hold(height_m=shaken.lowest + 0.01), checker).solved
