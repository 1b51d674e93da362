"""A problem as pymoo knows them, so that any of its algorithms can search it.

Variables are the parameters in their own units, within their bounds. Objectives are minimised: a maximised
one is negated. The one constraint is the violation [m], infinite when a failure left it unknown; the
objectives of an infeasible design are not a number, for they do not exist. pymoo orders such designs by the
constraint. A density with materials counts as that of the nearest one.
"""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.config import Config
from pymoo.core.problem import ElementwiseProblem

from evodesign.analysis.front import minimised, to_minimise
from evodesign.api.problem import Problem, open_problem

__all__ = ["PymooProblem", "as_pymoo_problem"]


def as_pymoo_problem(problem: Problem | str | os.PathLike[str]) -> PymooProblem:
    """A pymoo problem of an opened problem or of a problem file.

    Raises:
        InputError: the file cannot be used.
    Example:
        >>> for_pymoo = evodesign.as_pymoo_problem(problem)
        >>> for_pymoo.n_var, for_pymoo.n_obj, for_pymoo.n_ieq_constr
        (3, 3, 1)
    """
    return PymooProblem(problem if isinstance(problem, Problem) else open_problem(problem))


class PymooProblem(ElementwiseProblem):  # type: ignore[misc]
    """Evaluates one design at a time.

    Args:
        problem: whose designs are evaluated.
    Attributes:
        problem: the same.
    Example:
        >>> evaluated = evodesign.as_pymoo_problem(problem).evaluate(np.array([[1.0, 1.1, 0.0]]))
        >>> [values.shape for values in evaluated]
        [(1, 3), (1, 1)]
    """

    def __init__(self, problem: Problem) -> None:
        Config.warnings["not_compiled"] = False  # pymoo would print a hint on standard output
        self.problem = problem
        super().__init__(
            n_var=len(problem.parameters),
            n_obj=len(problem.objectives),
            n_ieq_constr=1,
            xl=np.array([parameter.lower for parameter in problem.parameters]),
            xu=np.array([parameter.upper for parameter in problem.parameters]),
        )

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        nearest = [
            min(each.choices, key=lambda choice: abs(choice - value)) if each.choices else value
            for each, value in zip(self.problem.parameters, x.tolist(), strict=True)
        ]
        assessment = self.problem.evaluate(nearest).assessment
        objectives = minimised(self.problem.objectives, assessment)
        violation = math.inf if assessment.violation is None else assessment.violation
        if violation == 0.0 and objectives is None:
            violation = math.inf
        out["F"] = objectives if violation == 0.0 else [math.nan] * self.n_obj
        out["G"] = [violation]

    def natural(self, minimised_values: NDArray[np.float64]) -> list[dict[str, float]]:
        """Natural objective values by name of rows of minimised ones, such as a result's `F`.

        Args:
            minimised_values: (designs, objectives), each in its objective's unit.
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
