"""What the bodies of the CAD files weigh against what the URDF says of the same links.

    link      = walls + filling + motors
    walls     = density times the integrals over the body that is written (mass, centre, inertia), with seats
    filling   = its mass less what seats add to the walls, spread evenly over what the outer surface encloses
    motors    = the mass of each, spread evenly over the ball that the mass model takes for it, or over the
                cylinder of its housing

Everything is integrated by Open CASCADE over bodies; the URDF has the closed forms of the mass model. With
balls both are the same model computed twice. With housings they differ in inertia as far as a cylinder
differs from a ball: by up to a third in a small link with a large motor. What several solids of a link share
counts twice in both, as such solids stay separate bodies in the files; `shared` says how much it is. The mass
model has no seats: bores lighten a link and flanges make it heavier, and its filling makes up for
both, as far as it lasts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.body.inertia import Inertia, total
from evodesign.report.cad import kernel
from evodesign.report.cad.parts import LinkPart, MotorPart, Parts
from evodesign.report.cad.seats import SeatedLink


@dataclass(frozen=True, slots=True)
class LinkAgreement:
    """A link as it is drawn and as the URDF has it.

    Args:
        volume: of the bodies that are written [m^3], of one without walls that of the full shape.
        walls, filling, motors: their masses [kg].
        seats: by how much bores and flanges change the mass of the walls [kg].
        body: mass, centre and inertia of the bodies that are written, in the link's frame.
        drawn: the same of the whole link, motors as balls.
        housed: likewise, motors as their housings.
        urdf: the same of the URDF.
        shared: share of the volume that lies in several bodies of the link and so counts twice.
    """

    volume: float
    walls: float
    filling: float
    motors: float
    seats: float
    body: Inertia
    drawn: Inertia
    housed: Inertia
    urdf: Inertia
    shared: float

    @property
    def mass_difference(self) -> float:
        """Mass of what is drawn, relative to the URDF's, less one."""
        return float(self.drawn.mass) / float(self.urdf.mass) - 1.0

    @property
    def center_difference(self) -> float:
        """Distance [m] between both centres of mass."""
        return float(np.linalg.norm(np.subtract(self.drawn.center, self.urdf.center)))

    @property
    def inertia_difference(self) -> float:
        """That of what is drawn, motors as balls, to the URDF's (`relative_difference`)."""
        return relative_difference(self.drawn, self.urdf)

    @property
    def housed_difference(self) -> float:
        """That of what is drawn, motors as their housings, to the URDF's (`relative_difference`)."""
        return relative_difference(self.housed, self.urdf)


def relative_difference(one: Inertia, other: Inertia) -> float:
    """Frobenius norm of the difference of two inertias, each about its centre, relative to the second's."""
    reference = np.array(other.about_center, float)
    return float(np.linalg.norm(np.array(one.about_center, float) - reference) / np.linalg.norm(reference))


def agreement_of(
    part: LinkPart, bodies: Sequence[kernel.Body], motors: tuple[MotorPart, ...]
) -> LinkAgreement:
    """How a link of the CAD files agrees with the URDF.

    Args:
        part: the link.
        bodies: of its solids, with seats.
        motors: that it holds.
    """
    solids = part.link.solids
    seats = [
        float(solid.density) * (kernel.volume(body) - kernel.volume(kernel.body_of(solid)))
        for body, solid in zip(bodies, solids, strict=True)
    ]
    walls = [kernel.inertia(body, float(each.density)) for body, each in zip(bodies, solids, strict=True)]
    left = [float(solid.filling) - seat for solid, seat in zip(solids, seats, strict=True)]
    filling = [
        _spread(kernel.outer_body(solid), mass)
        for solid, mass in zip(solids, left, strict=True)
        if mass > 0.0
    ]
    balls = [_spread(kernel.outer_body(solid), float(solid.mass)) for solid in part.link.mounted]
    housings = [_spread(kernel.outer_body(motor.solid), float(motor.actuator.mass)) for motor in motors]
    volume = sum(kernel.volume(body) for body in bodies)
    united = kernel.united_volume(bodies) if len(bodies) > 1 else volume
    return LinkAgreement(
        volume=volume,
        walls=_mass(walls),
        filling=_mass(filling),
        motors=_mass(housings),
        seats=sum(seats),
        body=total(walls),
        drawn=total([*walls, *filling, *balls]),
        housed=total([*walls, *filling, *housings]),
        urdf=part.link.inertia,
        shared=1.0 - united / volume,
    )


def agreements(parts: Parts, seated: Mapping[str, SeatedLink]) -> dict[str, LinkAgreement]:
    """How the links of the CAD files agree with the URDF, by link."""
    return {
        part.name: agreement_of(part, seated[part.name].bodies, parts.motors_of(part.name))
        for part in parts.links
    }


def _spread(body: kernel.Body, mass: float) -> Inertia:
    """A mass [kg] that fills a body evenly."""
    return kernel.inertia(body, mass / kernel.volume(body))


def _mass(inertias: list[Inertia]) -> float:
    return float(sum(each.mass for each in inertias))
