"""Where solves begin: the same few postures for every design, so that a score depends on the design alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from evodesign.mechanics.scene import HUMAN, ROBOT
from evodesign.nlp.program import Solver, Start

__all__ = ["SEEDS_BESIDE", "fixed_starts", "named_starts", "person_starts"]

SEEDS_BESIDE = 2
"""Seeds solved beside a neighbour's solution, which mostly leads to the best optimum by itself."""

SHARES: tuple[Mapping[str, float], ...] = ({ROBOT: 0.5, HUMAN: 0.5}, {ROBOT: 1.0, HUMAN: 0.5})
"""Fixed starts, as the share of the way from zero to the middle of each joint's range, by agent.

Of nine such starts this pair came within 2 % of the best of 19 on 86 % of 42 heights of random designs; a
portfolio of seeds does better (see `start_portfolio`) and takes their place where there is one.
"""


def fixed_starts(solver: Solver) -> tuple[Start, ...]:
    """A program's own starting values, with the joints of each agent a share of the way to mid-range."""
    return tuple(_start(solver, shares) for shares in SHARES)


def named_starts(
    program: str, solver: Solver, seeds: Sequence[Start], fixed: Sequence[Start]
) -> list[tuple[str, Start]]:
    """Where a program begins, each start with its name in results.

    Args:
        program: its name.
        solver: of it; seeds that do not fit its variables, made for other agents, are left out.
        seeds: of the problem.
        fixed: starts where no seed fits.
    """
    rows = {variable.name: variable.symbol.numel() for variable in solver.program.variables}
    fitting = [seed for seed in seeds if all(len(v) == rows[n] for n, v in seed.items() if n in rows)]
    kind, starts = ("seed", fitting) if fitting else ("start", fixed)
    return [(f"{program}: {kind} {number}", start) for number, start in enumerate(starts, 1)]


def _start(solver: Solver, shares: Mapping[str, float]) -> Start:
    start = solver.start
    for variable in solver.program.variables:
        agent, _, part = variable.name.partition(".")
        if part == "joints" and agent in shares:
            middle = (variable.lower + variable.upper) / 2.0
            start[variable.name] = np.clip(shares[agent] * middle, variable.lower, variable.upper)
    return start


PERSON_SHARES = (0.1, 0.5, 1.0)
RANDOM_STARTS = 9
SPREAD = 0.3  # [rad], of random starts about the shares


def person_starts(solver: Solver) -> tuple[Start, ...]:
    """Many starts for a person alone, always the same ones: shares of the way to mid-range, with noise."""
    rng = np.random.default_rng(0)
    block = next(v for v in solver.program.variables if v.name == f"{HUMAN}.joints")
    middle = (block.lower + block.upper) / 2.0
    noise = [np.zeros(len(middle))] * len(PERSON_SHARES)
    noise += [SPREAD * rng.standard_normal(len(middle)) for _ in range(RANDOM_STARTS)]
    shares = [PERSON_SHARES[i % len(PERSON_SHARES)] for i in range(len(noise))]
    return tuple(
        {block.name: np.clip(share * middle + n, block.lower, block.upper)}
        for share, n in zip(shares, noise, strict=True)
    )
