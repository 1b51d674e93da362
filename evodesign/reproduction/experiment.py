"""What the reproductions share: a problem, a bound on the work, logged runs, robots at their postures."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import tomli_w

from evodesign import evolve
from evodesign.errors import Interrupted
from evodesign.evaluation.evaluate import detail_of
from evodesign.evaluation.factory import evaluation_factory, evaluator_of
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.pool.registry import make_pool
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.person_quantities import compression
from evodesign.records import Evaluation, SearchSettings
from evodesign.report.scene_models import SceneModels
from evodesign.reproduction.claims2022 import TorqueNorms, TorqueNormsByHeight
from evodesign.reproduction.files2022 import ReproducedRobot
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.session import Display

GRIPS: Mapping[str, Mapping[str, Any]] = {"payload": {"grasp_direction": "side"}}
STRICTER = {"and grips": GRIPS, "and collisions": {**GRIPS, "collisions": {}}}
"""Tables of a problem that are changed, each setting stricter than the one before."""

MEASURED: Mapping[str, Mapping[str, Any]] = {"human": {"posture": "measured"}}
"""Likewise: the person stands as people who were measured do."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is computed.

    Args:
        evaluations: of the search.
        seed: of everything that is random.
        minutes: after which searches have ended, with what they have by then.
        jobs, pool: where they run.
    """

    evaluations: int
    seed: int
    minutes: float
    jobs: int
    pool: str


@dataclass(frozen=True, slots=True)
class Experiment:
    """A problem, and how much is computed of it.

    Args:
        problem: under physical limits.
        directory: for the logged runs.
        effort: how much is computed.
        began: when the time given began [s], as `time.monotonic` has it.
        display: shows what is being done.
    """

    problem: DesignProblem
    directory: Path
    effort: Effort
    began: float
    display: Display

    def logged(self, name: str, settings: SearchSettings, budget: int, share: float) -> RunLog:
        """A logged run that ends with its budget, or with a share of the time."""
        directory, header = self.directory / name, header_of(self.problem, settings, budget)
        end = self.began + 60.0 * self.effort.minutes * share

        def late() -> bool:
            return time.monotonic() > end

        with make_pool(self.effort.pool, self.effort.jobs, note=self.display.note, stop=late) as workers:
            with self.display.precompute() as progress:
                factory = evaluation_factory(header, workers, progress)
            try:
                with self.display.search() as observer:
                    return evolve.start(directory, header, factory, workers, observer, stop=late)
            except Interrupted:
                if not late():
                    raise
        run = read_run(directory)
        self.display.note(f"{name}: its time is over after {len(run.evaluations)} of {budget} evaluations")
        return run

    def solved(
        self, problem: DesignProblem, robots: Mapping[str, Sequence[float]], what: str
    ) -> dict[str, DesignResult]:
        """Robots, given as parameter values, at their best postures in a problem."""
        self.display.note(what)
        with self.display.precompute() as progress:
            evaluator = evaluator_of(problem, self.effort.jobs, progress)
        return {name: evaluator.solve(values) for name, values in robots.items()}


def torque_norms(result: DesignResult, person: str | None = None) -> TorqueNormsByHeight:
    """What a design asks of both agents where it holds the load, with all people or one of them."""
    return {
        each.case.task.heights[0]: TorqueNorms(
            robot=each.postures[ROBOT].torque_norm,
            human=each.postures[HUMAN].torque_norm,
            back=compression(result.scene_of(each.case).human, each.postures[HUMAN]),
        )
        for each in result.cases
        if each.solved and person in (None, each.case.person)
    }


def reproduced(problem: DesignProblem, name: str, title: str, result: DesignResult) -> ReproducedRobot:
    """A robot with the postures of the cases that were solved."""
    cases = tuple(detail_of(case) for case in result.cases if case.solved)
    return ReproducedRobot(name, title, SceneModels.of(problem.scene, result.tree), cases)


def value_of(name: str) -> Callable[[Evaluation], float]:
    """An objective of feasible evaluations."""
    return lambda each: each.assessment.objectives[name]


def chosen(
    run: RunLog,
    capped: Callable[[Evaluation], float],
    cap: float | None,
    least: Callable[[Evaluation], float],
) -> Evaluation | None:
    """The design of a search that is shown.

    Args:
        run: the search.
        capped: a value that may be at most `cap`; where none is, or without a cap, the least one is chosen.
        cap: the largest value that will do.
        least: what is least among those that will do.
    Returns:
        The design; None of a run without feasible ones.
    """
    feasible = [each for each in run.evaluations if each.feasible]
    within = [each for each in feasible if cap is not None and capped(each) <= cap]
    return min(within, key=least) if within else min(feasible, key=capped, default=None)


def changed_problem(problem: DesignProblem, tables: Mapping[str, Any]) -> DesignProblem:
    """A problem with keys of some tables added, of a list of tables to each; lists replace what there is."""
    changed = tomllib.loads(problem.source.text)
    for name, keys in tables.items():
        old = changed.get(name, {})
        if isinstance(keys, list):
            changed[name] = keys
        else:
            changed[name] = [{**each, **keys} for each in old] if isinstance(old, list) else {**old, **keys}
    return build_problem(msgspec.structs.replace(problem.source, text=tomli_w.dumps(changed)))
