"""Disturbed cases of a program: one posture, and wrenches and torques of its own for each disturbance.

With K_c the cost of what is borne in case c (both agents' weighted efforts and the comfort of their wrenches;
the undisturbed case is one of them), n cases count together as

    mean     sum_c K_c / n
    worst    (1 - e) s + e sum_c K_c / n    with s >= K_c for every c, and e = 0.01

beside the comfort of the posture. A posture's wrenches in each case minimise K_c, whatever the weights of the
cases: the small share e of the mean sees to those cases that are not the worst. So a disturbance of size zero
leaves the undisturbed problem's optimum as it is, in both ways.

Source: epigraph form of a minimax problem: Boyd and Vandenberghe, Convex Optimization, section 4.1.3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.balance import AppliedWrench
from evodesign.mechanics.disturbance import Disturbance, OverCases, PushedAt
from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import Constraint, Program, Start, Variable, values_under
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.floating_base import Stand
from evodesign.posture.terms.grasp import free_hands
from evodesign.posture.terms.load import disturbed_load_constraints, turned_to_world
from evodesign.posture.terms.torque import Bearing, bear
from evodesign.tree.kinematics import vector

__all__ = [
    "Case",
    "aggregated",
    "cases_of",
    "filled",
    "postures_in_cases",
    "prefix_of",
    "with_cases",
    "with_worst",
]

Array = Any
Expression = Any

SHARE_OF_MEAN = 0.01
"""e: what the mean counts beside the worst case."""

WORST = "worst.cost"
"""Name of s, and of the rows K_c - s."""


@dataclass(frozen=True, slots=True)
class Case:
    """A disturbance's part of a program.

    Args:
        bearings: what the agents with a body bear, by name.
        variables, constraints: of all agents and of the load.
    """

    bearings: Mapping[str, Bearing]
    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]


def prefix_of(number: int) -> str:
    """What begins the names of variables and constraints of the disturbance of a number, from zero."""
    return f"disturbed_{number}."


def cases_of(scene: Scene, *stands: Stand) -> tuple[Case, ...]:
    """A case for each of a scene's disturbances that somebody with a body feels.

    Args:
        scene: undisturbed.
        stands: of both agents, or of one beside whom free hands stand in for the other.
    """
    places = [PushedAt(stand.form.agent.name) for stand in stands]
    return tuple(
        _case(scene, disturbance, prefix_of(number), stands)
        for number, disturbance in enumerate(scene.disturbances.cases)
        if any(disturbance.changes_for(place) for place in places)
    )


def _case(scene: Scene, disturbance: Disturbance, prefix: str, stands: Sequence[Stand]) -> Case:
    bearings = {
        stand.form.agent.name: bear(stand, scene, prefix, _pushes(stand, disturbance)) for stand in stands
    }
    hands = {name: bearing.hand_wrenches for name, bearing in bearings.items()}
    variables = [variable for bearing in bearings.values() for variable in bearing.variables]
    for agent in (scene.robot, scene.human):
        if agent.name not in bearings:
            partner = free_hands(stands[0].form, scene, prefix)
            hands[agent.name] = partner.wrenches
            variables += partner.variables
    symmetric = stands[0].form.mirror is not None
    load = disturbed_load_constraints(scene, disturbance, hands, prefix, symmetric=symmetric)
    rows = [row for b in bearings.values() for row in (*b.contact.values(), *b.balance)]
    return Case(bearings, tuple(variables), (*rows, *load))


def _pushes(stand: Stand, disturbance: Disturbance) -> list[AppliedWrench]:
    """A push on an agent's trunk, in the agent's frame."""
    agent = stand.form.agent
    push = disturbance.push_on(PushedAt(agent.name))
    if not any(push):
        return []
    force = turned_to_world(agent, vector(push))  # by 0 or 180 degrees, so there as back
    at = stand.poses[agent.pushed_frame].position
    return [AppliedWrench(agent.pushed_frame, at, force, ca.DM.zeros(3))]


def with_cases(program: Program, cases: Sequence[Case]) -> Program:
    """A program whose constraints hold in disturbed cases too."""
    return replace(
        program,
        variables=(*program.variables, *(v for case in cases for v in case.variables)),
        constraints=(*program.constraints, *(row for case in cases for row in case.constraints)),
    )


def aggregated(program: Program, effort: OverCases, costs: Sequence[Expression]) -> Program:
    """A program that minimises the costs of its cases beside the cost that it has.

    Args:
        program: whose cost is that of the posture itself.
        effort: how the cases count together.
        costs: K_c of each case, the undisturbed one among them.
    """
    mean = sum(costs) / len(costs)
    if effort is OverCases.MEAN:
        return replace(program, cost=program.cost + mean)
    worst = Variable.column(WORST, [0.0], [np.inf], [0.0], 1.0)
    below = Constraint(WORST, ca.vertcat(*costs) - worst.value, -np.inf, 0.0)
    return replace(
        program,
        variables=(*program.variables, worst),
        constraints=(*program.constraints, below),
        cost=program.cost + (1.0 - SHARE_OF_MEAN) * worst.value + SHARE_OF_MEAN * mean,
    )


def with_worst(start: Start, program: Program, parameters: Sequence[float]) -> Start:
    """A solution of a program as its start, with s as its cases ask for it."""
    for row in program.constraints:
        if row.name == WORST:
            costs = ca.Function("costs", [program.symbols, program.parameters], [row.expression])
            found = costs(program.packed({**start, WORST: [0.0]}), parameters)
            return {**start, WORST: [float(ca.mmax(found))]}
    return start


def filled(start: Start, program: Program) -> Start:
    """A start in which each disturbed case begins as the undisturbed one, unless it says otherwise."""
    known = dict(start)
    for variable in program.variables:
        _, _, name = variable.name.partition(".")
        if variable.name not in known and name in start:
            known[variable.name] = start[name]
    return known


def postures_in_cases(
    scene: Scene, forms: Sequence[Form], values: Mapping[str, Array]
) -> dict[str, dict[str, AgentPosture]]:
    """What each agent bears under each disturbance, by the disturbance's name and the agent's.

    Args:
        scene: whose disturbances they are.
        forms: of both agents.
        values: of a solution, by variable name, SI units.
    """
    found: dict[str, dict[str, AgentPosture]] = {}
    for number, disturbance in enumerate(scene.disturbances.cases):
        agents = {form.agent.name: form for form in forms}
        own = {name: values_under(f"{prefix_of(number)}{name}", values) for name in agents}
        found[disturbance.name] = {
            name: form.expand({**values_under(name, values), **own[name]}) for name, form in agents.items()
        }
    return found
