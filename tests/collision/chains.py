"""Trees of few links for tests of distances."""

from __future__ import annotations

from evodesign.body.placement import Placement
from evodesign.tree.model import Joint, JointKind, Link, Tree


def two_links(one: Link, other: Link, place: Placement | None = None) -> Tree:
    """Two links with a link without solids between them, on joints about y and z."""
    middle = Link("middle")
    joints = tuple(
        Joint(f"to {child.name}", JointKind.REVOLUTE, parent.name, child.name, at, axis, -1.5, 1.5)
        for parent, child, at, axis in (
            (one, middle, place or Placement(), (0.0, 1.0, 0.0)),
            (middle, other, Placement(), (0.0, 0.0, 1.0)),
        )
    )
    return Tree("two", (one, middle, other), joints)
