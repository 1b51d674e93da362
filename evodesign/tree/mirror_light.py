"""Frames and light bodies that fixed joints hold, so that they do not decide whether a robot is symmetric.

    mount    a fixed link that is lighter than counts and carries joints: what it carries hangs on the link
             that holds it, which moves nothing
    sensor   a fixed link that is lighter than counts, with nothing that moves beyond, and without a partner:
             half of its mass goes where it is, half to its mirror image on the other side, as in the mean of
             a robot and its image

Either happens only to a robot that has no mirror images otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement, scale
from evodesign.tree.frames import link_frames
from evodesign.tree.mirror_candidates import Unpaired
from evodesign.tree.mirror_images import Tolerance
from evodesign.tree.mirror_pairs import Mirror, Pairs, mirror_pairs
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree


def paired(tree: Tree, tolerance: Tolerance) -> tuple[Tree, Pairs, tuple[str, ...]]:
    """A tree of numbers with the same mechanics, its pairs, and the links whose mass was halved.

    Raises:
        Unpaired: a link has no mirror image within the tolerance.
    """
    try:
        return tree, mirror_pairs(tree, tolerance, strict=False), ()
    except Unpaired as unpaired:
        first = unpaired
    tree = _without_mounts(tree, tolerance.light)
    halved: dict[str, Inertia] = {}
    while True:
        try:
            pairs = mirror_pairs(tree, tolerance, strict=False)
            break
        except Unpaired as unpaired:
            name = unpaired.seen.link
            if name in halved or not _is_light(tree, name, tolerance.light):
                raise first from None
            halved[name] = tree.link_by_name[name].inertia
            tree = _with_link(tree, _seen_only(tree.link_by_name[name]))
    if halved:
        tree = _with_halves(tree, halved, pairs.mirror)
        pairs = mirror_pairs(tree, tolerance, strict=False)
    return tree, pairs, tuple(halved)


def half(inertia: Inertia) -> Inertia:
    """Half of the mass and of the tensor, in the same place."""
    rows = inertia.about_center
    return Inertia(
        inertia.mass / 2.0,
        inertia.center,
        (scale(0.5, rows[0]), scale(0.5, rows[1]), scale(0.5, rows[2])),
    )


def _without_mounts(tree: Tree, light: float) -> Tree:
    """The tree with joints that hang on mounts hung on what holds these."""
    joints: dict[str, Joint] = {}
    for joint in tree.joints:  # parents come before children
        above = joints.get(joint.parent)
        if above and above.kind is JointKind.FIXED and tree.link_by_name[joint.parent].inertia.mass < light:
            place = above.parent_from_child @ joint.parent_from_child
            joint = replace(joint, parent=above.parent, parent_from_child=place)
        joints[joint.child] = joint
    return replace(tree, joints=tuple(joints.values()))


def _is_light(tree: Tree, name: str, light: float) -> bool:
    """Whether a link is fixed, lighter than counts, and carries nothing."""
    joint = tree.parent_joint.get(name)
    fixed = joint is not None and joint.kind is JointKind.FIXED
    return fixed and not tree.child_joints[name] and 0.0 < tree.link_by_name[name].inertia.mass < light


def _seen_only(link: Link) -> Link:
    """The link without mass."""
    looks = (*(Look(solid.shape, solid.link_from_solid) for solid in link.solids), *link.looks)
    return replace(link, solids=(), own_inertia=Inertia(), looks=looks)


def _with_link(tree: Tree, link: Link) -> Tree:
    return replace(tree, links=tuple(link if each.name == link.name else each for each in tree.links))


def _with_halves(tree: Tree, halved: Mapping[str, Inertia], mirror: Mirror) -> Tree:
    """The tree with half of each inertia in its link, and the image of the other half in a new one."""
    frames = link_frames(tree, Placement(), {})
    for name, inertia in halved.items():
        tree = _with_link(tree, replace(tree.link_by_name[name], own_inertia=half(inertia)))
        image = f"{name}_image"
        while image in tree.link_by_name or f"{image}_fixed_joint" in tree.joint_by_name:
            image += "_"
        holder = mirror.links[tree.parent_joint[name].parent]
        place = frames[holder].inverse @ frames[name].mirrored()
        joint = Joint(f"{image}_fixed_joint", JointKind.FIXED, holder, image, place)
        other = Link(image, own_inertia=half(inertia.mirrored()))
        tree = replace(tree, links=(*tree.links, other), joints=(*tree.joints, joint))
    return tree
