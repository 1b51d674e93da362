"""pinocchio as an independent reader of URDF, with a free-flyer base."""

from __future__ import annotations

import pinocchio

from evodesign.body.inertia import Inertia, total
from evodesign.body.placement import Placement
from evodesign.tree.model import JointKind, Tree

ROOT_JOINT = "root_joint"
"""pinocchio's name of the free-flyer."""


def floating_model(urdf: str) -> pinocchio.Model:
    """pinocchio's model of a URDF text, floating in space."""
    return pinocchio.buildModelFromXML(urdf, pinocchio.JointModelFreeFlyer())


def carriers(tree: Tree) -> dict[str, tuple[str, Placement]]:
    """For each link, the moving joint that carries it and its place in that joint's child frame.

    pinocchio knows moving joints only; what is welded to a link is part of it.
    """
    found = {tree.root: (ROOT_JOINT, Placement())}
    for joint in tree.joints:
        carrier, carrier_from_parent = found[joint.parent]
        if joint.kind is JointKind.FIXED:
            found[joint.child] = (carrier, carrier_from_parent @ joint.parent_from_child)
        else:
            found[joint.child] = (joint.name, Placement())
    return found


def carried_inertia(tree: Tree) -> dict[str, Inertia]:
    """For each moving joint (and the base), the inertia of all links that it carries, in its child frame."""
    parts: dict[str, list[Inertia]] = {}
    for link, (carrier, carrier_from_link) in carriers(tree).items():
        parts.setdefault(carrier, []).append(tree.link_by_name[link].inertia.moved(carrier_from_link))
    return {carrier: total(inertias) for carrier, inertias in parts.items()}
