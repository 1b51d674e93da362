"""Where solves begin that know nothing better: fixed starts, and many for a person alone."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import product

import numpy as np

from evodesign.nlp.program import Program, Start, Variable
from evodesign.nlp.solver import Solver
from evodesign.posture.assemble import Slot
from evodesign.posture.results import Array
from evodesign.posture.seeking.budget import BUDGET

NamedStart = tuple[str, Start]
"""A start with its name in results."""

SHARES = ((0.5, 0.5), (1.0, 0.5))
"""Fixed starts, as the share of the way from zero to the middle of each joint's range: of robots, of people.

Of nine such starts this pair came within 2 % of the best of 19 on 86 % of 42 heights of random designs; a
start portfolio does better and takes their place where there is one.
"""


def fixed_starts(program: Program, people: Collection[str]) -> tuple[Start, ...]:
    """A program's own starting values, with the joints of each agent a share of the way to mid-range.

    Args:
        program: whose variables they are of.
        people: names of the agents that are people.
    """
    own = {variable.name: variable.start for variable in program.variables}
    return tuple(
        own
        | {
            joints.name: _inside(joints, shares[agent in people] * _middle(joints))
            for agent, joints in _joints(program)
        }
        for shares in SHARES
    )


UNIVERSAL = (0.1, 0.5, 1.0)
"""Shares of the way from zero to mid-range at which joints begin where optima are sought."""


def universal_starts(program: Program, people: Sequence[Start] = ()) -> tuple[Start, ...]:
    """Starts all over a program: each agent's joints at shares of the way to mid-range.

    Args:
        program: whose variables they are of.
        people: the person's side of starts, where it is known better; each is put beside each robot.
    """
    own: Start = {variable.name: variable.start for variable in program.variables}
    sides = [
        people
        if people and any(joints.name in person for person in people)
        else [{joints.name: _inside(joints, share * _middle(joints))} for share in UNIVERSAL]
        for agent, joints in _joints(program)
    ]
    return tuple(
        {name: values for part in (own, *parts) for name, values in part.items()} for parts in product(*sides)
    )


def named_starts(solver: Solver, portfolio: Sequence[Start], fixed: Sequence[Start]) -> list[NamedStart]:
    """Where a program begins, each start with its name in results.

    Args:
        solver: of the program; starts that do not fit its variables, made for other agents, are left out.
        portfolio: of the problem.
        fixed: starts where none of the portfolio fits.
    """
    rows = solver.program.counts
    fitting = [start for start in portfolio if all(len(v) == rows[n] for n, v in start.items() if n in rows)]
    kind, starts = ("start", fitting) if fitting else ("fixed start", fixed)
    return [(f"{kind} {number}", start) for number, start in enumerate(starts, 1)]


def different_people(program: Program, starts: Sequence[Start], names: Collection[str]) -> list[Start]:
    """The people of starts, by variable name: those who stand most differently, as a few stand for all.

    Robot and person have several ways to stand each, and only the load couples them: starts of both together
    hold few of all the pairs. Each next person is the one whose joints are farthest from all before.

    Args:
        program: of both agents.
        starts: those that do not fit the people's variables, made for another form, are left out.
        names: of the agents that are people.
    """
    slots = {v.name: (v.key, v.symbol.numel()) for v in program.variables if isinstance(v.key, Slot)}
    own = {name: (slot, rows) for name, (slot, rows) in slots.items() if slot.party in names}
    people = [
        {name: start[name] for name in own}
        for start in starts
        if all(len(start.get(name, ())) == rows for name, (_, rows) in own.items())
    ]
    joints = [name for name, (slot, _) in own.items() if slot.part == "joints"]
    places = [np.concatenate([person[name] for name in joints]) for person in people]
    chosen = list(range(len(people)))[:1]
    while len(chosen) < min(BUDGET.people, len(people)):
        apart = [min(np.linalg.norm(place - places[index]) for index in chosen) for place in places]
        chosen.append(int(np.argmax(apart)))
    return [people[index] for index in chosen]


def _joints(program: Program) -> list[tuple[str, Variable]]:
    """The joints of each agent with a body."""
    slots = [(variable.key, variable) for variable in program.variables]
    return [(slot.party, v) for slot, v in slots if isinstance(slot, Slot) and slot.part == "joints"]


def _middle(joints: Variable) -> Array:
    return np.asarray((joints.lower + joints.upper) / 2.0)


def _inside(joints: Variable, values: Array) -> Array:
    return np.asarray(np.clip(values, joints.lower, joints.upper))


PERSON_SHARES = (0.1, 0.5, 1.0)
RANDOM_STARTS = 9
SPREAD = 0.3  # [rad], of random starts about the shares


def person_starts(program: Program) -> tuple[Start, ...]:
    """Many starts for a person alone, always the same ones: shares of the way to mid-range, with noise."""
    rng = np.random.default_rng(0)
    ((_, joints),) = _joints(program)
    middle = _middle(joints)
    noise = [np.zeros(len(middle))] * len(PERSON_SHARES)
    noise += [SPREAD * rng.standard_normal(len(middle)) for _ in range(RANDOM_STARTS)]
    shares = [PERSON_SHARES[i % len(PERSON_SHARES)] for i in range(len(noise))]
    return tuple(
        {joints.name: _inside(joints, share * middle + n)} for share, n in zip(shares, noise, strict=True)
    )
