"""Does one start at the mean of the measured postures find a person's best posture?

Holds of a person alone are drawn: a woman or a man of any percentile from 5 to 95, loads from 2.5 to 10 kg in
the person's hands at 0.3 to 1.4 m, a push along the load of up to 5 N. Told is in how many of those that
anybody finds the start at the mean is within 1 % of the best of random starts (each variable anywhere between
its bounds), how many of the random starts are, and the iterations of the start at the mean.

    python -m benchmarks.one_start [--holds 200] [--starts 25]
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from evodesign.human.measured_posture import HumanPosture
from evodesign.human.population import population
from evodesign.mechanics.agent import ROBOT, Role
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.solver import RawSolution, SolverCache
from evodesign.posture.formulations.person import PersonProblem
from evodesign.posture.results import Array
from evodesign.posture.seeking.landscape import cost_of
from evodesign.posture.seeking.measured_starts import measured_starts
from evodesign.posture.symmetry import half
from evodesign.validation.compare import LARGE
from evodesign.validation.posed import agent_of

SEXES = ("female", "male")


def costs_of_hold(rng: np.random.Generator, starts: int) -> tuple[RawSolution, Array]:
    """Where the mean leads in a drawn hold, and the costs of random starts; infinite where they find none."""
    percentile = float(rng.uniform(5.0, 95.0))
    (person,) = population(SEXES[int(rng.integers(2))], [percentile]).values()
    form = half(agent_of(person, HumanPosture.MEASURED))
    load, height, push = rng.uniform(2.5, 10.0), rng.uniform(0.3, 1.4), rng.uniform(-5.0, 5.0)
    scene = Scene(
        (replace(form.agent, name=ROBOT, role=Role.ROBOT, quarters=0), form.agent), Payload(LARGE, 2.0 * load)
    )
    problem = PersonProblem(form, scene, 1.0, SolverOptions(compiled=False), SolverCache())

    def led(start: dict[str, Array]) -> RawSolution:
        return problem.solve(height, push, start)

    mean = led(dict(measured_starts(problem.program, form, scene, (height,))[0]))
    wide = [each for each in problem.program.variables if each.drawn]
    drawn = [led({v.name: rng.uniform(v.lower, v.upper) for v in wide}) for _ in range(starts)]
    return mean, np.array([cost_of(raw) for raw in drawn])


def main() -> None:
    """Draw holds, and tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--holds", type=int, default=200)
    parser.add_argument("--starts", type=int, default=25)
    given = parser.parse_args()
    rng = np.random.default_rng(40)
    means, shares, iterations, held = [], [], [], 0
    for _ in range(given.holds):
        mean, costs = costs_of_hold(rng, given.starts)
        own, best = cost_of(mean), min(cost_of(mean), *costs)
        if np.isfinite(best):
            held += 1
            means.append(own <= 1.01 * costs.min())
            shares.append(np.mean(costs <= 1.01 * best))
            iterations.append(mean.iterations)
    good, share, steps = sum(means), np.mean(shares), np.median(iterations)
    print(f"{held} of {given.holds} holds are found; the mean is as good as the best random start in {good}")
    print(f"random starts within 1 %: {share:.0%}; iterations from the mean: {steps:.0f}")


if __name__ == "__main__":
    main()
