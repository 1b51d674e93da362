"""What the reproductions of both papers share: a problem, a bound on the work, and logged runs."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import tomli_w

from evodesign import evolve
from evodesign.errors import Interrupted
from evodesign.evaluation.factory import evaluation_factory
from evodesign.pool.registry import make_pool
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import SearchSettings
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


def stricter_problem(problem: DesignProblem, tables: Mapping[str, Mapping[str, Any]]) -> DesignProblem:
    """A problem with keys of some tables added; of a list of tables, to each."""
    changed = tomllib.loads(problem.source.text)
    for name, keys in tables.items():
        old = changed.get(name, {})
        changed[name] = [{**each, **keys} for each in old] if isinstance(old, list) else {**old, **keys}
    return build_problem(msgspec.structs.replace(problem.source, text=tomli_w.dumps(changed)))
