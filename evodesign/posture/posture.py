"""The posture problem: how robot and person stand with the load at one height, straining least.

    minimise    w_r |tau_r|^2 + w_h |tau_h|^2 + comfort
    subject to  the constraints of both agents and of the load

for any design (a parameter of one program built once). It is solved from a few fixed starts and the best
result that the independent check accepts is kept, so that the answer depends on problem and design alone.

Source: Sartore et al. 2022, Eq. 14 with pi fixed; DESIGN 3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from evodesign.design.space import DesignSpace
from evodesign.posture.agent import TORQUE_UNIT, agent_block
from evodesign.posture.check import TOLERANCE, Checker
from evodesign.posture.load import load_constraints
from evodesign.posture.program import IpoptOptions, Program, RawSolution, Solver
from evodesign.posture.solution import AgentPosture, Attempt, HeightSolution, posture_of
from evodesign.records import Status, worst_status
from evodesign.statics.scene import HUMAN, ROBOT, Agent, Scene

__all__ = ["EffortWeights", "PostureProblem"]

STARTS: tuple[Mapping[str, float], ...] = ({ROBOT: 0.5, HUMAN: 0.5}, {ROBOT: 1.0, HUMAN: 0.5})
"""Starts, as the share of the way from zero to the middle of each joint's range, by agent.

Of nine such starts this pair gave the best of 19 on 86 % of 42 heights of random designs, within 2 %.
"""


@dataclass(frozen=True, slots=True)
class EffortWeights:
    """Weights w_r and w_h of the agents' squared torques."""

    robot: float = 1.0
    human: float = 1.0


class PostureProblem:
    """One posture program for all designs and heights of a scene."""

    def __init__(
        self, scene: Scene, space: DesignSpace, weights: EffortWeights, options: IpoptOptions
    ) -> None:
        self._scene = scene
        self._agents = (scene.robot, scene.human)
        self._solver = Solver(_program(scene, space, weights), options)
        self._starts = tuple(_start(self._solver, self._agents, shares) for shares in STARTS)

    def solve(self, values: Sequence[float], height: float, checker: Checker) -> HeightSolution:
        """The best checked posture of a design at one height.

        Args:
            values: one number per design parameter.
            height: of the load's centre [m].
            checker: the independent check, made for this design.
        """
        attempts: list[Attempt] = []
        best: tuple[float, Mapping[str, AgentPosture], Mapping[str, float]] | None = None
        for start in self._starts:
            raw = self._solver.solve([*values, height], start)
            postures = {agent.name: posture_of(agent, raw) for agent in self._agents}
            residuals = checker.residuals(postures, height) if raw.status is Status.SOLVED else {}
            attempt = _attempt(raw, residuals)
            attempts.append(attempt)
            if attempt.status is Status.SOLVED and (best is None or raw.cost < best[0]):
                best = (raw.cost, postures, residuals)
        if best is None:
            status = worst_status([attempt.status for attempt in attempts])
            reason = f"no posture found at {height:g} m: " + "; ".join(a.reason for a in attempts)
            return HeightSolution(height, status, reason, {}, {}, tuple(attempts))
        return HeightSolution(height, Status.SOLVED, "solved", best[1], best[2], tuple(attempts))


def _program(scene: Scene, space: DesignSpace, weights: EffortWeights) -> Program:
    design = ca.SX.sym("design", len(space.parameters))
    height = ca.SX.sym("height")
    tree = space.resized(scene.robot.tree, ca.vertsplit(design))
    robot = agent_block(scene.robot, tree, scene, height)
    human = agent_block(scene.human, scene.human.tree, scene, height)
    load = load_constraints(scene, {ROBOT: robot.hand_wrenches, HUMAN: human.hand_wrenches})
    effort = weights.robot * ca.sumsqr(robot.torques) + weights.human * ca.sumsqr(human.torques)
    return Program(
        name="posture",
        variables=(*robot.variables, *human.variables),
        constraints=(*robot.constraints, *human.constraints, *load),
        cost=effort / TORQUE_UNIT**2 + robot.comfort + human.comfort,
        parameters=ca.vertcat(design, height),
    )


def _start(solver: Solver, agents: Sequence[Agent], shares: Mapping[str, float]) -> dict[str, Any]:
    start = solver.start
    for agent in agents:
        block = next(v for v in solver.program.variables if v.name == f"{agent.name}.joints")
        middle = (block.lower + block.upper) / 2.0
        start[block.name] = np.clip(shares[agent.name] * middle, block.lower, block.upper)
    return start


def _attempt(raw: RawSolution, residuals: Mapping[str, float]) -> Attempt:
    status, reason = raw.status, raw.reason
    if residuals:
        worst = max(residuals, key=lambda name: residuals[name])
        if not residuals[worst] <= TOLERANCE:
            status = Status.NUMERICAL_FAILURE
            reason = f"the check found {worst} {residuals[worst]:.1e} above {TOLERANCE:g}"
    return Attempt(status, reason, raw.iterations, raw.seconds, raw.cost)
