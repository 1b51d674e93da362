"""The native method against IPOPT, its judge: the same designs in turn, in one process.

Both begin at the same starts, those of the native method's portfolio. For every program the median of
processor time per solve, and for whole evaluations designs per second, the share of cases that are solved,
and the share of designs of which every objective agrees within 1e-5; of the others, every case and reach in
which the methods differ, with what both found and the start that made the difference. Results go to
benchmarks/results/native_solver.json and are printed as Markdown tables.

    python -m benchmarks.native_solver [--designs 100] [--jobs 2] [PROBLEM ..]

A problem is a file or, of the default one, a variant such as `longer_arm`.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from benchmarks.inner_problem import (
    HEIGHTS,
    HERE,
    Design,
    known_at,
    problem_at,
    problem_named,
    random_designs,
)
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.judge import AGREEMENT
from evodesign.nlp.method import MethodName
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.posture.results import Attempt, CaseSolution, Instant
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import DesignResult
from evodesign.records import Assessment, Status

BLOCK = 10
"""Designs after which the other method has its turn: as in a search, its code is then in the caches."""

Times = dict[tuple[str, MethodName], list[float]]


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problems", nargs="*", metavar="PROBLEM")
    parser.add_argument("--designs", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    problems = {Path(name).stem: problem_named(name) for name in options.problems}
    problems = problems or {"point_grasp": problem_at(HEIGHTS)}
    target = HERE / "results" / "native_solver.json"
    before = json.loads(target.read_text()) if target.exists() else {}
    found = {name: measured(each, options.designs, options.jobs) for name, each in problems.items()}
    target.write_text(json.dumps({**before, **found}, indent=2) + "\n")
    for name, result in found.items():
        print(f"\n{name}, {options.designs} designs\n")
        print("| program | native ms | IPOPT ms | ratio |\n|---|---|---|---|")
        for program, row in result["programs"].items():
            print(f"| {program} | {row['native']:.3f} | {row['ipopt']:.3f} | {row['ratio']:.1f} |")
        rest = {key: value for key, value in result.items() if key not in {"programs", "reasons"}}
        print(json.dumps(rest, indent=2))
        print(
            "\n| design | what | native | IPOPT | native is | start that decided |\n|---|---|---|---|---|---|"
        )
        for reason in result["reasons"]:
            print("| " + " | ".join(_told(value) for value in reason.values()) + " |")


def measured(problem: DesignProblem, designs: int, jobs: int) -> dict[str, Any]:
    """What both methods make of the same designs."""
    known, times = known_at(problem, jobs), defaultdict(list)
    evaluators = {
        method: Evaluator(replace(problem, options=replace(problem.options, method=method)), known)
        for method in MethodName
    }
    first, *others = random_designs(problem, designs + 1)
    for evaluator in evaluators.values():  # builds and compiles
        evaluator.assess_values(first)
    spent = dict.fromkeys(MethodName, 0.0)
    results: dict[MethodName, list[DesignResult]] = {method: [] for method in MethodName}
    ends: dict[MethodName, list[Assessment]] = {method: [] for method in MethodName}
    with _timed(times):
        for place in range(0, designs, BLOCK):
            for method, evaluator in evaluators.items():
                for design in others[place : place + BLOCK]:
                    result, assessment, seconds = _solved(evaluator, design)
                    if any(
                        not case.solved for case in result.cases
                    ):  # its refuge may have been built just now
                        result, assessment, seconds = _solved(evaluator, design)
                    results[method].append(result)
                    ends[method].append(assessment)
                    spent[method] += seconds
    pairs = list(zip(ends[MethodName.NATIVE], ends[MethodName.IPOPT], strict=True))
    gaps = [_gap(native, ipopt) for native, ipopt in pairs]
    reasons = [
        reason
        for number, gap in enumerate(gaps)
        if gap > AGREEMENT
        for reason in _reasons(number, *(results[method][number] for method in MethodName))
    ]
    return {
        "programs": _programs(times),
        "designs_per_second": {method.value: designs / spent[method] for method in MethodName},
        "ratio": spent[MethodName.IPOPT] / spent[MethodName.NATIVE],
        "cases_solved": {method.value: _share_solved(ends[method]) for method in MethodName},
        "designs_that_agree": float(np.mean([gap <= AGREEMENT for gap in gaps])),
        "others": sorted(gap for gap in gaps if gap > AGREEMENT),
        "reasons": reasons,
        "native_is": dict(Counter(reason["native_is"] for reason in reasons)),
        "fallbacks": sum(case.fallbacks for native, _ in pairs for case in native.cases),
    }


def _solved(evaluator: Evaluator, design: Design) -> tuple[DesignResult, Assessment, float]:
    """A design's results, and the processor time that they took [s]."""
    began = time.thread_time()
    result = evaluator.solve(design)
    assessment = evaluator.assessment(design, result)
    return result, assessment, time.thread_time() - began


@contextmanager
def _timed(times: Times) -> Iterator[None]:
    """Note the processor time [ms] of every solve that succeeds, by program and method."""
    solve = Solver.solve

    def timed(self: Solver, parameters: Mapping[str, Any], start: Mapping[str, Any]) -> RawSolution:
        began = time.thread_time()
        end = solve(self, parameters, start)
        if end.status is Status.SOLVED:
            name = self.program.name + (", near" if self.options.near else "")
            times[name, end.method].append(1e3 * (time.thread_time() - began))
        return end

    with mock.patch.object(Solver, "solve", timed):
        yield


def _programs(times: Times) -> dict[str, dict[str, float]]:
    """Medians by program, and their ratio, where both methods solved it."""
    rows = {}
    for name in sorted({program for program, _ in times}):
        if not all((name, method) in times for method in MethodName):
            continue
        native, ipopt = (
            float(np.median(times[name, method])) for method in (MethodName.NATIVE, MethodName.IPOPT)
        )
        rows[name] = {"native": native, "ipopt": ipopt, "ratio": ipopt / native}
    return rows


def _share_solved(ends: Sequence[Assessment]) -> float:
    return float(np.mean([case.status is Status.SOLVED for end in ends for case in end.cases]))


def _gap(native: Assessment, ipopt: Assessment) -> float:
    """Largest difference of an objective, relative to its size or 1; infinite where one lacks it."""
    if native.objectives.keys() != ipopt.objectives.keys():
        return float("inf")
    return max(
        (abs(native.objectives[k] - v) / max(1.0, abs(v)) for k, v in ipopt.objectives.items()), default=0.0
    )


def _reasons(number: int, native: DesignResult, ipopt: DesignResult) -> list[dict[str, Any]]:
    """What differs between both results of a design: reach and cases, with what either method found."""
    found = []
    for sense, wanted in (("highest", -1.0), ("lowest", 1.0)):
        ours, theirs = getattr(native.reach, sense), getattr(ipopt.reach, sense)
        if (ours is None) != (theirs is None) or (ours is not None and abs(ours - theirs) > AGREEMENT):
            lack = None if ours is None or theirs is None else wanted * (ours - theirs)
            found.append(_reason(number, f"{sense} load", ours, theirs, lack, "another posture"))
    for mine, its in zip(native.cases, ipopt.cases, strict=True):
        pairs = [(end.attempt.cost if end.attempt else None, end) for end in (mine, its)]
        (ours, _), (theirs, _) = pairs
        torques = [[_torques(instant) for instant in end.instants] for end in (mine, its)]
        if torques[0] and torques[1] and np.allclose(*torques, rtol=AGREEMENT, atol=AGREEMENT):
            continue
        if ours is None and theirs is None:
            continue
        lack = None if ours is None or theirs is None else (ours - theirs) / max(1.0, abs(theirs))
        found.append(_reason(number, mine.case.name, ours, theirs, lack, _start_that_decided(mine, its)))
    return found


def _told(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _reason(
    design: int, what: str, native: float | None, ipopt: float | None, lack: float | None, reason: str
) -> dict[str, Any]:
    """A difference, and which of both is better by it; `lack` is positive where IPOPT's is."""
    if lack is None:
        better = "worse" if native is None else "better"
    else:
        better = "equal" if abs(lack) <= AGREEMENT else "worse" if lack > 0 else "better"
    return {
        "design": design,
        "what": what,
        "native": native,
        "ipopt": ipopt,
        "native_is": better,
        "reason": "the cost is flat" if better == "equal" else reason,
    }


def _torques(instant: Instant) -> list[float]:
    return [posture.torque_norm for posture in instant.postures.values()]


def _start_that_decided(native: CaseSolution, ipopt: CaseSolution) -> str:
    """Where the start that led to the cheaper of both postures led either method."""
    cheaper = min(
        (end.attempt for end in (native, ipopt) if end.attempt is not None), key=lambda each: each.cost
    )
    told = [
        f"{name} {_ended([each for each in end.attempts if each.start == cheaper.start])}"
        for name, end in (("native", native), ("IPOPT", ipopt))
    ]
    return f"{cheaper.formulation}, {cheaper.start}: {', '.join(told)}"


def _ended(attempts: Sequence[Attempt]) -> str:
    """The least cost of attempts, or why there is none."""
    solved = [each.cost for each in attempts if each.status is Status.SOLVED]
    if solved:
        return f"{min(solved):.6g}"
    return attempts[-1].reason if attempts else "did not begin there"


if __name__ == "__main__":
    main()
