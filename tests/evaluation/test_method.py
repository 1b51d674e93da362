"""Who solves: the native method, IPOPT in its place, and IPOPT as its judge."""

from __future__ import annotations

import itertools
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.evaluation.evaluate import Evaluator, case_outcome
from evodesign.evaluation.judge import ONE_IN, is_judged, judged_notes
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native.library import NativeMethod
from evodesign.nlp.program import Array
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import WHOLE, PostureProblem, Symmetry
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.solution_derivative import PostureDerivative, ReachDerivative
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Assessment, Evaluation, Hold, Status
from evodesign.runlog.header import header_of
from evodesign.runlog.upgrade import upgraded

NATIVE = SolverOptions(compiled=True, method=MethodName.NATIVE)


def test_ipopt_solves_what_is_not_compiled() -> None:
    assert replace(NATIVE, compiled=False).method is MethodName.IPOPT
    assert replace(NATIVE, iterations=5).method is MethodName.NATIVE


@pytest.mark.needs_compiler
def test_a_run_keeps_the_method_that_it_began_with(problem: DesignProblem) -> None:
    """Whatever the file says, and whatever this machine could do."""
    for method in MethodName:
        built = build_problem(msgspec.structs.replace(problem.source, method=method))
        assert built.options.method is method
        assert header_of(built, built.settings(), 1).problem.method == method
    assert build_problem(msgspec.structs.replace(problem.source, method=None)).options == NATIVE


def test_runs_that_do_not_tell_were_solved_by_ipopt(problem: DesignProblem) -> None:
    header = msgspec.to_builtins(header_of(problem, problem.settings(), 1))
    del header["problem"]["method"]
    assert upgraded(header)["problem"]["method"] == "ipopt"
    header["problem"]["method"] = "native"
    assert upgraded(header)["problem"]["method"] == "native"


def test_one_genome_in_so_many_is_judged() -> None:
    genomes = [(k / 40_000, 0.5) for k in range(40_000)]
    assert sum(map(is_judged, genomes)) == pytest.approx(len(genomes) / ONE_IN, rel=0.4)


def evaluation(own: dict[str, float], judged: dict[str, float] | None) -> Evaluation:
    assessment = Assessment(design={}, objectives=own, violation=0.0, status=Status.SOLVED, reason="")
    if judged is not None:
        assessment = msgspec.structs.replace(assessment, judged=judged)
    return Evaluation(number=7, generation=0, genome=(0.5,), assessment=assessment, seconds=0.0, worker="")


def test_differences_are_told_with_both_values() -> None:
    told = [
        evaluation({"torque": 10.0}, None),
        evaluation({"torque": 10.0, "reach": 0.001}, {"torque": 10.00005, "reach": 0.001009}),
        evaluation({"torque": 10.0, "reach": 1.5}, {"torque": 10.002}),
    ]
    assert list(judged_notes(told)) == [
        "evaluation 7: reach is 1.5; IPOPT finds no value",
        "evaluation 7: torque is 10; IPOPT finds 10.002",
    ]


@pytest.fixture(scope="module")
def natively(problem: DesignProblem, known: Precomputed) -> Evaluator:
    return Evaluator(replace(problem, options=NATIVE), known)


def unscaled_values(problem: DesignProblem) -> tuple[float, ...]:
    return problem.space.unscaled(problem.scene.robot.tree)


@pytest.mark.needs_compiler
def test_the_judge_agrees(natively: Evaluator, monkeypatch: pytest.MonkeyPatch) -> None:
    genome = natively.problem.space.genome(unscaled_values(natively.problem))
    assert natively.assess(genome).assessment.judged is msgspec.UNSET or is_judged(genome)
    monkeypatch.setattr("evodesign.evaluation.evaluate.is_judged", lambda _: True)
    assessment = natively.assess(genome).assessment
    assert assessment.judged == pytest.approx(assessment.objectives, rel=1e-5)
    assert assessment.judged != assessment.objectives  # it is another solve
    assert not any(case.fallbacks for case in assessment.cases)


@pytest.mark.needs_compiler
def test_ipopt_takes_over_where_the_native_method_fails(
    natively: Evaluator, evaluator: Evaluator, monkeypatch: pytest.MonkeyPatch
) -> None:
    unscaled = unscaled_values(natively.problem)
    solve = NativeMethod.solve

    def failing(self: NativeMethod, *arguments: object) -> Ending:
        return replace(solve(self, *arguments), word="Restoration_Failed")  # type: ignore[arg-type]

    monkeypatch.setattr(NativeMethod, "solve", failing)
    ours, theirs = natively.solve(unscaled), evaluator.solve(unscaled)
    assert ours.reach == theirs.reach
    for one, other in zip(ours.cases, theirs.cases, strict=True):
        assert one.status is Status.SOLVED
        assert one.attempt is not None
        assert other.attempt is not None
        assert one.attempt.method is MethodName.IPOPT
        assert one.attempt.cost == other.attempt.cost
        assert case_outcome(one, native=True).fallbacks >= len(other.attempts)


@pytest.mark.needs_compiler
def test_derivatives_of_native_solutions_are_those_of_ipopt(
    natively: Evaluator, evaluator: Evaluator, known: Precomputed
) -> None:
    """Where both end at the same optimum, as they mostly do from the same starts."""
    values = unscaled_values(natively.problem)
    ended = [each.solve(values) for each in (natively, evaluator)]
    ours, theirs = (
        Sensitivities(each.problem, known).at(values, end)
        for each, end in zip((natively, evaluator), ended, strict=True)
    )
    costs = np.array([[case.attempt.cost for case in end.cases if case.attempt] for end in ended])
    same = np.isclose(*costs, rtol=1e-6)
    assert same.sum() >= 2
    for one, other in itertools.compress(zip(ours.cases, theirs.cases, strict=True), same):
        assert isinstance(one, PostureDerivative)
        assert isinstance(other, PostureDerivative)
        assert one.cost_slope == pytest.approx(other.cost_slope, rel=1e-6, abs=1e-6)
    assert isinstance(ours.highest, ReachDerivative)
    assert isinstance(theirs.highest, ReachDerivative)
    assert ours.highest.slope == pytest.approx(theirs.highest.slope, rel=1e-6, abs=1e-6)


@pytest.mark.slow
@pytest.mark.needs_compiler
def test_whole_postures_are_the_refuge_and_native_as_well(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no symmetric posture can be, IPOPT is not asked for one; the whole one found is as good."""
    unscaled, scene = unscaled_values(problem), problem.scene
    setting = Setting(scene, problem.space, problem.weights, NATIVE)
    checker = Checker(scene, *(AgentModel.of(agent, agent.tree) for agent in scene.agents))
    known = PostureProblem(setting, Symmetry.ON).solve(unscaled, Hold(height_m=1.0), checker)
    assert known.attempt is not None
    rows, solve = whole_rows(setting), NativeMethod.solve

    def only_whole(self: NativeMethod, options: SolverOptions, start: Array, parameters: Array) -> Ending:
        end = solve(self, options, start, parameters)
        return end if len(start) == rows else replace(end, word="Infeasible_Problem_Detected")

    monkeypatch.setattr(NativeMethod, "solve", only_whole)
    found = PostureProblem(setting, Symmetry.ON).solve(unscaled, Hold(height_m=1.0), checker)
    assert found.attempt is not None
    assert found.attempt.formulation == WHOLE
    assert {attempt.method for attempt in found.attempts} == {MethodName.NATIVE}
    assert found.attempt.cost < 1.02 * known.attempt.cost


def whole_rows(setting: Setting) -> int:
    """Number of symbols of the whole program."""
    off = PostureProblem(replace(setting, options=SolverOptions()), Symmetry.OFF)
    return int(off.landscape(Hold(height_m=1.0)).seeker.program.symbols.numel())
