"""Which parts take the same place at joint angles of zero: what a workshop has to cut out, or make room for.

The mass model lets motors pass through the link after their joint, and a motor without a seat through that
before it, and the solids of neighbouring links through each other. The files show all as they are.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from evodesign.report.cad import kernel
from evodesign.report.cad.parts import Parts
from evodesign.report.cad.seats import SeatedLink

LEAST_VOLUME = 1e-9
"""Parts that share less [m^3] touch at most."""


@dataclass(frozen=True, slots=True)
class Clash:
    """What a part has in common with a link.

    Args:
        part: a motor, or the child link of a joint.
        link: that it passes through.
        volume: that both take [m^3]; of a motor the walls that it cuts, of links what their outer shapes
            share.
    """

    part: str
    link: str
    volume: float


def motor_clashes(parts: Parts, seated: Mapping[str, SeatedLink]) -> Iterator[Clash]:
    """The motors that cut through bodies of the links on both sides of their joint."""
    for motor in parts.motors:
        sides = {motor.joint.parent: motor.link_from_motor, motor.joint.child: motor.child_from_motor}
        for name, link_from_motor in sides.items():
            if name in seated:
                housing = kernel.placed(kernel.solid_body(motor.solid.shape, None), link_from_motor)
                shared = (kernel.shared_volume(housing, body) for body in seated[name].bodies)
                yield from _clash(motor.name, name, sum(shared))


def neighbour_clashes(parts: Parts) -> Iterator[Clash]:
    """The links of a joint whose outer shapes pass through each other."""
    links = {part.name: part for part in parts.links}
    for joint in parts.tree.joints:
        if joint.parent not in links or joint.child not in links:
            continue
        above = [kernel.outer_body(solid) for solid in links[joint.parent].link.solids]
        below = [
            kernel.placed(kernel.outer_body(solid), joint.parent_from_child)
            for solid in links[joint.child].link.solids
        ]
        volume = sum(kernel.shared_volume(one, other) for one in below for other in above)
        yield from _clash(joint.child, joint.parent, volume)


def _clash(part: str, link: str, volume: float) -> Iterator[Clash]:
    if volume > LEAST_VOLUME:
        yield Clash(part, link, volume)
