"""Mirror symmetry of a tree in the plane y = 0 of its root.

A tree is symmetric when all its figures, in the root's frame with every joint at zero, are their own mirror
image (`mirror_images` has the formulas): each joint and link has a partner, or is its own on the middle line.
The links' own frames may be turned in any way. A joint of the middle line with sign -1 (a roll or a yaw) is
zero in every symmetric posture.
"""

from __future__ import annotations

from evodesign.errors import ModelError
from evodesign.tree.mirror_candidates import Unpaired
from evodesign.tree.mirror_images import EXACT, Figure
from evodesign.tree.mirror_pairs import Mirror, mirror_pairs
from evodesign.tree.model import Tree
from evodesign.tree.once_per_tree import once_per_tree

OF_A_LINK = frozenset({Figure.MASS, Figure.CENTER, Figure.INERTIA})


@once_per_tree
def mirror_of(tree: Tree) -> Mirror:
    """The mirror symmetry of a tree of numbers that is exact but for rounding.

    Raises:
        ModelError: naming a link that has no mirror partner, with the one that comes nearest.
    """
    try:
        return mirror_pairs(tree, EXACT).mirror
    except Unpaired as unpaired:
        raise _refusal(tree, unpaired) from None


def _refusal(tree: Tree, unpaired: Unpaired) -> ModelError:
    one, other, beyond = unpaired.seen, unpaired.nearest, unpaired.beyond
    if other is not None and beyond and all(each.figure in OF_A_LINK for each in beyond):
        found = f"'{other.link}', whose mass or shape differs"
        if other.link == one.link:
            found = "a mass or shape that is not symmetric"
        return ModelError(tree.name, f"link {one.link}", "a mirror image in the plane y = 0", found)
    return ModelError(tree.name, unpaired.key, "a mirror image in the plane y = 0", unpaired.found)


def left_half(tree: Tree, mirror: Mirror) -> tuple[Tree, frozenset[str]]:
    """The middle line and the left branches of a symmetric tree, which may hold expressions.

    Returns:
        The smaller tree, and the joints at which its left branches begin: each stands for a right one too.
    """
    kept = {tree.root}
    begins = set()
    for joint in tree.joints:
        if joint.parent not in kept:
            continue
        begins_here = mirror.is_middle(joint.parent) and not mirror.is_middle(joint.child)
        if begins_here and joint.child not in mirror.left:
            continue
        kept.add(joint.child)
        if begins_here:
            begins.add(joint.name)
    links = tuple(link for link in tree.links if link.name in kept)
    joints = tuple(joint for joint in tree.joints if joint.child in kept)
    return Tree(tree.name, links, joints), frozenset(begins)
