"""The symmetric robot nearest to one that is nearly symmetric: the mean of it and its mirror image.

    place, axis, frame    means in the root's frame with every joint at zero; a moving joint's origin may lie
                          elsewhere along its axis on the other side, and then meets it half way
    mass, m c, second     means: mass, centre of mass and inertia of the whole robot at zero positions are
    moments               exactly the means of its own and its image's
    solids                means of sizes and places where they correspond one to one; otherwise the link keeps
                          the mean inertia, and its shapes are only seen
    limits                what both sides allow
    effort, velocity      the smaller one

Everything is then expressed in the file's own frames: names and order stay, and a frame's orientation changes
by no more than the tolerance. Frames that are no mirror images keep their orientation, bare frames without a
partner their place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.body.inertia import total
from evodesign.body.placement import Placement, vector
from evodesign.body.shape import Solid
from evodesign.errors import ModelError, listed
from evodesign.tree.mirror_candidates import Unpaired
from evodesign.tree.mirror_images import ANGLE, MIRROR, Difference, Figure, Seen, near
from evodesign.tree.mirror_light import half, paired
from evodesign.tree.mirror_pairs import Pairs
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree
from evodesign.tree.solid_pairs import matrix, mean_rotation, mean_solids, turned_by

Array = NDArray[np.float64]

SAME = 1e-12
"""Numbers that averaging changes by less than this stay as in the file."""


ROUNDING = 1e-5
"""Differences of less than this share of what is allowed are not told: files round their numbers."""


@dataclass(frozen=True, slots=True)
class Averaged:
    """A symmetric tree, and how far from it the file's is.

    Args:
        tree: its own mirror image but for rounding.
        largest: the largest difference of each figure, those that come nearest to the tolerance first.
        weaker: pairs of joints whose effort limits differ, with both limits [N m or N].
        halved: light links without a partner, half of whose mass is on the other side (`mirror_light`).
    """

    tree: Tree
    largest: tuple[Difference, ...]
    weaker: tuple[tuple[str, str, float, float], ...]
    halved: tuple[str, ...] = ()

    def __str__(self) -> str:
        several = "difference is" if len(self.largest) == 1 else "differences are"
        largest = ", ".join(str(each) for each in self.largest)
        said = f"the largest {several} {largest}" if self.largest else "no figure differs"
        if self.weaker:
            one, other, effort, its = self.weaker[0]
            said += (
                f"; of different effort limits the smaller counts ({effort:g} and {its:g} of {one} / {other}"
            )
            said += f" and {len(self.weaker) - 1} more pairs)" if len(self.weaker) > 1 else ")"
        if self.halved:
            said += (
                f"; of light links without a partner half the mass is on either side: {listed(self.halved)}"
            )
        return said


def averaged(tree: Tree) -> Averaged:
    """The mean of a tree of numbers and its mirror image.

    Raises:
        ModelError: the two sides differ by more than the tolerance; says which pair, in what and by how much.
    """
    mass = sum(float(link.inertia.mass) for link in tree.links)
    try:
        tree, pairs, halved = paired(tree, near(mass))
    except Unpaired as unpaired:
        raise _refusal(tree, unpaired) from None
    beyond = sorted((each for each in pairs.differences if each.excess > 1.0), key=lambda each: -each.excess)
    if beyond:
        raise _too_large(tree, beyond[0], len(beyond) - 1)
    return Averaged(_mean_tree(tree, pairs), _largest(pairs), _weaker(tree, pairs), halved)


WANTED = "a mirror image in the plane y = 0"


def _refusal(tree: Tree, unpaired: Unpaired) -> ModelError:
    beyond = unpaired.beyond
    if beyond:
        return _too_large(tree, max(beyond, key=lambda each: each.excess), len(beyond) - 1)
    return ModelError(tree.name, unpaired.key, WANTED, unpaired.found)


def _too_large(tree: Tree, worst: Difference, more: int) -> ModelError:
    found = f"{worst} ({worst.allowed} allowed)"
    if more:
        found += f" and {more} more such difference{'s' if more > 1 else ''}"
    return ModelError(tree.name, f"{worst.noun} {worst.names[0]}", WANTED, found)


def _largest(pairs: Pairs) -> tuple[Difference, ...]:
    found: dict[Figure, Difference] = {}
    for each in pairs.differences:
        known = found.get(each.figure)
        if known is None or each.size > known.size + SAME:
            found[each.figure] = each
    return tuple(
        sorted((each for each in found.values() if each.excess > ROUNDING), key=lambda each: -each.excess)
    )


def _weaker(tree: Tree, pairs: Pairs) -> tuple[tuple[str, str, float, float], ...]:
    found = []
    for joint in tree.joints:
        other = tree.joint_by_name[pairs.mirror.joints[joint.name]]
        if joint.kind is not JointKind.FIXED and joint.effort != other.effort and joint.name < other.name:
            found.append((joint.name, other.name, joint.effort, other.effort))
    return tuple(found)


def _mean_tree(tree: Tree, pairs: Pairs) -> Tree:
    frames = {name: _mean_frame(pairs, name) for name in pairs.seen}
    links: dict[str, Link] = {}
    for link in tree.links:
        if link.name not in links:
            other = tree.link_by_name[pairs.mirror.links[link.name]]
            links |= {each.name: each for each in _mean_links(link, other, pairs.seen, frames)}
    joints = tuple(_mean_joint(joint, tree, pairs, frames) for joint in tree.joints)
    return replace(tree, links=tuple(links[link.name] for link in tree.links), joints=joints)


def _mean_frame(pairs: Pairs, name: str) -> Placement:
    """The place of a link in the root's frame; a frame that is turned otherwise keeps its orientation."""
    mine, its = pairs.seen[name], pairs.seen[pairs.mirror.links[name]]
    if name in pairs.mirror.loose:
        return mine.frame
    place = (mine.place + MIRROR * its.place) / 2.0
    rotation: Array = np.array(mine.frame.rotation)
    image: Array = np.array(its.frame.mirrored().rotation)
    if SAME < turned_by(rotation, image) <= ANGLE:
        rotation = mean_rotation(rotation, image)
    return Placement(matrix(rotation), vector(place))


def _kept(new: Placement, old: Placement) -> Placement:
    """The file's numbers where averaging did not change them."""
    turn: Array = np.array(new.rotation) - np.array(old.rotation)
    same_rotation = bool(np.abs(turn).max() <= SAME)
    steps = zip(new.translation, old.translation, strict=True)
    x, y, z = (b if abs(a - b) <= SAME else 0.0 if abs(a) <= SAME else a for a, b in steps)
    return Placement(old.rotation if same_rotation else new.rotation, (x, y, z))


def _mean_links(
    link: Link, other: Link, seen: Mapping[str, Seen], frames: Mapping[str, Placement]
) -> tuple[Link, Link]:
    """Both links of a pair, or one of the middle line twice."""
    middle = link.name == other.name
    both = None
    if link.solids and other.solids:
        mine, its = (
            [replace(s, link_from_solid=seen[each.name].frame @ s.link_from_solid) for s in each.solids]
            for each in (link, other)
        )
        both = mean_solids(mine, its, middle=middle)
    if both is not None:
        one, image = (
            replace(_seen_in_place(each, seen, frames), solids=_back(solids, each, frames))
            for each, solids in zip((link, other), both, strict=True)
        )
        return one, image
    one, image = (_kept_inertia(each, its, seen, frames) for each, its in ((link, other), (other, link)))
    return one, image


def _back(solids: list[Solid], link: Link, frames: Mapping[str, Placement]) -> tuple[Solid, ...]:
    """Solids of the root's frame in their link's."""
    link_from_root, found = frames[link.name].inverse, []
    for solid, old in zip(solids, link.solids, strict=True):
        place = _kept(link_from_root @ solid.link_from_solid, old.link_from_solid)
        found.append(replace(solid, link_from_solid=place))
    return tuple(found)


def _seen_in_place(link: Link, seen: Mapping[str, Seen], frames: Mapping[str, Placement]) -> Link:
    """What is seen of a link stays where it is, also where its frame moved along the joint's axis."""
    new_from_old = frames[link.name].inverse @ seen[link.name].frame

    def in_place(place: Placement) -> Placement:
        return _kept(new_from_old @ place, place)

    looks = (replace(look, link_from_look=in_place(look.link_from_look)) for look in link.looks)
    meshes = (replace(mesh, link_from_mesh=in_place(mesh.link_from_mesh)) for mesh in link.meshes)
    return replace(link, looks=tuple(looks), meshes=tuple(meshes))


def _kept_inertia(link: Link, other: Link, seen: Mapping[str, Seen], frames: Mapping[str, Placement]) -> Link:
    """A link with the mean inertia of its own and its partner's image; its solids are only seen then."""
    halves = [half(seen[link.name].inertia), half(seen[other.name].inertia.mirrored())]
    inertia = total(halves).moved(frames[link.name].inverse)
    seen_only = tuple(Look(solid.shape, solid.link_from_solid) for solid in link.solids)
    shown = replace(link, solids=(), looks=(*seen_only, *link.looks))
    return replace(_seen_in_place(shown, seen, frames), own_inertia=inertia)


def _mean_joint(joint: Joint, tree: Tree, pairs: Pairs, frames: Mapping[str, Placement]) -> Joint:
    other = tree.joint_by_name[pairs.mirror.joints[joint.name]]
    place = frames[joint.parent].inverse @ frames[joint.child]
    kept = _kept(place, joint.parent_from_child)
    if joint.kind is JointKind.FIXED:
        return replace(joint, parent_from_child=kept)
    sign = pairs.mirror.signs[joint.name]
    its = (other.lower, other.upper) if sign > 0.0 else (-other.upper, -other.lower)
    lower, upper = max(joint.lower, its[0]), min(joint.upper, its[1])
    if lower > upper:  # ranges narrower than the tolerance, beside each other
        lower = upper = (lower + upper) / 2.0
    axis = _mean_axis(pairs.seen[joint.child], pairs.seen[other.child])
    own = np.array(frames[joint.child].rotation).T @ axis
    return replace(
        joint,
        parent_from_child=kept,
        axis=joint.axis if np.abs(own - np.array(joint.axis)).max() <= SAME else vector(own),
        lower=lower,
        upper=upper,
        effort=min(joint.effort, other.effort),
        velocity=min(joint.velocity, other.velocity),
    )


def _mean_axis(mine: Seen, its: Seen) -> Array:
    """Mean direction of an axis and its partner's image, in the root's frame; the image may point back."""
    image = MIRROR * its.axis
    mean = mine.axis + (image if mine.axis @ image > 0.0 else -image)
    unit: Array = mean / np.linalg.norm(mean)
    return unit
