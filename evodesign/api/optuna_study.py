"""Runs as studies of Optuna, and problems as objectives for its samplers.

A trial has the parameters of a design (a density with materials as the material's name), its objectives in
their natural senses, and the constraints of `constraint_columns`, which Optuna's samplers read. A design that
lacks an objective has no values: its trial has failed in the study of a run, and is pruned by an objective,
which is how Optuna keeps the constraints of a trial without values.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from evodesign.analysis.front import minimised
from evodesign.api.constraint_columns import constraint_names, constraint_values
from evodesign.errors import InputError
from evodesign.records import Assessment, Evaluation, Objective, Parameter, RunHeader, Sense
from evodesign.runlog.run import RunLog

try:
    import optuna
    from sqlalchemy.exc import SQLAlchemyError
except ModuleNotFoundError as error:
    wanted = "Optuna installed (pip install 'evodesign[notebook]')"
    raise InputError("optuna", "", wanted, f"none ({error})") from error

if TYPE_CHECKING:
    from evodesign.api.problem import Problem

DIRECTIONS: Mapping[Sense, Literal["minimize", "maximize"]] = {
    Sense.MINIMISE: "minimize",
    Sense.MAXIMISE: "maximize",
}


def study_of(
    log: RunLog, storage: str | os.PathLike[str] | optuna.storages.BaseStorage | None, name: str | None
) -> optuna.Study:
    """A new study with a trial for each evaluation of a run, in order of number.

    Args:
        log: of the run.
        storage: of Optuna, its URL, or the path of an SQLite file; None keeps the study in memory.
        name: of the study; None for the problem's and the run directory's.
    Raises:
        InputError: a storage that cannot be used, or one that has a study of this name.
    """
    header = log.header
    place = f"sqlite:///{os.fspath(storage)}" if isinstance(storage, os.PathLike) else storage
    called = f"{header.problem_name}, {log.directory.name}" if name is None else name
    try:
        study = optuna.create_study(
            storage=place,
            study_name=called,
            directions=[DIRECTIONS[objective.sense] for objective in header.objectives],
        )
    except optuna.exceptions.DuplicatedStudyError as error:
        wanted = "a name that the storage does not have yet"
        raise InputError("study_name", "", wanted, f"'{called}'") from error
    except (optuna.exceptions.OptunaError, SQLAlchemyError, ImportError) as error:
        wanted = "a storage of Optuna, its URL, or the path of an SQLite file"
        reason = str(error).partition("\n")[0]
        raise InputError("storage", "", wanted, f"'{storage}' ({reason})") from error
    study.add_trials([_trial(header, each) for each in log.evaluations])
    return study


def _trial(header: RunHeader, evaluation: Evaluation) -> optuna.trial.FrozenTrial:
    parameters, objectives, assessment = header.parameters, header.objectives, evaluation.assessment
    values = _values(objectives, assessment)
    constraints = constraint_values(objectives, header.constrained, assessment)
    return optuna.trial.create_trial(
        state=optuna.trial.TrialState.FAIL if values is None else optuna.trial.TrialState.COMPLETE,
        values=values,
        params={
            each.name: each.material_of(assessment.design[each.name]) or assessment.design[each.name]
            for each in parameters
        },
        distributions={each.name: _distribution(each) for each in parameters},
        user_attrs={
            "number": evaluation.number,
            "generation": evaluation.generation,
            **_attributes(assessment),
        },
        system_attrs={"constraints": list(constraints)},
    )


def _values(objectives: Sequence[Objective], assessment: Assessment) -> list[float] | None:
    """Natural values in the objectives' order; None unless all exist."""
    if assessment.violation is None or minimised(objectives, assessment) is None:
        return None
    return [assessment.objectives[objective.name] for objective in objectives]


def _distribution(parameter: Parameter) -> optuna.distributions.BaseDistribution:
    if parameter.choices:
        return optuna.distributions.CategoricalDistribution(parameter.materials or parameter.choices)
    ends = (parameter.lower, parameter.upper)
    return optuna.distributions.FloatDistribution(*ends, log=parameter.logarithmic)


def _attributes(assessment: Assessment) -> dict[str, Any]:
    return {
        "status": str(assessment.status),
        "reason": assessment.reason,
        "violation": assessment.violation,
    }


class OptunaObjective:
    """What `study.optimize` calls: evaluates the design that a trial suggests.

        objective = problem.optuna_objective()
        study = optuna.create_study(directions=objective.directions)
        study.optimize(objective, n_trials=100)

    A design that lacks an objective is pruned. Status, reason and violation are attributes of the trial. From
    version 5 on, Optuna takes the constraints with the trial; samplers of version 4 have to be given
    `constraints_func=objective.constraints`.

    Args:
        problem: whose designs are evaluated.
    Attributes:
        directions: of the objectives, for `optuna.create_study`.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self.directions = [DIRECTIONS[objective.sense] for objective in problem.objectives]

    def __repr__(self) -> str:
        return f"<objective {self._problem.name} for Optuna: {', '.join(self.directions)}>"

    def __call__(self, trial: optuna.Trial) -> list[float]:
        """Natural objective values, in the problem's order.

        Raises:
            optuna.TrialPruned: one of them does not exist.
        """
        objectives = self._problem.objectives
        design = {each.name: _suggested(trial, each) for each in self._problem.parameters}
        assessment = self._problem.evaluate(design).assessment
        constraints = constraint_values(objectives, self._problem.constraints, assessment)
        for name, value in _attributes(assessment).items():
            trial.set_user_attr(name, value)
        trial.set_user_attr("constraints", constraints)
        if hasattr(trial, "set_constraint"):
            for name, constraint in zip(
                constraint_names(self._problem.constraints), constraints, strict=True
            ):
                trial.set_constraint(name, constraint)
        values = _values(objectives, assessment)
        if values is None:
            raise optuna.TrialPruned(assessment.reason)
        return values

    @staticmethod
    def constraints(trial: optuna.trial.FrozenTrial) -> Sequence[float]:
        """The constraints of a trial that this objective has seen, positive where violated."""
        found: Sequence[float] = trial.user_attrs["constraints"]
        return found


def _suggested(trial: optuna.Trial, parameter: Parameter) -> float:
    if not parameter.choices:
        ends = (parameter.lower, parameter.upper)
        return trial.suggest_float(parameter.name, *ends, log=parameter.logarithmic)
    if not parameter.materials:
        return float(trial.suggest_categorical(parameter.name, parameter.choices))
    chosen = trial.suggest_categorical(parameter.name, parameter.materials)
    return dict(zip(parameter.materials, parameter.choices, strict=True))[str(chosen)]
