"""Problems in which a load is lifted: evaluation, objectives, what is logged, and what is refused."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import msgspec
import numpy as np
import pinocchio as pin
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.baseline import refuse_unsuited
from evodesign.evaluation.design_solver import DesignSolver
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.inner import inner_problems
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.mechanics.balance import GRAVITY
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.lifting import LiftProblem
from evodesign.nlp.method import MethodName
from evodesign.posture.check import AgentModel
from evodesign.posture.formulations.base import Setting
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import symmetric_forms
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value
from evodesign.records import Assessed, Assessment, CaseDetail, Hold, InstantDetail, Lift, Status, task_names
from evodesign.report.replay.recording import timed
from evodesign.violations import missed_height

pytestmark = pytest.mark.slow

TABLE = 'from_m = 0.8\nto_m = 1.2\nseconds = 1.5\nprofile = "minimum_jerk"'
TORQUE = '"robot_torque"'
MINIMISE = '"robot_torque", "worst_robot_torque", "energy", "worst_robot_power", "worst_l5s1_moment"'


def changed(repository: Path, *changes: tuple[str, str]) -> DesignProblem:
    """The shipped problem with other text, solved without a compiler."""
    source = read_source(repository / "problems" / "icub_lift.toml")
    text = source.text
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    built = build_problem(msgspec.structs.replace(source, text=text, method="ipopt"))
    return replace(built, options=replace(built.options, compiled=False))


@dataclass(frozen=True)
class Moving:
    """A problem with lifts, whose motions are solved natively, and holds by IPOPT without a compiler."""

    problem: DesignProblem
    solver: DesignSolver
    values: tuple[float, ...]
    result: DesignResult

    @classmethod
    def of(cls, problem: DesignProblem) -> Moving:
        native = replace(problem.options, compiled=True, seldom=True, method=MethodName.NATIVE)
        scene = problem.scene
        setting, own = Setting(scene, problem.space, problem.weights, native), inner_problems(problem)
        motions = LiftProblem(setting, symmetric=True, timed=own.lifts[scene.pair].timed)
        inner = replace(own, lifts={scene.pair: motions})
        solver = DesignSolver(problem, NOTHING_PRECOMPUTED, inner)
        values = tuple(problem.space.unscaled(scene.robot.tree))
        return cls(problem, solver, values, solver.solve(values))

    @property
    def timed(self) -> bool:
        """Whether least times of lifts are looked for."""
        return next(iter(inner_problems(self.problem).lifts.values())).timed

    @property
    def assessed(self) -> Assessed:
        evaluator = Evaluator(self.problem)
        return evaluator._assessed(self.values, self.result)


@pytest.fixture(scope="module")
def moving(repository: Path) -> Moving:
    """A short lift, after a hold at its beginning."""
    return Moving.of(
        changed(
            repository,
            (TABLE, "from_m = 0.9\nto_m = 1.1\nseconds = 1.5\nknots = 8\n\n[task]\nheights_m = [0.9]"),
            (TORQUE, MINIMISE),
        )
    )


@pytest.fixture(scope="module")
def logged(moving: Moving) -> CaseDetail:
    """As a log holds it."""
    assessed = msgspec.json.decode(msgspec.json.encode(moving.assessed), type=Assessed)
    assert assessed == moving.assessed
    return assessed.cases[1]


def norm(instant: InstantDetail, agent: str = "robot") -> float:
    return math.hypot(*instant.agents[agent].torques_n_m.values())


def drawn(instant: InstantDetail) -> float:
    """The robot's positive joint power [W]."""
    robot = instant.agents["robot"]
    return sum(max(robot.torques_n_m[name] * speed, 0.0) for name, speed in robot.speeds_rad_s.items())


def test_a_hold_and_a_lift_are_cases_and_share_the_hold_at_the_beginning(moving: Moving) -> None:
    lift = Lift(0.9, 1.1, 1.5, knots=8)
    assert [solution.case.task for solution in moving.result.cases] == [Hold(height_m=0.9), lift]
    assert moving.problem.holds == (Hold(height_m=0.9), Hold(height_m=1.1))
    assert all(solution.solved for solution in moving.result.cases)
    assert moving.assessed.assessment.violation == 0.0
    assert task_names(moving.result.cases[1].case)["profile"] == "minimum_jerk"


def test_the_log_holds_knots_and_moments_between_with_their_times(logged: CaseDetail) -> None:
    assert [instant.time_s for instant in logged.instants] == pytest.approx(np.linspace(0.0, 1.5, 15))
    heights = [moment.height_m for moment in logged.moments]
    assert heights[0] == pytest.approx(0.9)
    assert heights[7] == pytest.approx(1.0)
    assert heights[-1] == pytest.approx(1.1)
    assert heights == sorted(heights)


def test_the_speeds_in_the_log_are_those_of_its_positions(logged: CaseDetail) -> None:
    times = np.array([instant.time_s for instant in logged.instants])
    for agent in ("robot", "human"):
        for joint in logged.instants[0].agents[agent].joints_rad:
            at = [each.agents[agent].joints_rad[joint] for each in logged.instants]
            speeds = np.array([each.agents[agent].speeds_rad_s[joint] for each in logged.instants])
            assert speeds[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)
            assert np.trapezoid(speeds, times) == pytest.approx(at[-1] - at[0], abs=0.02)


def test_objectives_follow_from_the_logged_instants(moving: Moving, logged: CaseDetail) -> None:
    found, times = moving.assessed.assessment.objectives, [each.time_s for each in logged.instants]
    norms, powers = [norm(each) for each in logged.instants], [drawn(each) for each in logged.instants]
    held = norm(moving.assessed.cases[0].instants[0])
    assert found["robot_torque"] == pytest.approx((held + np.trapezoid(norms, times) / 1.5) / 2.0)
    assert found["worst_robot_torque"] == pytest.approx(max(held, *norms))
    assert found["energy"] == pytest.approx(np.trapezoid(powers, times))
    assert found["worst_robot_power"] == pytest.approx(max(powers))
    every = (*logged.instants, *moving.assessed.cases[0].instants)
    torques = [each.agents["human"].torques_n_m for each in every]
    spine = [math.hypot(each["jL5S1_rotx"], each["jL5S1_roty"]) for each in torques]
    assert found["worst_l5s1_moment"] == pytest.approx(max(spine))
    outcome = moving.assessed.assessment.cases[1]
    assert outcome.robot_torque_norm == pytest.approx(max(norms))


def test_the_robot_draws_what_it_gives_to_the_load_and_to_itself(moving: Moving, logged: CaseDetail) -> None:
    """Work of all joints, positive less negative, is the energy that bodies and load gain."""
    scene, result = moving.problem.scene, moving.result
    times = [each.time_s for each in logged.instants]
    work = {
        name: np.trapezoid(
            [
                sum(torque * agent.speeds_rad_s[joint] for joint, torque in agent.torques_n_m.items())
                for agent in (instant.agents[name] for instant in logged.instants)
            ],
            times,
        )
        for name in ("robot", "human")
    }
    gained = scene.payload.mass * GRAVITY * 0.2
    for agent, tree in ((scene.robot, result.tree), (scene.human, scene.human.tree)):
        model = AgentModel.of(agent, tree)
        ends = (result.cases[1].instants[place].postures[agent.name] for place in (0, -1))
        first, last = (_height_of_mass(model, each) for each in ends)
        gained += float(tree.mass) * GRAVITY * (last - first)
    assert sum(work.values()) == pytest.approx(gained, rel=0.03)
    energy = objective_value("energy", result)
    assert energy is not None
    assert energy >= work["robot"] - 1e-6


def _height_of_mass(model: AgentModel, posture: AgentPosture) -> float:
    body = model.body.model
    return float(pin.centerOfMass(body, body.createData(), model.at(posture).coordinates)[2])


def test_a_replay_shows_a_lift_in_real_time(moving: Moving) -> None:
    shown = [time / 1e9 for time, _ in timed(moving.assessed.cases)]
    assert shown[0] == 0.0, "the hold, for two seconds"
    assert shown[1:] == pytest.approx([2.0 + time for time in np.linspace(0.0, 1.5, 15)])


def test_a_slow_lift_needs_the_torques_of_holds_in_its_postures(repository: Path) -> None:
    """Without inertia torques are those of gravity; the first and the last hold are no worse."""
    table = "from_m = 0.9\nto_m = 1.1\nseconds = 60.0\nknots = 6\n\n[task]\nheights_m = [0.9, 1.1]"
    slow = Moving.of(changed(repository, (TABLE, table)))
    low, high, lift = slow.result.cases
    assert lift.solved, lift.reason
    for hold, place in ((low, 0), (high, -1)):
        least, found = (
            sum(agent.torque_norm**2 for agent in instant.postures.values())
            for instant in (hold.instants[0], lift.instants[place])
        )
        assert found > 0.98 * least
    assert max(posture.speeds["l_knee"] for posture in (i.postures["robot"] for i in lift.instants)) < 0.1


@pytest.fixture(scope="module")
def pushed(repository: Path) -> Moving:
    """A lift while somebody pushes."""
    push = '[[disturbance]]\nname = "pushed"\npush_n = [-20.0, 0.0, 0.0]\n\n[objectives]'
    table = "from_m = 0.9\nto_m = 1.1\nseconds = 1.5\nknots = 6"
    return Moving.of(changed(repository, (TABLE, table), ("[objectives]", push), (TORQUE, MINIMISE)))


def test_a_lift_under_a_disturbance_is_a_case_of_its_own(pushed: Moving) -> None:
    """Objectives follow from what the log holds of both, at every instant."""
    found, (case,) = pushed.assessed.assessment.objectives, pushed.assessed.cases
    times = [each.time_s for each in case.instants]
    norms = [
        [math.hypot(*load_case["robot"].torques_n_m.values()) for load_case in load_cases]
        for load_cases in zip(
            *[(each.agents, each.disturbed["pushed"]) for each in case.instants], strict=True
        )
    ]
    means = [np.trapezoid(each, times) / 1.5 for each in norms]
    assert means[0] != pytest.approx(means[1], rel=1e-3)
    assert found["robot_torque"] == pytest.approx(np.mean(means))
    assert found["worst_robot_torque"] == pytest.approx(max(map(max, norms)))
    powers = [
        [
            sum(
                max(torque * instant.agents["robot"].speeds_rad_s[name], 0.0)
                for name, torque in load_case["robot"].torques_n_m.items()
            )
            for instant, load_case in zip(case.instants, load_cases, strict=True)
        ]
        for load_cases in zip(
            *[(each.agents, each.disturbed["pushed"]) for each in case.instants], strict=True
        )
    ]
    assert found["energy"] == pytest.approx(np.mean([np.trapezoid(each, times) for each in powers]))
    outcome = pushed.assessed.assessment.cases[0]
    assert outcome.disturbed["pushed"]["robot"] == pytest.approx(max(norms[1]))


def test_a_height_out_of_reach_is_missed_by_a_lift_as_by_a_hold(repository: Path) -> None:
    high = Moving.of(changed(repository, (TABLE, "from_m = 0.9\nto_m = 2.5")))
    (case,) = high.result.cases
    assert case.status is Status.INFEASIBLE
    assert "out of reach" in case.reason
    assessment: Assessment = high.assessed.assessment
    assert high.result.reach.highest is not None
    assert assessment.violation == pytest.approx(2.5 - high.result.reach.highest)
    assert assessment.violation == missed_height(assessment.reach, assessment.cases)
    assert assessment.objectives.keys() == {"reach_height"}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (TABLE, "from_m = 1.0\nto_m = 1.0", r"task\.lift\[0\]\.to_m: wanted another height than from_m"),
        (TABLE, "from_m = 1.0\nto_m = 1.2\nseconds = 0.0", r"task\.lift\[0\]\.seconds.*> 0"),
        (TABLE, "from_m = -1.0\nto_m = 1.2", r"task\.lift\[0\]\.from_m.*> 0"),
        (TABLE, 'from_m = 1.0\nto_m = 1.2\nprofile = "jerky"', r"profile.*'jerky'"),
        (TABLE, "from_m = 1.0\nto_m = 1.2\nknots = 3", r"task\.lift\[0\]\.knots"),
        (TABLE, f"{TABLE}\n[[task.lift]]\n{TABLE}", r"task\.lift\[1\]: wanted each lift once"),
        (TORQUE, '"robot_torque", "paper_cost"', r"loads held still for 'paper_cost'"),
    ],
)
def test_lifts_that_there_are_not(repository: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        changed(repository, (old, new))


@pytest.fixture(scope="module")
def quick(repository: Path) -> Moving:
    """Two lifts of a robot with torque limits, whose least times count and are constrained."""
    lifts = "from_m = 0.9\nto_m = 1.1\nknots = 6\n\n[[task.lift]]\nfrom_m = 1.1\nto_m = 1.0\nknots = 6"
    human = '[robot.torque_limits_n_m]\n"*" = 40.0\n\n[human]'
    bound = "[constraints]\nworst_lift_seconds = { upper = 0.1 }\n\n[search]"
    asked = ('"robot_torque", "human_torque"', '"lift_seconds", "worst_lift_seconds"')
    hard = ("joints = [", 'torque_limits = "hard"\njoints = [')
    text = changed(repository, (TABLE, lifts), ("[human]", human), ("[search]", bound), asked, hard)
    return Moving.of(text)


def test_least_times_are_objectives_and_constraints_and_have_gradients(quick: Moving) -> None:
    """The mean and the largest of those of both lifts; both ways to a gradient agree."""
    assert quick.timed
    least = [case.motion.least for case in quick.result.cases]
    found = quick.assessed.assessment
    seconds = [each.seconds for each in least]
    assert found.objectives["lift_seconds"] == pytest.approx(np.mean(seconds))
    assert found.objectives["worst_lift_seconds"] == max(seconds)
    assert found.constraints == {"worst_lift_seconds": max(seconds)}
    assert found.violation > 0.0
    derivatives = Sensitivities(quick.problem, inner=quick.solver.inner)
    slow = derivatives.at(quick.values, quick.result).sensitivities()
    fast = assessed_gradients(quick.problem, derivatives, quick.values, quick.result).values
    records = quick.problem.space.records
    spans = {p.name: p.slope_at(x) for p, x in zip(records, quick.values, strict=True)}
    slopes = {"lift_seconds": np.mean([each.slope for each in least], axis=0)}
    slopes["worst_lift_seconds"] = least[int(np.argmax(seconds))].slope
    for name, slope in slopes.items():
        expected = slope * np.array(list(spans.values()))
        assert list(fast[name].values()) == pytest.approx(expected)
        along = slow[name].gradient
        assert along is not None, slow[name].notes
        assert [along[each] * spans[each] for each in spans] == pytest.approx(expected, abs=1e-8)


def test_least_times_are_looked_for_only_where_something_asks(moving: Moving) -> None:
    assert not moving.timed
    assert all(case.least_seconds is None for case in moving.result.cases[1:])
    assert objective_value("lift_seconds", moving.result) is None


def test_a_name_that_is_no_objective_is_refused_with_the_nearest(repository: Path) -> None:
    with pytest.raises(InputError, match=r"found 'peak_power'; did you mean 'worst_robot_power'\?"):
        changed(repository, (TORQUE, '"peak_power"'))


def test_energy_and_least_time_need_a_lift(problem: DesignProblem) -> None:
    for name in ("energy", "worst_lift_seconds"):
        text = problem.source.text.replace('"human_torque"', f'"{name}"')
        with pytest.raises(InputError, match=rf"a \[\[task\.lift\]\] for '{name}', found none"):
            build_problem(msgspec.structs.replace(problem.source, text=text))
    text = problem.source.text.replace("heights_m = [0.8, 1.0, 1.2]", "")
    with pytest.raises(InputError, match=r"task: wanted heights_m, a \[\[task\.lift\]\], or both"):
        build_problem(msgspec.structs.replace(problem.source, text=text))


def test_what_is_for_loads_held_still_is_refused(repository: Path) -> None:
    lifting = changed(repository)
    with pytest.raises(InputError, match=r"search\.algorithm: wanted another where a load is lifted"):
        lifting.settings("joint-starts")
    with pytest.raises(InputError, match="loads held still in the joint problem"):
        refuse_unsuited(lifting)


def test_gradients_under_a_disturbance_are_those_of_differences_along_the_tangent(pushed: Moving) -> None:
    """The quick chain rule over instants against whole tangents; tests/motion has those of the motion."""
    derivatives = Sensitivities(pushed.problem, inner=pushed.solver.inner)
    slow = derivatives.at(pushed.values, pushed.result).sensitivities()
    quick = assessed_gradients(pushed.problem, derivatives, pushed.values, pushed.result).values
    spans = {p.name: p.slope_at(x) for p, x in zip(pushed.problem.space.records, pushed.values, strict=True)}
    for name in ("robot_torque", "worst_robot_torque", "energy", "worst_robot_power"):
        gradient = slow[name].gradient
        assert gradient is not None, slow[name].notes
        expected = [gradient[parameter] * spans[parameter] for parameter in spans]
        found = [quick[name][parameter] for parameter in spans]
        assert found == pytest.approx(expected, abs=1e-4 * max(map(abs, expected)))


EVERY = (
    "robot_torque",
    "human_torque",
    "robot_power",
    "l5s1_moment",
    "human_load_torque",
    "back_compression",
)


def neighbours(
    moving: Moving, result: DesignResult, direction: np.ndarray, shares: list[float]
) -> list[float]:
    """Every objective of designs along a direction, whose motions are solved to 1e-12 from a design's own."""
    case, problem = result.cases[0], moving.problem
    motion = case.motion
    options = replace(problem.options, compiled=True, seldom=True, method=MethodName.NATIVE)
    setting = Setting(problem.scene, problem.space, problem.weights, options)
    exact = replace(options, tolerance=1e-12, near=True)
    program = LiftProgram(KnotBlocks(symmetric_forms(problem.scene), setting), motion.lift.knots, exact)
    start, found = replace(motion.start, symbols=motion.ending.symbols), []
    for share in shares:
        values = np.array(result.values) + share * direction
        ending, _ = program.solve(motion.lift, start, values, problem.scene.payload.mass)
        assert ending.word == "Solve_Succeeded"
        instants = program.course(motion.lift, ending.symbols).instants(case.case.task.result_times)
        moved = replace(result, cases=(replace(case, instants=instants),))
        found.append([objective_value(objective.name, moved) for objective in problem.objectives])
    return found


def test_gradients_of_every_objective_are_those_of_solves_of_neighbours(repository: Path) -> None:
    """Central differences at two steps, extrapolated to none (Richardson), of two designs.

    Relative to the gradient along the direction, or to a thousandth of the objective or of its unit where it
    hardly moves: the person's torques often do not at all.
    """
    names = [*EVERY, *(f"worst_{name}" for name in EVERY), "energy"]
    asked = '"robot_torque", "human_torque"', ", ".join(f'"{name}"' for name in names)
    table = "from_m = 0.9\nto_m = 1.1\nseconds = 1.5\nknots = 8"
    moving = Moving.of(changed(repository, (TABLE, table), asked))
    derivatives = Sensitivities(moving.problem, inner=moving.solver.inner)
    records, rng, step = moving.problem.space.records, np.random.default_rng(4), 5e-5
    moves = 0
    for _ in range(2):
        values = moving.problem.space.values(tuple(rng.uniform(0.2, 0.8, len(records)).tolist()))
        result = moving.solver.solve(values)
        assert result.cases[0].solved, result.cases[0].reason
        gradients = assessed_gradients(moving.problem, derivatives, values, result)
        assert gradients.absent == {}
        ranges = np.array([p.slope_at(x) for p, x in zip(records, values, strict=True)])
        along = rng.standard_normal(len(records))
        ends = np.array(neighbours(moving, result, along * ranges, [-step, -step / 2, step / 2, step]))
        far, near = (ends[3] - ends[0]) / (2.0 * step), (ends[2] - ends[1]) / step
        for place, objective in enumerate(moving.problem.objectives):
            row = np.array(list(gradients.values[objective.name].values()))
            if objective.name == "reach_height":
                continue
            size = max(abs(float(row @ along)), 1e-3 * abs(ends[0][place]), 1e-3)
            assert (4.0 * near - far)[place] / 3.0 == pytest.approx(row @ along, abs=1e-4 * size), objective
            moves += abs(float(row @ along)) == size
    assert moves >= 15
