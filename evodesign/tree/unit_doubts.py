"""Figures of a robot that seem to be in another unit than URDF's: degrees, millimetres, grams.

    angle     a turning joint's limit beyond two turns, unless it stands for none; or no joint of several that
              turns by more than 11 degrees, as where MJCF gives radians without saying so
    length    a joint's origin, a centre of mass, a shape or a mesh further or longer than 10 m
    inertia   a radius of gyration beyond 2 m, sqrt(I / m) for the largest entry I of the tensor's diagonal
    size      a link of more than 10 g whose shapes or meshes all span less than 2 mm
    mass      a link of more than 500 kg

Nothing is changed: the sentences ask.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from evodesign.body.inertia import Inertia
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.errors import listed
from evodesign.tree.mesh_write import vertices_of
from evodesign.tree.model import Joint, JointKind, Link, Mesh

FURTHEST, NO_LIMIT = 4.0 * math.pi * 1.01, 3600.0
"""A limit beyond two turns [rad], and one that stands for none."""
NARROW, SEVERAL = 0.2, 4
"""A narrow range [rad], and how many joints do not all have one."""
LONGEST, SHORTEST, WIDEST = 10.0, 0.002, 2.0
"""Of a part of a robot that can hold a load with a person, and its radius of gyration [m]."""
HEAVIEST, LIGHTEST = 500.0, 0.01
"""Masses of a link [kg] that seem to be grams, and that are more than a speck's."""


def unit_doubts(links: Iterable[Link], joints: Iterable[Joint]) -> Iterator[str]:
    """Sentences on limits, origins, shapes and masses.

    Args:
        links: of numbers.
        joints: likewise.
    """
    joints, links = tuple(joints), tuple(links)
    yield from _angles([joint for joint in joints if joint.kind is JointKind.REVOLUTE])
    apart = {joint.name: math.hypot(*joint.parent_from_child.translation) for joint in joints}
    yield from _long("joints", apart)
    heavy = [link for link in links if link.mass > 0.0]
    yield from _long("centres of mass", {link.name: math.hypot(*link.inertia.center) for link in heavy})
    wide = [f"{link.name} ({span:.3g} m)" for link in heavy if (span := _gyration(link.inertia)) > WIDEST]
    if wide:
        yield f"radii of gyration of more than {WIDEST:g} m, which look like kg mm^2: {listed(wide)}"
    spans = {
        link.name: [*(_span(each.shape) for each in link.solids), *(_span(each.shape) for each in link.looks)]
        for link in links
    }
    yield from _long("links with shapes", {name: max(each, default=0.0) for name, each in spans.items()})
    yield from _short((link, spans[link.name]) for link in links if not link.meshes)
    too_heavy = [f"{link.name} ({link.mass:g} kg)" for link in heavy if link.mass > HEAVIEST]
    if too_heavy:
        yield f"links heavier than {HEAVIEST:g} kg, which look like grams: {listed(too_heavy)}"


def _angles(turning: Sequence[Joint]) -> Iterator[str]:
    far = [joint for joint in turning if FURTHEST < max(-joint.lower, joint.upper) <= NO_LIMIT]
    if far:
        given = [f"{joint.name} ({joint.lower:g} to {joint.upper:g} rad)" for joint in far]
        yield f"limits beyond two turns, which look like degrees: {listed(given)}"
    widest = max((joint.upper - joint.lower for joint in turning), default=0.0)
    if len(turning) >= SEVERAL and 0.0 < widest < NARROW:
        yield (
            f"no joint turns by more than {math.degrees(widest):.2g} degrees: were radians read as degrees "
            '(MJCF: <compiler angle="radian"/>)?'
        )


def mesh_doubts(links: Iterable[Link]) -> Iterator[str]:
    """Sentences on links whose meshes are far too long or too short, as far as their triangles are known."""
    known = [link for link in links if link.shown]
    spans = {link.name: [_mesh_span(mesh) for mesh in link.shown] for link in known}
    yield from _long("links with meshes", {name: max(each) for name, each in spans.items()})
    yield from _short((link, spans[link.name]) for link in known)


def _gyration(inertia: Inertia) -> float:
    """About the one of the link's axes about which it is the largest [m]."""
    return math.sqrt(max(0.0, *(inertia.about_center[i][i] for i in range(3))) / inertia.mass)


def _long(nouns: str, spans: dict[str, float]) -> Iterator[str]:
    long = [f"{name} ({span:.4g} m)" for name, span in spans.items() if span > LONGEST]
    if long:
        yield f"{nouns} of more than {LONGEST:g} m, which look like millimetres: {listed(long)}"


def _short(spans: Iterable[tuple[Link, Sequence[float]]]) -> Iterator[str]:
    short = [
        f"{link.name} ({1e3 * max(each):.2g} mm, {link.mass:.3g} kg)"
        for link, each in spans
        if each and max(each) < SHORTEST and link.mass > LIGHTEST
    ]
    if short:
        yield f"links of less than {1e3 * SHORTEST:g} mm, which look as if scaled twice: {listed(short)}"


def _mesh_span(mesh: Mesh) -> float:
    vertices = vertices_of(mesh)
    return float((vertices.max(axis=0) - vertices.min(axis=0)).max())


def _span(shape: Shape) -> float:
    match shape:
        case Sphere(radius):
            return 2.0 * float(radius)
        case Cylinder(radius, length):
            return max(2.0 * float(radius), float(length))
        case Box():
            return float(max(shape.sides))
