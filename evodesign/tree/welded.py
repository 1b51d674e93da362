"""Rigid bodies of a tree: links that fixed joints weld together, and their places with all joints at zero."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from evodesign.body.inertia import Inertia, total
from evodesign.body.placement import Placement, Vector
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Tree


@dataclass(frozen=True, slots=True)
class WeldedBody:
    """Links that do not move against each other.

    Args:
        links: their names, the one that the joint moves first.
        joint: that moves them; None for the root's.
        inertia: of all of them, in the root's frame with all joints at zero.
        origin: of the joint, likewise [m].
    """

    links: tuple[str, ...]
    joint: Joint | None
    inertia: Inertia
    origin: Vector

    @property
    def name(self) -> str:
        """Name of its first link."""
        return self.links[0]


def without_frames(tree: Tree, kept: Collection[str]) -> Tree:
    """The tree without the links that neither have nor carry a mass, but for those of some names."""
    needed = {name for name in kept if name in tree.link_by_name} | {tree.root}
    for joint in reversed(tree.joints):  # children come after their parents
        if joint.child in needed or tree.link_by_name[joint.child].inertia.mass:
            needed |= {joint.child, joint.parent}
    links = tuple(link for link in tree.links if link.name in needed)
    return replace(tree, links=links, joints=tuple(each for each in tree.joints if each.child in needed))


class WeldedTree:
    """The rigid bodies of a tree of numbers; those that neither have nor carry a mass are left out.

    Args:
        tree: whose joints are all at zero.
    """

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.places = link_frames(tree, Placement(), {})
        owner, links = {tree.root: tree.root}, {tree.root: [tree.root]}
        joints: dict[str, Joint] = {}
        for joint in tree.joints:
            if joint.kind is JointKind.FIXED:
                owner[joint.child] = owner[joint.parent]
                links[owner[joint.child]].append(joint.child)
            else:
                owner[joint.child], links[joint.child], joints[joint.child] = (
                    joint.child,
                    [joint.child],
                    joint,
                )
        self._owner = owner
        self.bodies = {name: self._body(tuple(names), joints.get(name)) for name, names in links.items()}
        self._drop_frames()

    def _drop_frames(self) -> None:
        """Leave out the bodies that neither have nor carry a mass."""
        carried = {name: float(body.inertia.mass) for name, body in self.bodies.items()}
        for name, body in reversed([*self.bodies.items()]):  # children come after their parents
            if body.joint is not None:
                carried[self._owner[body.joint.parent]] += carried[name]
        self.bodies = {
            name: self.bodies[name] for name in self.bodies if carried[name] or name == self.tree.root
        }

    def _body(self, links: tuple[str, ...], joint: Joint | None) -> WeldedBody:
        parts = [self.tree.link_by_name[name].inertia.moved(self.places[name]) for name in links]
        inertia = total([part for part in parts if part.mass])
        return WeldedBody(links, joint, inertia, self.places[links[0]].translation)

    def heaviest(self, links: Iterable[str]) -> str:
        """Name of the heaviest of some links."""
        return max(links, key=lambda name: float(self.tree.link_by_name[name].inertia.mass))

    @cached_property
    def children(self) -> dict[str, tuple[str, ...]]:
        """Names of the bodies that each body carries."""
        found: dict[str, list[str]] = {name: [] for name in self.bodies}
        for name, body in self.bodies.items():
            if body.joint is not None:
                found[self._owner[body.joint.parent]].append(name)
        return {name: tuple(names) for name, names in found.items()}

    def body_of(self, link: str) -> WeldedBody:
        """The body that a link is part of."""
        return self.bodies[self._owner[link]]

    def chain(self, name: str) -> tuple[WeldedBody, ...]:
        """The bodies from the one after the root's to this one."""
        bodies = []
        body = self.bodies[name]
        while body.joint is not None:
            bodies.append(body)
            body = self.body_of(body.joint.parent)
        return tuple(reversed(bodies))

    def beyond(self, name: str) -> Iterator[WeldedBody]:
        """A body and all that it carries."""
        yield self.bodies[name]
        for child in self.children[name]:
            yield from self.beyond(child)
