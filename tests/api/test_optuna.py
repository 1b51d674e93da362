"""Runs as studies of Optuna, and problems as objectives for its samplers."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import optuna
import pytest
from optuna.trial import TrialState

from evodesign.api.optuna_study import OptunaObjective
from evodesign.api.run import Run
from evodesign.errors import InputError
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import Evaluation, Parameter
from evodesign.runlog.run import RunLog
from tests.api.test_pymoo import ToyProblem
from tests.runlog.toys import lost, toy_evaluations, toy_header

HEADER = toy_header(budget=40)
STEEL = Parameter("density.arm", 900.0, 7800.0, "kg/m^3", (900.0, 2700.0, 7800.0), ("nylon", "alu", "steel"))


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    yield
    optuna.logging.set_verbosity(before)


def run_of(evaluations: list[Evaluation], header: Any = HEADER) -> Run:
    return Run(RunLog(Path("runs/toy"), header, tuple(evaluations), (), (), (), complete=True, notes=()))


@pytest.fixture
def run() -> Run:
    evaluations = toy_evaluations(HEADER, 40)
    return run_of([lost(each) if each.number == 7 else each for each in evaluations])


def storages(folder: Path) -> dict[str, Any]:
    file = optuna.storages.journal.JournalFileBackend(str(folder / "journal.log"))
    return {
        "memory": None,
        "path": folder / "study.db",
        "URL": f"sqlite:///{folder / 'other.db'}",
        "journal": optuna.storages.JournalStorage(file),
    }


@pytest.mark.filterwarnings("ignore::optuna.exceptions.ExperimentalWarning")
@pytest.mark.parametrize("kind", ["memory", "path", "URL", "journal"])
def test_study_holds_the_run(run: Run, tmp_path: Path, kind: str) -> None:
    storage = storages(tmp_path)[kind]
    study = run.to_optuna(storage)
    if storage is not None:  # read again, from the disk
        place = f"sqlite:///{storage}" if isinstance(storage, Path) else storage
        study = optuna.load_study(storage=place, study_name="toy, toy")
    assert sorted(trial.user_attrs["number"] for trial in study.best_trials) == sorted(
        design.number or 0 for design in run.front
    )
    assert [direction.name for direction in study.directions] == ["MINIMIZE", "MAXIMIZE"]
    assert len(study.trials) == len(run)
    for trial, design in zip(study.trials, run.designs, strict=True):
        assert trial.params == design.parameters
        assert trial.user_attrs["number"] == design.number == trial.number
        assert trial.user_attrs["generation"] == trial.number // HEADER.search.population
        assert trial.user_attrs["violation"] == design.violation
        assert (trial.user_attrs["status"], trial.user_attrs["reason"]) == (design.status, design.reason)
        unknown = math.inf if design.violation is None else design.violation
        assert list(trial.constraints.values()) == [unknown]
        if design.feasible:
            assert trial.state is TrialState.COMPLETE
            assert trial.values == [design.objectives[each.name] for each in run.objectives]
        else:
            assert (trial.state, trial.values) == (TrialState.FAIL, None)


def test_infeasible_design_with_all_objectives_is_complete_and_never_best() -> None:
    """As where a constraint of one's own is violated: samplers may learn from its values."""
    evaluations = toy_evaluations(HEADER, 6)
    best = msgspec.structs.replace(
        evaluations[0].assessment, objectives={"robot_torque": 0.1, "reach_height": 9.0}, violation=0.5
    )
    evaluations[0] = msgspec.structs.replace(evaluations[0], assessment=best)
    study = run_of(evaluations).to_optuna()
    assert study.trials[0].state is TrialState.COMPLETE
    assert 0 not in [trial.number for trial in study.best_trials]


def test_materials_are_categories() -> None:
    header = msgspec.structs.replace(HEADER, parameters=(*HEADER.parameters, STEEL))
    run = run_of(toy_evaluations(header, 9), header)
    for trial, design in zip(run.to_optuna().trials, run.designs, strict=True):
        assert trial.params["density.arm"] == STEEL.material_of(design.parameters["density.arm"])
        assert trial.distributions["density.arm"].choices == STEEL.materials


def test_sampler_goes_on_with_the_study_of_a_run(run: Run) -> None:
    study = run.to_optuna()
    study.sampler = optuna.samplers.TPESampler(seed=1, n_startup_trials=2)
    trial = study.ask(study.trials[0].distributions)
    assert all(0.5 <= value <= 2.0 for value in trial.params.values())


def test_empty_run_is_an_empty_study() -> None:
    assert run_of([]).to_optuna().trials == []


def test_study_that_exists_is_refused(run: Run, tmp_path: Path) -> None:
    run.to_optuna(tmp_path / "study.db", "mine")
    with pytest.raises(InputError, match="study_name: wanted a name that the storage does not have yet, fo"):
        run.to_optuna(tmp_path / "study.db", "mine")


@pytest.mark.parametrize("storage", ["nonsense", "sqlite:////nowhere/at/all.db", "nosuch://place"])
def test_storage_that_cannot_be_used_is_refused_in_one_sentence(run: Run, storage: str) -> None:
    with pytest.raises(InputError, match=f"storage: wanted a storage of Optuna, .* found '{storage}'"):
        run.to_optuna(storage)


def test_missing_optuna_says_how_to_install_it(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "evodesign.api.optuna_study")
    monkeypatch.setitem(sys.modules, "optuna", None)
    with pytest.raises(InputError, match=r"pip install 'evodesign\[notebook\]'"):
        run.to_optuna()


@pytest.mark.parametrize("sampler", [optuna.samplers.TPESampler, optuna.samplers.NSGAIISampler])
@pytest.mark.parametrize("given", [False, True], ids=["by the trial", "by constraints_func"])
def test_objective_prunes_designs_that_lack_a_value(sampler: Any, given: bool) -> None:
    toy: Any = ToyProblem(3)
    objective = OptunaObjective(toy)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # the parameter goes away in a later version
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        settings = {"constraints_func": objective.constraints} if given else {}
        study = optuna.create_study(directions=objective.directions, sampler=sampler(seed=1, **settings))
    study.optimize(objective, n_trials=40)
    states = {TrialState.COMPLETE: 0, TrialState.PRUNED: 0}
    for trial in study.trials:
        design = toy.evaluate(list(trial.params.values()))
        states[trial.state] += 1
        assert trial.user_attrs["violation"] == design.violation
        if trial.state is TrialState.COMPLETE:
            assert trial.values == list(design.objectives.values())
            assert set(trial.constraints.values()) == {0.0}
        else:
            assert min(trial.constraints.values()) > 0.0
    assert min(states.values()) > 4
    assert study.best_trials


def test_objective_asks_for_materials_by_name(repository: Path) -> None:
    """What the sampler is asked is what the problem takes: the material's density."""
    built = build_problem(read_source(repository / "problems" / "icub_materials.toml"))
    parameters = built.space.records

    class Stopped(Exception):
        pass

    class Asked:
        objectives = built.objectives

        def __init__(self) -> None:
            self.parameters = parameters

        def evaluate(self, design: dict[str, float]) -> Any:
            for each in parameters:
                assert design[each.name] in each.choices or not each.choices
            raise Stopped

    asked: Any = Asked()
    study = optuna.create_study(sampler=optuna.samplers.RandomSampler(seed=1))
    with pytest.raises(Stopped):
        study.optimize(OptunaObjective(asked), n_trials=1)
    chosen = {name: value for name, value in study.trials[0].params.items() if isinstance(value, str)}
    assert {each.name for each in parameters if each.materials} == set(chosen)
