"""Where an actuator that is a body lies: the cylinder of its housing about the joint's axis."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from evodesign.body.placement import Placement, Scalar, Vector, cross, dot, scale, transpose
from evodesign.body.shape import Cylinder, Solid


class Mount(StrEnum):
    """How an actuator sits about its joint's axis: in the joint, or on one side of it."""

    INLINE = "inline"
    OFFSET = "offset"


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where the cylinder of an actuator lies about its joint's axis, in the link before the joint.

    Args:
        share: of its length, by which its middle lies along the axis: 0 in the joint, -0.5 or 0.5 for a
            cylinder that ends there.
        across: a vector across the axis, or nearly, in the joint's frame.
    """

    share: float
    across: Vector

    def housing(
        self, mass: Scalar, size: tuple[Scalar, Scalar], link_from_joint: Placement, axis: Vector
    ) -> Solid:
        """The cylinder of an actuator in the link that holds it, with exact derivatives.

        Args:
            mass: of the actuator [kg].
            size: diameter and length [m].
            link_from_joint: the joint's place in the link.
            axis: the joint's, a unit vector in its frame.
        """
        shape = Cylinder(size[0] / 2.0, size[1])
        first = cross(axis, self.across)
        first = scale(dot(first, first) ** -0.5, first)
        turn = transpose((first, cross(axis, first), axis))
        place = Placement(rotation=turn, translation=scale(self.share * size[1], axis))
        return Solid(shape, link_from_joint @ place, mass / shape.volume)
