"""A problem as pymoo knows them, so that its algorithms can search it.

Variables are the parameters in their own units, within their bounds. Objectives are minimised: a maximised
one is negated. The constraints are those of `constraint_columns`; the objectives of an infeasible design are
not a number, for they do not exist. A density with materials counts as that of the nearest one.

Most algorithms of pymoo order infeasible designs by their constraints alone. Those that read their objectives
too would go on with numbers that mean nothing, without a word; `ALGORITHMS` says which, and they are refused.
"""

from __future__ import annotations

import math
import os
import weakref
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import pymoo.optimize
from numpy.typing import NDArray
from pymoo.config import Config
from pymoo.core.problem import Problem as BaseProblem

from evodesign.analysis.front import minimised, to_minimise
from evodesign.api.constraint_columns import constraint_names, constraint_values
from evodesign.api.problem import Problem, open_problem
from evodesign.errors import EvodesignError, InputError
from evodesign.evaluation.factory import ValuesFactory, values_factory
from evodesign.pool.base import Finished, Pool
from evodesign.pool.registry import make_pool
from evodesign.records import Assessed, Assessment


def always(algorithm: Any) -> bool:
    """However it was set."""
    return True


@dataclass(frozen=True, slots=True)
class AlgorithmNote:
    """What is known of an algorithm of pymoo.

    Args:
        flaw: what it does with infeasible designs that makes its results meaningless; empty for nothing.
        flawed: whether an algorithm, as it was set, does so.
    """

    flaw: str = ""
    flawed: Callable[[Any], bool] = always


ALGORITHMS: Mapping[str, AlgorithmNote] = {
    "GA": AlgorithmNote(),
    "DE": AlgorithmNote(),
    "PSO": AlgorithmNote(),
    "CMAES": AlgorithmNote(),
    "NSGA2": AlgorithmNote(),
    "NSGA3": AlgorithmNote(),
    "UNSGA3": AlgorithmNote(),
    "SPEA2": AlgorithmNote(),
    "AGEMOEA": AlgorithmNote(),
    "MOEAD": AlgorithmNote("which takes no constraints"),
    "CTAEA": AlgorithmNote("which orders infeasible designs by their objectives, and they have none"),
    "SRES": AlgorithmNote("which orders infeasible designs by their objectives, and they have none"),
    "RVEA": AlgorithmNote("which gives infeasible designs as its result"),
    "SMSEMOA": AlgorithmNote(
        "which scales objectives by those of infeasible designs, and they have none, "
        "unless it is made with normalize=False",
        lambda algorithm: bool(algorithm.normalize),
    ),
}
"""By the name of the class, which holds for classes derived from it; others are let through.

Read in the sources of pymoo 0.6.1.5 and 0.6.2, and tried with designs of all kinds (tests/api/test_pymoo.py).
"""


def as_pymoo_problem(problem: Problem | str | os.PathLike[str], jobs: int = 1) -> PymooProblem:
    """A pymoo problem of an opened problem or of a problem file.

    Args:
        problem: whose designs are evaluated.
        jobs: processes that evaluate a population side by side; 1 evaluates in this process.
    Raises:
        InputError: the file cannot be used, or fewer than one job.
    Example:
        >>> for_pymoo = evodesign.as_pymoo_problem(problem)
        >>> for_pymoo.n_var, for_pymoo.n_obj, for_pymoo.n_ieq_constr
        (3, 3, 1)
    """
    return PymooProblem(problem if isinstance(problem, Problem) else open_problem(problem, jobs), jobs)


class PymooProblem(BaseProblem):  # type: ignore[misc]
    """Evaluates the designs of a population; a context manager that ends its processes.

    Results are the same with any number of jobs. An evaluation that loses its process, or takes more time or
    memory than the problem allows, leaves a design of unknown violation; that needs processes.

    Args:
        problem: whose designs are evaluated.
        jobs: processes; with 1 there are none, and designs are evaluated in this one.
    Attributes:
        problem: the same.
        jobs: the same.
    Raises:
        InputError: fewer than one job.
    Example:
        >>> evaluated = evodesign.as_pymoo_problem(problem).evaluate(np.array([[1.0, 1.1, 0.0]]))
        >>> [values.shape for values in evaluated]
        [(1, 3), (1, 1)]
    """

    def __init__(self, problem: Problem, jobs: int = 1) -> None:
        Config.warnings["not_compiled"] = False  # pymoo would print a hint on standard output
        self.problem = problem
        self.jobs = jobs
        self._pool = make_pool("joblib" if jobs > 1 else "serial", jobs)
        self._factory: ValuesFactory | None = None
        self._ended = weakref.finalize(self, self._pool.close)
        super().__init__(
            n_var=len(problem.parameters),
            n_obj=len(problem.objectives),
            n_ieq_constr=len(constraint_names(problem.constraints)),
            xl=np.array([parameter.lower for parameter in problem.parameters]),
            xu=np.array([parameter.upper for parameter in problem.parameters]),
            requires_kwargs=True,  # the algorithm that asks
        )

    def __repr__(self) -> str:
        about = f"{self.n_var} variables, {self.n_obj} objectives, {self.n_ieq_constr} constraints"
        return f"<pymoo problem {self.problem.name}: {about}>"

    __str__ = __repr__

    def __deepcopy__(self, memo: object) -> Self:
        """Itself: what pymoo keeps as history need not build the problem again."""
        return self

    def __reduce__(self) -> tuple[type[PymooProblem], tuple[Problem, int]]:
        return PymooProblem, (self.problem, self.jobs)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *what: object) -> None:
        self.close()

    def close(self) -> None:
        """End the processes; a later evaluation starts new ones."""
        self._pool.close()

    def minimize(self, algorithm: Any, termination: Any = None, **options: Any) -> Any:
        """What `pymoo.optimize.minimize` gives for this problem, unless the algorithm cannot search it.

        While a single design is feasible, some algorithms divide by the range of its objectives, which is
        zero; numpy does not warn of that here.

        Raises:
            InputError: it cannot; the sentence says why, and which algorithms can.
        """
        refuse_unsound(algorithm)
        with np.errstate(divide="ignore", invalid="ignore"):
            return pymoo.optimize.minimize(self, algorithm, termination, **options)

    def natural(self, minimised_values: NDArray[np.float64]) -> list[dict[str, float]]:
        """Natural objective values by name of rows of minimised ones, such as a result's `F`.

        Args:
            minimised_values: (designs, objectives), or one design's, each in its objective's unit.
        Example:
            >>> evodesign.as_pymoo_problem(problem).natural(np.array([[2.0, 0.5, -1.3]]))
            [{'robot_torque': 2.0, 'worst_human_torque': 0.5, 'reach_height': 1.3}]
        """
        return [
            {
                objective.name: to_minimise(objective, value)
                for objective, value in zip(self.problem.objectives, row, strict=True)
            }
            for row in np.atleast_2d(minimised_values).tolist()
        ]

    def _evaluate(
        self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, algorithm: Any = None, **kwargs: Any
    ) -> None:
        """Fill in F (designs, objectives) and G (designs, constraints) of rows x (designs, parameters)."""
        refuse_unsound(algorithm)
        objectives = self.problem.objectives
        assessments = self._assessments([self._nearest(row) for row in x.tolist()])
        constraints = [
            (math.inf,) * self.n_ieq_constr
            if each is None
            else constraint_values(objectives, self.problem.constraints, each)
            for each in assessments
        ]
        nothing = (math.nan,) * self.n_obj
        out["G"] = np.array(constraints)
        out["F"] = np.array(
            [
                nothing if each is None or max(violated) > 0.0 else minimised(objectives, each)
                for each, violated in zip(assessments, constraints, strict=True)
            ]
        )

    def _nearest(self, row: Iterable[float]) -> list[float]:
        return [
            min(each.choices, key=lambda choice: abs(choice - value)) if each.choices else value
            for each, value in zip(self.problem.parameters, row, strict=True)
        ]

    def _assessments(self, rows: list[list[float]]) -> list[Assessment | None]:
        """The assessment of each row of values; None where a worker was lost or ended."""
        if self.jobs == 1:
            return [self.problem.evaluate(row).assessment for row in rows]
        if self._factory is None:
            self._factory = values_factory(self.problem.built, self._pool)
        return _in_order(self._pool, self._factory, [self.problem.values(row) for row in rows])


def refuse_unsound(algorithm: Any) -> None:
    """Refuse an algorithm that `ALGORITHMS` knows to give meaningless results.

    Raises:
        InputError: it does.
    """
    for kind in type(algorithm).__mro__:
        note = ALGORITHMS.get(kind.__name__)
        if note is None:
            continue
        if note.flaw and note.flawed(algorithm):
            sound = ", ".join(name for name, each in ALGORITHMS.items() if not each.flaw)
            raise InputError("algorithm", "", f"one of {sound}", f"{kind.__name__}, {note.flaw}")
        return


def _in_order(pool: Pool, factory: ValuesFactory, rows: list[tuple[float, ...]]) -> list[Assessment | None]:
    found: list[Assessment | None] = [None] * len(rows)
    for finished in pool.run(factory, rows):
        found[finished.index] = _assessment(finished)
    return found


def _assessment(finished: Finished[Assessed]) -> Assessment | None:
    """The assessment that a worker gave back."""
    if finished.value is not None:
        return finished.value.assessment
    if finished.worker_lost or finished.out_of_time or finished.out_of_memory:
        return None
    raise EvodesignError(f"a design could not be evaluated: {finished.failure}")
