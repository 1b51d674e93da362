"""A problem in a notebook: its parameters and objectives, and designs evaluated one at a time."""

from __future__ import annotations

import logging
import math
import os
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evodesign.api.design import Design
from evodesign.design.parameter import ALLOCATIONS, ParameterKind
from evodesign.errors import InputError, on_one_line
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import cached_precomputed
from evodesign.evaluation.lifts import Lifts
from evodesign.motion.solution import LiftSolution
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import build_problem
from evodesign.problem.design_space import refuse_no_choice
from evodesign.problem.designs import beyond_bounds
from evodesign.problem.notes import notes
from evodesign.problem.shipped import shipped_problems
from evodesign.problem.source import read_source, source_of
from evodesign.problem.unknown_names import refuse_unlisted
from evodesign.records import (
    Assessed,
    Constraint,
    Detail,
    Evaluation,
    Lift,
    Objective,
    Parameter,
    ProblemSource,
    Task,
)
from evodesign.runlog.directory import name_in_path
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog

if TYPE_CHECKING:
    from evodesign.api.optuna_study import OptunaObjective

LOGGER = logging.getLogger("evodesign")
"""Hears of designs beyond their bounds, as warnings."""


def open_problem(problem: str | os.PathLike[str], jobs: int = 1) -> Problem:
    """Open a problem file, or a problem that comes with evodesign.

    Args:
        problem: path of the file, or a name such as `icub-lifting`; `problems()` lists the names.
        jobs: how many processes work out what no cache holds yet, when a design is first evaluated.
    Raises:
        InputError: naming file, key, what was wanted and what was found.
    Example:
        >>> evodesign.open_problem("problem.toml")
        <problem golden-lifting: 3 parameters, 3 objectives>
    """
    return Problem(read_source(problem), jobs)


def problems() -> dict[str, str]:
    """The problems that come with evodesign: a sentence about each, by name.

    Example:
        >>> "icub-lifting" in evodesign.problems()
        True
    """
    return {problem.name: problem.description for problem in shipped_problems()}


class Problem:
    """Designs of a problem, evaluated in this process. It can be sent to other processes (pickled).

    The first evaluation gets the inner problems ready, which takes minutes the first time on a machine and
    seconds from then on.

    Args:
        source: the problem and its files, as text.
        jobs: how many processes work out what no cache holds yet.
    Attributes:
        source: the problem and its files, as text.
        name: of the problem.
        parameters: each with bounds in its own unit.
        objectives: each with sense and unit.
        constraints: each with bounds in its quantity's unit.
        unscaled: parameter values by name of the robot as its file has it.
        built: everything that the file says, with all names resolved.
    Example:
        >>> [f"{objective.sense} {objective.name} [{objective.unit}]" for objective in problem.objectives]
        ['minimise robot_torque [N m]', 'minimise worst_human_torque [N m]', 'maximise reach_height [m]']
    """

    def __init__(self, source: ProblemSource, jobs: int = 1) -> None:
        self.source = source
        self._jobs = jobs
        self.built = problem = build_problem(source)
        self.name = problem.name
        self.parameters: tuple[Parameter, ...] = problem.space.records
        self.objectives: tuple[Objective, ...] = problem.objectives
        self.constraints: tuple[Constraint, ...] = problem.constraints
        self.unscaled: Mapping[str, float] = problem.space.named(
            problem.space.unscaled(problem.scene.designed_tree)
        )

    @classmethod
    def from_dict(
        cls, tables: Mapping[str, Any], folder: str | os.PathLike[str] = ".", jobs: int = 1
    ) -> Problem:
        """A problem from the tables of a problem file, as dictionaries and lists.

        Args:
            tables: `{"name": .., "robot": {"urdf": ..}, ..}`, the keys with their units as in a file.
            folder: from which files are named; those that come with evodesign are found from anywhere.
            jobs: as in `open_problem`.
        Raises:
            InputError: naming key, what was wanted and what was found.
        Example:
            >>> import tomllib
            >>> tables = tomllib.loads(evodesign.open_problem("icub-lifting").source.text)
            >>> tables["task"]["heights_m"] = [0.9]
            >>> evodesign.Problem.from_dict(tables).tasks
            (Hold(height_m=0.9),)
        """
        return cls(source_of(tables, folder), jobs)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a careful reader would ask about, such as a robot that was averaged with its mirror image."""
        return notes(self.built)

    @property
    def tasks(self) -> tuple[Task, ...]:
        """What robot and people do with every load, such as `Hold(height_m=1.2)`."""
        return self.built.tasks

    @cached_property
    def _evaluator(self) -> Evaluator:
        return Evaluator(self.built, self._known())

    def _known(self, *lifts: Lift) -> Precomputed:
        with make_pool("joblib" if self._jobs > 1 else "serial", self._jobs) as pool:
            return cached_precomputed(self.built, pool, lifts=lifts)

    def _lifted(self, values: Sequence[float], lift: Lift) -> dict[tuple[str, str], LiftSolution]:
        """The lift of a design with every person and load, for `evodesign.lift`."""
        return Lifts(self._evaluator, self._known(lift)).solve(values, lift)

    def __reduce__(self) -> tuple[type[Problem], tuple[ProblemSource]]:
        return Problem, (self.source,)

    def __repr__(self) -> str:
        about = f"{len(self.parameters)} parameters, {len(self.objectives)} objectives"
        return f"<problem {on_one_line(self.name)}: {about}>"

    def evaluate(self, design: Mapping[str, float] | Sequence[float], *, strict: bool = False) -> Design:
        """The results of a design, with its postures. They depend on nothing but problem and design.

        A design beyond the bounds of its parameters is evaluated, though no search would find it: a sentence
        for each such value stands in `notes`, and goes to the logger `evodesign` as a warning.

        Args:
            design: values by name, each in its parameter's unit, those left out as in the unscaled robot; or
                one value per parameter.
            strict: refuse a design beyond the bounds instead.
        Raises:
            InputError: an unknown name, a wrong number of values, a value that is no positive number, an
                allocation parameter beyond its range, or a density that is neither a material's nor the
                unscaled robot's where there are materials; or with `strict` a value beyond its bounds.
        Example:
            >>> longer = problem.evaluate({"length.shank": 1.1})
            >>> longer.feasible, longer.objectives["robot_torque"]
            (True, 15.07...)
            >>> problem.evaluate({"length.shank": 1.9}).notes
            ('length.shank = 1.9 is beyond its bounds, 0.6 to 1.8',)
        """
        values = self.values(design)
        beyond = beyond_bounds([each.record for each in self.built.space.parameters], values)
        if strict and beyond:
            name, sentence = next(iter(beyond.items()))
            raise InputError("design", name, "a value within its bounds (strict=True)", sentence)
        for sentence in beyond.values():
            LOGGER.warning("%s", sentence)
        found = self._evaluator.assess_values(values)
        log = partial(self._log, values, found)
        notes = tuple(beyond.values())
        return Design(None, found.assessment, found.cases, self.constraints, notes, log)

    def optuna_objective(self) -> OptunaObjective:
        """The problem as an objective for `study.optimize` of Optuna.

        Raises:
            InputError: Optuna is not installed.
        Example:
            >>> problem.optuna_objective().directions
            ['minimize', 'minimize', 'maximize']
        """
        from evodesign.api.optuna_study import OptunaObjective  # takes its time to load

        return OptunaObjective(self)

    def _log(self, values: tuple[float, ...], found: Assessed) -> RunLog:
        """A run of one design, in memory."""
        built = self.built
        genome = built.space.genome(values)
        evaluation = Evaluation(
            number=0, generation=0, genome=genome, assessment=found.assessment, seconds=0.0, worker=""
        )
        detail = Detail(evaluation=0, cases=found.cases)
        header = header_of(built, built.settings(), 1)
        directory = Path(name_in_path(self.name))
        return RunLog(directory, header, (evaluation,), (), (), (detail,), complete=True, notes=())

    def values(self, design: Mapping[str, float] | Sequence[float]) -> tuple[float, ...]:
        """One value per parameter of a design; arguments and errors are those of `evaluate`."""
        names = [parameter.name for parameter in self.parameters]
        if isinstance(design, Mapping):
            for name in design:
                refuse_unlisted("design", "", name, names, f"parameters among {', '.join(names)}")
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
        for parameter, name in zip(self.built.space.free, names, strict=True):
            if values[name] != self.unscaled[name]:
                refuse_no_choice(parameter, values[name], "design", name)
        return self.built.space.values_of({name: float(values[name]) for name in names})
