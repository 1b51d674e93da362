"""Searches of other libraries at their defaults, by ask and tell, beside which ours are measured.

pymoo and Optuna know no gradients and no reference point; BoTorch is told the reference, as it has to be.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Protocol

import optuna
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.algorithms.moo.sms import SMSEMOA
from pymoo.config import Config
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination
from pymoo.util.ref_dirs import get_reference_directions
from scipy.stats import qmc

from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.ranking import usable, with_outcomes

BOTORCH = "BoTorch qLogNEHVI"
"""Left out unless it is asked for: it needs PyTorch (`pip install botorch`) and minutes of processor time."""


class BaselineSearch(Protocol):
    """What is asked for designs and told what they were worth."""

    def ask(self) -> list[Genome]:
        """The next designs."""

    def tell(self, outcomes: list[Outcome]) -> None:
        """What they were worth."""


class PymooSearch:
    """An algorithm of pymoo."""

    def __init__(self, name: str, settings: SearchSettings) -> None:
        Config.warnings["not_compiled"] = False
        directions = get_reference_directions("das-dennis", settings.objectives, n_partitions=12)
        self._algorithm = {
            "pymoo NSGA-II": NSGA2,
            "pymoo NSGA-III": lambda: NSGA3(directions),
            "pymoo SMS-EMOA": SMSEMOA,
        }[name]()
        problem = Problem(settings.dimension, settings.objectives, n_ieq_constr=1, xl=0.0, xu=1.0)
        self._algorithm.setup(problem, termination=NoTermination(), seed=settings.seed)
        self._objectives = settings.objectives
        self._asked = self._algorithm.ask()

    def ask(self) -> list[Genome]:
        """The next designs."""
        return [tuple(row) for row in self._asked.get("X").tolist()]

    def tell(self, outcomes: list[Outcome]) -> None:
        """What they were worth."""
        with_outcomes(self._asked, outcomes, self._objectives)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # comparisons of objectives that do not exist
            self._algorithm.tell(infills=self._asked)
            self._asked = self._algorithm.ask()


class OptunaSearch:
    """A sampler of Optuna, one design at a time; a design without objectives is a failed trial."""

    def __init__(self, name: str, settings: SearchSettings) -> None:
        optuna.logging.set_verbosity(optuna.logging.ERROR)
        sampler = optuna.samplers.TPESampler if name == "Optuna TPE" else optuna.samplers.NSGAIISampler
        self._study = optuna.create_study(
            directions=["minimize"] * settings.objectives, sampler=sampler(seed=settings.seed)
        )
        self._space = {
            f"u{place:02d}": optuna.distributions.FloatDistribution(0.0, 1.0)
            for place in range(settings.dimension)
        }

    def ask(self) -> list[Genome]:
        """The next design."""
        self._trial = self._study.ask(self._space)
        return [tuple(self._trial.params[name] for name in self._space)]

    def tell(self, outcomes: list[Outcome]) -> None:
        """What it was worth."""
        values = usable(outcomes[0])
        if values is None:
            self._study.tell(self._trial, state=optuna.trial.TrialState.FAIL)
        else:
            self._study.tell(self._trial, values)


class BotorchSearch:
    """Noisy expected hypervolume improvement, eight designs at once, as in BoTorch's tutorial."""

    def __init__(self, name: str, settings: SearchSettings) -> None:
        self._settings = settings
        first = qmc.Sobol(settings.dimension, seed=settings.seed).random(64)[: 2 * (settings.dimension + 1)]
        self._asked = [tuple(row) for row in first.tolist()]
        self._points: list[Genome] = []
        self._values: list[tuple[float, ...]] = []

    def ask(self) -> list[Genome]:
        """The next designs."""
        return self._asked

    def tell(self, outcomes: list[Outcome]) -> None:
        """What they were worth."""
        for genome, outcome in zip(self._asked, outcomes, strict=True):
            values = usable(outcome)
            if values is not None:
                self._points.append(genome)
                self._values.append(values)
        self._asked = self._proposed()

    def _proposed(self) -> list[Genome]:
        import torch
        from botorch.acquisition.multi_objective.logei import qLogNoisyExpectedHypervolumeImprovement
        from botorch.fit import fit_gpytorch_mll
        from botorch.models import ModelListGP, SingleTaskGP
        from botorch.models.transforms import Standardize
        from botorch.optim import optimize_acqf
        from gpytorch.mlls import SumMarginalLogLikelihood

        torch.set_num_threads(1)
        torch.manual_seed(self._settings.seed * 10_000 + len(self._points))
        points = torch.tensor(self._points, dtype=torch.double)
        values = -torch.tensor(self._values, dtype=torch.double)
        model = ModelListGP(
            *(
                SingleTaskGP(points, values[:, [k]], outcome_transform=Standardize(1))
                for k in range(values.shape[1])
            )
        )
        fit_gpytorch_mll(SumMarginalLogLikelihood(model.likelihood, model))
        reference = [-value for value in self._settings.reference_values]
        gain = qLogNoisyExpectedHypervolumeImprovement(model, reference, points, prune_baseline=True)
        bounds = torch.stack([torch.zeros(points.shape[1]), torch.ones(points.shape[1])]).double()
        found, _ = optimize_acqf(gain, bounds, q=8, num_restarts=4, raw_samples=128, sequential=True)
        return [tuple(row) for row in found.tolist()]


BASELINES: Mapping[str, Callable[[str, SearchSettings], BaselineSearch]] = {
    "pymoo NSGA-II": PymooSearch,
    "pymoo NSGA-III": PymooSearch,
    "pymoo SMS-EMOA": PymooSearch,
    "Optuna NSGA-II": OptunaSearch,
    "Optuna TPE": OptunaSearch,
    BOTORCH: BotorchSearch,
}
