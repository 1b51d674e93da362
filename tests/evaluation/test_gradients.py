"""Gradients that come with an evaluation: against differences, and from pool to log and search."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import AssessmentFactory, Evaluator
from evodesign.evolve import replay, resume, start
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.worker import SerialPool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.quantities.objectives import objective_kinds
from evodesign.quantities.push_quantities import SIMULATED
from evodesign.records import Assessment, Constraint, Genome, Gradients, Objective, Sense
from evodesign.runlog.header import header_of
from evodesign.runlog.run import digest, read_run
from evodesign.runlog.session_log import Silent
from evodesign.session import search_outcome
from evodesign.violations import bound_margin, height_margin, total_violation

TORQUES = ("robot_torque", "human_torque")

NEED_MORE = (
    "bodies_apart",
    "parts_apart",
    "shared_reach_height",
    "least_safety_factor",
    "fatigue_safety_factor",
    "cost",
    "energy",
    "lift_seconds",
    "worst_lift_seconds",
)
"""Quantities that ask for [collisions], for people's reach, for walls, for prices, or for lifts."""

STEP = 1e-4
"""Of the differences, as a share of a parameter's range."""


def drawn(count: int, dimension: int, seed: int) -> list[Genome]:
    return [
        tuple(row) for row in np.random.default_rng(seed).uniform(0.05, 0.95, (count, dimension)).tolist()
    ]


def quantities(assessment: Assessment) -> dict[str, float]:
    margin = height_margin(assessment.reach, assessment.cases)
    norms = [(case.robot_torque_norm, case.human_torque_norm) for case in assessment.cases]
    cases = {(name, k): pair[place] for k, pair in enumerate(norms) for place, name in enumerate(TORQUES)}
    return {**assessment.objectives, **cases, **({} if margin is None else {"height": margin})}


def slopes(gradients: Gradients) -> dict[object, list[float]]:
    """Of quantities, and of those in single cases by name and number."""
    whole = {name: list(row.values()) for name, row in gradients.values.items()}
    cases = {(name, k): case for name, cases in gradients.cases.items() for k, case in enumerate(cases)}
    return whole | {key: list(case.slopes) for key, case in cases.items() if case.slopes is not None}


def worst_errors(problem: DesignProblem, known: Precomputed, genomes: list[Genome]) -> list[dict[str, float]]:
    """Relative error of each gradient along one direction per design, evaluated in the processes of a pool.

    Central differences at two steps, extrapolated to none, beside the mean of the gradients at the two inner
    points: at the middle itself another optimum may win. Left out are designs at whose neighbours the two
    differences disagree: a limit is reached or another optimum wins in between.
    """
    tight = replace(problem, options=replace(problem.options, tolerance=1e-12))
    factory = AssessmentFactory("gradients", tight, known, gradients=True)
    generator = np.random.default_rng(5)
    along = generator.standard_normal((len(genomes), len(genomes[0])))
    asked = []
    for genome, direction in zip(genomes, along, strict=True):
        shares = (STEP, -STEP, STEP / 2.0, -STEP / 2.0)
        asked += [tuple((np.array(genome) + share * direction).tolist()) for share in shares]
    with JoblibPool(2) as pool:
        ends = sorted(pool.run(factory, asked), key=lambda end: end.index)
    assert [end.failure for end in ends] == [None] * len(asked)
    found = [end.value.assessment for end in ends]
    errors = []
    for number, direction in enumerate(along):
        sides = found[4 * number : 4 * number + 4]
        values = [quantities(side) for side in sides]
        inner = [slopes(side.gradients) for side in sides[2:]]
        error = {}
        for name in inner[0].keys() & inner[1].keys():
            if not all(each.get(name) is not None for each in values):
                continue
            row = np.mean([each[name] for each in inner], axis=0)
            far, near = (
                (values[k][name] - values[k + 1][name]) / (2.0 * STEP / (1 + k // 2)) for k in (0, 2)
            )
            slope = float(np.dot(row, direction))
            size = max(float(np.abs(row).max()), 1e-2 * abs(values[2][name]))
            if abs(far - near) < 1e-4 * size:
                error[name] = abs((4.0 * near - far) / 3.0 - slope) / size
        errors.append(error)
    return errors


@pytest.mark.slow
def test_gradients_agree_with_differences_through_the_pool(native: DesignProblem, known: Precomputed) -> None:
    names = ("human_load_torque", "back_compression", "worst_back_compression", "endurance_s")
    asked = tuple(Objective(name=name, sense=Sense.MINIMISE, unit="") for name in names)
    more = replace(native, objectives=(*native.objectives, *asked))
    errors = worst_errors(more, known, drawn(9, len(native.space.parameters), 2))
    compared = [error for each in errors for error in each.values()]
    assert len(compared) >= 80
    assert max(compared) < 1e-5
    assert min(sum(name in error for error in errors) for name in names) >= 2


@pytest.mark.slow
def test_the_quick_gradients_are_the_exact_ones(problem: DesignProblem, known: Precomputed) -> None:
    """Of every objective, against five-point differences along the exact tangent (`sensitivities`)."""
    limits = dict.fromkeys(problem.scene.robot.joints, 30.0)
    robot = replace(problem.scene.robot, torque_limits=limits)
    scenes = tuple(scene.with_agents(robot) for scene in problem.scenes)
    names = [name for name in objective_kinds() if name not in (*NEED_MORE, *SIMULATED)]
    every = tuple(
        Objective(name=name, sense=Sense.MINIMISE, unit="") for name in [*names, "q90_robot_torque"]
    )
    elbow = DesignParameter(ParameterKind.ACTUATOR, "elbow", (), 5.0, 50.0, joints=("l_elbow", "r_elbow"))
    space = DesignSpace((*problem.space.parameters, elbow))
    evaluator = Evaluator(replace(problem, scenes=scenes, objectives=every, space=space), known)
    (genome,) = drawn(1, len(space.parameters), 3)
    values = space.values(genome)
    exact = evaluator._sensitivities.at(values, evaluator.solve(values)).sensitivities()
    quick = evaluator.assess_with_gradients(genome).assessment.gradients
    assert quick.absent == {}
    spans = {each.name: each.slope_at(value) for each, value in zip(space.records, values, strict=True)}
    for objective in every:
        expected = {name: slope * spans[name] for name, slope in exact[objective.name].gradient.items()}
        size = max(map(abs, expected.values()))
        assert quick.values[objective.name] == pytest.approx(expected, abs=1e-5 * size + 1e-7)


def test_what_does_not_exist_has_no_gradient_and_a_reason(problem: DesignProblem, known: Precomputed) -> None:
    far = tuple(msgspec.structs.replace(task, height_m=4.0) for task in problem.tasks)
    evaluator = Evaluator(replace(problem, tasks=far[:1]), known)
    gradients = evaluator.assess_with_gradients((0.5,) * len(problem.space.parameters)).assessment.gradients
    assert set(gradients.values) == {"reach_height", "height"}
    assert gradients.absent == dict.fromkeys(("robot_torque", "human_torque"), "the design has no such value")
    reach = gradients.values["reach_height"]
    assert gradients.values["height"] == pytest.approx({name: -slope for name, slope in reach.items()})


@pytest.mark.slow
def test_a_run_holds_gradients_and_is_resumed_and_replayed_with_them(
    native: DesignProblem, known: Precomputed, tmp_path
) -> None:
    settings = msgspec.structs.replace(native.settings("surrogate", 8, 1), start=())
    assert settings.with_gradients
    factory = AssessmentFactory("run", native, known, gradients=True)
    with SerialPool() as pool:
        whole = start(tmp_path / "whole", header_of(native, settings, 24), factory, pool, Silent())
        start(tmp_path / "parts", header_of(native, settings, 20), factory, pool, Silent())
        parts = resume(tmp_path / "parts", lambda _: factory, pool, Silent(), 24)
    assert digest(parts.evaluations) == digest(whole.evaluations)
    replay(whole)
    for evaluation in read_run(tmp_path / "whole").evaluations:
        assert 0.0 < evaluation.gradient_seconds < evaluation.seconds
        gradients = evaluation.assessment.gradients
        outcome = search_outcome(whole.header, evaluation)
        reach = whole.header.objectives[-1]
        assert (reach.name, reach.sense) == ("reach_height", Sense.MAXIMISE)
        robot, human, none = outcome.parts
        assert (len(robot), len(human), none) == (len(native.cases), len(native.cases), ())
        assert np.mean([part.value for part in robot]) == pytest.approx(outcome.objectives[0], rel=1e-12)
        means = np.mean([part.gradient for part in human], axis=0)
        assert means == pytest.approx(outcome.gradients[1], rel=1e-9, abs=1e-12)
        assert outcome.gradients[-1] == tuple(-slope for slope in gradients.values["reach_height"].values())


def test_an_evaluation_without_gradients_is_as_before(problem: DesignProblem, known: Precomputed) -> None:
    settings = problem.settings("nsga2")
    assert not settings.with_gradients
    (genome,) = drawn(1, len(problem.space.parameters), 4)
    evaluator = Evaluator(problem, known)
    plain, full = evaluator.assess(genome), evaluator.assess_with_gradients(genome)
    assert b"gradient" not in msgspec.json.encode(plain.assessment)
    assert msgspec.structs.replace(full.assessment, gradients=msgspec.UNSET) == plain.assessment


def test_a_reference_point_is_given_by_objective(problem: DesignProblem) -> None:
    search = msgspec.structs.replace(problem.search, reference={"reach_height": 1.2, "robot_torque": 30.0})
    assert replace(problem, search=search).settings("surrogate").reference == (30.0, None, -1.2)
    search = msgspec.structs.replace(problem.search, reference={"reach": 1.2})
    with pytest.raises(InputError, match=r"search\.reference\.reach: wanted one of the objectives"):
        replace(problem, search=search).settings()


@pytest.mark.parametrize("value", [1.0, 2.5, 4.0, 5.0])
def test_a_margin_is_the_violation_where_it_is_positive(value: float) -> None:
    constraint = Constraint(name="mass", unit="kg", lower=2.0, upper=4.0)
    margin, slope = bound_margin(constraint, value)
    assert max(margin, 0.0) == pytest.approx(total_violation((constraint,), {"mass": value}, 0.0))
    step = 1e-6
    ends = [bound_margin(constraint, value + sign * step)[0] for sign in (1.0, -1.0)]
    assert slope == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-4) or value in (1.0, 4.0)
