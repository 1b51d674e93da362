"""One agent's part of a program: how it stands, and what it bears there with the load as it is.

Source: Sartore et al. 2022, Eq. 14; DESIGN 3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import Constraint, Variable
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.floating_base import Stand, stand_of
from evodesign.posture.terms.torque import Bearing, bear
from evodesign.tree.model import Tree

__all__ = ["AgentBlock", "agent_block"]

Expression = Any


@dataclass(frozen=True, slots=True)
class AgentBlock:
    """An agent's part of a program.

    Args:
        stand: its base and joints, and what binds them.
        bearing: its wrenches and torques, and what binds them.
    """

    stand: Stand
    bearing: Bearing

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Base, joints, wrenches and torques."""
        return (*self.stand.variables, *self.bearing.variables)

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """Everything that binds the agent alone, given the grasp points."""
        stand, bearing = self.stand, self.bearing
        feet = [
            row
            for side in stand.form.sides
            for row in (stand.flat[side], bearing.contact[side], stand.yaw[side])
        ]
        return (*stand.hands, *feet, *stand.stance, *bearing.balance)

    @property
    def hand_wrenches(self) -> Mapping[str, Expression]:
        """Force [N] and moment [N m] on both hands by side, in the agent's frame."""
        return self.bearing.hand_wrenches

    @property
    def effort(self) -> Expression:
        """Squared norm of all the agent's torques [N^2 m^2]."""
        return self.bearing.effort

    @property
    def comfort(self) -> Expression:
        """What is slightly disliked of posture and wrenches."""
        return self.stand.comfort + self.bearing.comfort


def agent_block(form: Form, tree: Tree, scene: Scene, height: Expression) -> AgentBlock:
    """Variables, constraints and effort of one agent.

    Args:
        form: all of the agent, or its left half.
        tree: the agent's whole tree, resized by a design; numbers or expressions.
        scene: load, ground and stance.
        height: of the load's centre above the ground [m].
    """
    stand = stand_of(form, tree, scene, height)
    return AgentBlock(stand, bear(stand, scene))
