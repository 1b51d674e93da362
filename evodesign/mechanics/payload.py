"""The load: a box held level by hands, and how hands hold it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Vector
from evodesign.body.shape import Box
from evodesign.mechanics.agent import TO_THE_LEFT, Agent, Contact
from evodesign.mechanics.disturbance import Disturbance

DIAGONAL = math.sqrt(0.5)

WRIST_MOMENT = 7.0
"""Largest moment of a hand about each axis [N m] that a person's wrists bear, whoever is on the other side.

That of extension, the weakest direction: 7.1 N m, the mean of ten men.
Source: Delp, Grierson and Buchanan 1996.
"""


class Grasp(StrEnum):
    """What a hand can pass to the load: a force (as in the paper), or a force and a moment."""

    POINT = "point"
    RIGID = "rigid"


class GraspDirection(StrEnum):
    """From where an agent's forearms come to the load: from below and behind, from outside and behind."""

    FREE = "free"
    UNDER = "under"
    SIDE = "side"

    def axis(self, side: str) -> Vector | None:
        """Direction of a side's forearm from elbow to hand, in the agent's frame; None if it is free."""
        inward = -DIAGONAL if side == "left" else DIAGONAL
        return {
            GraspDirection.FREE: None,
            GraspDirection.UNDER: (DIAGONAL, 0.0, DIAGONAL),
            GraspDirection.SIDE: (DIAGONAL, inward, 0.0),
        }[self]


@dataclass(frozen=True, slots=True)
class Payload:
    """A box held level by four hands. Its frame has the world's axes and its origin at the box's centre.

    Args:
        size: depth along x (robot to person), width along y, height along z [m].
        mass: [kg].
        center_of_mass: from the box's centre, in its frame [m].
        grasp: what every hand can pass to the load.
        hand_moment: largest size of each component of the moment that a rigid hand passes [N m].
        grasp_points: of agents' hands in the load's frame [m], by the names of agent and contact; the hands
            that it leaves out are at the top edge that faces the agent, at 0.4 of the width to a side.
        label: what it is called where a problem has several loads.
        grasp_direction: from where forearms come to the load.
        grasp_cone: largest angle of a forearm from that direction [rad].
    """

    size: Vector
    mass: float
    center_of_mass: Vector = (0.0, 0.0, 0.0)
    grasp: Grasp = Grasp.POINT
    hand_moment: float = math.inf
    grasp_points: Mapping[tuple[str, str], Vector] = field(default_factory=dict)
    label: str = ""
    grasp_direction: GraspDirection = GraspDirection.FREE
    grasp_cone: float = math.radians(60.0)

    @property
    def inertia(self) -> Inertia:
        """Inertia in the load's frame, that of a uniform box moved to the centre of mass."""
        a, b, c = Box(*self.size).moments(self.mass)
        return Inertia(self.mass, self.center_of_mass, ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)))

    def disturbed(self, disturbance: Disturbance) -> Payload:
        """The load as a disturbance makes it."""
        moved = [c + shift for c, shift in zip(self.center_of_mass, disturbance.center_of_mass, strict=True)]
        mass = self.mass * (1.0 + disturbance.mass_share)
        return replace(self, mass=mass, center_of_mass=(moved[0], moved[1], moved[2]))

    def faced(self, agent: Agent) -> Vector:
        """Depth, width and height of the box as an agent sees it, along its own axes [m]."""
        depth, width, height = self.size
        return (width, depth, height) if agent.quarters % 2 else self.size

    def grasp_point(self, agent: Agent, hand: Contact) -> Vector:
        """Grasp point of an agent's hand, from the box's centre, in that agent's frame [m]."""
        given = self.grasp_points.get((agent.name, hand.name))
        if given is not None:
            return agent.from_world(given)
        depth, width, height = self.faced(agent)
        return (-depth / 2.0, 0.4 * width * TO_THE_LEFT[hand.side], height / 2.0)
