"""A problem in a notebook: its parameters and objectives, and designs evaluated one at a time."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from evodesign.api.design import Design
from evodesign.design.space import ALLOCATIONS, ParameterKind
from evodesign.errors import InputError, nearest_name
from evodesign.pool.registry import make_pool
from evodesign.problem.build import build_problem
from evodesign.problem.design_space import refuse_no_choice
from evodesign.problem.evaluate import Evaluator
from evodesign.problem.factory import cached_precomputed
from evodesign.problem.source import read_source
from evodesign.records import Constraint, Objective, Parameter, ProblemSource

__all__ = ["Problem", "open_problem"]


def open_problem(path: str | os.PathLike[str], jobs: int = 1) -> Problem:
    """Open a problem file and get its inner problems ready, which takes minutes the first time.

    Args:
        path: of the problem file.
        jobs: how many processes work out what no cache holds yet.
    Raises:
        InputError: naming file, key, what was wanted and what was found.
    """
    return Problem(read_source(Path(path)), jobs)


class Problem:
    """Designs of a problem, evaluated in this process. It can be sent to other processes (pickled).

    Args:
        source: the problem and its files, as text.
        jobs: how many processes work out what no cache holds yet.
    """

    def __init__(self, source: ProblemSource, jobs: int = 1) -> None:
        self.source = source
        problem = build_problem(source)
        with make_pool("joblib" if jobs > 1 else "serial", jobs) as pool:
            self._evaluator = Evaluator(problem, cached_precomputed(problem, pool))
        self.name = problem.name
        self.parameters: tuple[Parameter, ...] = problem.space.records
        self.objectives: tuple[Objective, ...] = problem.objectives
        self.constraints: tuple[Constraint, ...] = problem.constraints
        self.unscaled: Mapping[str, float] = problem.space.named(
            problem.space.unscaled(problem.scene.robot.tree)
        )

    def __reduce__(self) -> tuple[type[Problem], tuple[ProblemSource]]:
        return Problem, (self.source,)

    def __repr__(self) -> str:
        return f"<problem {self.name}: {len(self.parameters)} parameters, {len(self.objectives)} objectives>"

    def evaluate(self, design: Mapping[str, float] | Sequence[float]) -> Design:
        """The results of a design, with its postures. They depend on nothing but problem and design.

        Args:
            design: values by name, those left out as in the unscaled robot; or one value per parameter.
        Raises:
            InputError: an unknown name, a wrong number of values, a value that is no positive number, an
                allocation parameter beyond its range, or a density that is neither a material's nor the
                unscaled robot's where there are materials.
        """
        found = self._evaluator.assess_values(self._values(design))
        return Design(None, found.assessment, found.cases, self.constraints)

    def _values(self, design: Mapping[str, float] | Sequence[float]) -> tuple[float, ...]:
        names = [parameter.name for parameter in self.parameters]
        if isinstance(design, Mapping):
            for name in design:
                if name not in names:
                    found = f"'{name}'{nearest_name(name, names)}"
                    raise InputError("design", "", f"parameters among {', '.join(names)}", found)
            values = {**self.unscaled, **design}
        elif len(design) == len(names):
            values = dict(zip(names, design, strict=True))
        else:
            raise InputError("design", "", f"{len(names)} values", f"{len(design)}")
        for name in names:
            kind, _, group = name.partition(".")
            if kind == ParameterKind.ALLOCATION:
                wanted, sound = ALLOCATIONS[group].wanted, ALLOCATIONS[group].means(values[name])
            else:
                wanted, sound = "a positive number", math.isfinite(values[name]) and values[name] > 0.0
            if not sound:
                raise InputError("design", name, wanted, f"{values[name]}")
        for parameter, name in zip(self._evaluator.problem.space.parameters, names, strict=True):
            if values[name] != self.unscaled[name]:
                refuse_no_choice(parameter, values[name], "design", name)
        return tuple(float(values[name]) for name in names)
