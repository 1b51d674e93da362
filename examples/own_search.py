"""A search of your own, in a file of your own: small steps from the best design so far. About a minute.

Its name is MODULE:CLASS. It is logged, resumed and run in parallel like any other, for it is ready when
constructed, and its random numbers come from the seed alone. EVODESIGN_MODULES names the modules that
evodesign may import: a run that somebody sends executes nothing that you did not ask for.

    python examples/own_search.py [EVALUATIONS]
"""

import os
import sys

import numpy as np

import evodesign


class SmallSteps:
    """Normally distributed steps from the genome with the best first objective so far."""

    def __init__(self, settings):
        self.settings = settings
        self.random = np.random.default_rng(settings.seed)
        self.best, self.value = np.full(settings.dimension, 0.5), np.inf
        self.asked = self.step()

    def step(self):
        steps = 0.1 * self.random.standard_normal((self.settings.population, self.settings.dimension))
        return [tuple(genome) for genome in np.clip(self.best + steps, 0.0, 1.0).tolist()]

    def ask(self):
        return self.asked

    def tell(self, outcomes):
        for genome, outcome in zip(self.asked, outcomes, strict=True):
            if outcome.feasible and outcome.objectives[0] < self.value:
                self.best, self.value = np.array(genome), outcome.objectives[0]
        self.asked = self.step()


if __name__ == "__main__":
    evaluations = int(sys.argv[1]) if len(sys.argv) > 1 else 24
    os.environ["EVODESIGN_MODULES"] = "own_search"
    search = {"algorithm": "own_search:SmallSteps", "population": 6, "seed": 1, "jobs": 2}
    run = evodesign.search("point-grasp", "runs/steps", evaluations=evaluations // 2, **search)
    run = evodesign.resume("runs/steps", evaluations=evaluations, jobs=2)
    values = [design.objectives["robot_torque"] for design in run.designs if design.feasible]
    print(f"robot torque from {values[0]:.2f} to {min(values):.2f} N m in {len(run)} designs")
