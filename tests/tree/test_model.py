"""A tree is one root, no loops, unique names, parents before children."""

from __future__ import annotations

import pytest

from evodesign.body.placement import Placement
from evodesign.errors import ModelError
from evodesign.tree.model import Joint, JointKind, Link, Tree


def joint(name: str, parent: str, child: str) -> Joint:
    return Joint(name, JointKind.FIXED, parent, child, Placement())


def tree(links: str, *joints: Joint) -> Tree:
    return Tree("t", tuple(Link(name) for name in links), joints)


def test_joints_are_sorted_parents_first() -> None:
    sorted_tree = tree("cba", joint("bc", "b", "c"), joint("ab", "a", "b"))
    assert [j.name for j in sorted_tree.joints] == ["ab", "bc"]
    assert sorted_tree.root == "a"


@pytest.mark.parametrize(
    ("links", "joints", "words"),
    [
        ("aab", (joint("ab", "a", "b"),), "link a: wanted a unique name"),
        ("abc", (joint("ab", "a", "b"), joint("ab", "a", "c")), "joint ab: wanted a unique name"),
        ("abc", (joint("ab", "a", "b"),), "one root link that no joint holds, found 2: a, c"),
        ("ab", (joint("ab", "a", "b"), joint("ba", "b", "a")), "one root link .*, found none"),
        ("abc", (joint("bc", "b", "c"), joint("cb", "c", "b")), "without loops, found a loop"),
        ("abc", (joint("ac", "a", "c"), joint("ab", "a", "b"), joint("bc", "b", "c")), "one parent joint"),
        ("ab", (joint("ab", "a", "x"),), "joint ab.child: wanted the name of a link"),
    ],
)
def test_what_is_not_a_tree_is_refused(links: str, joints: tuple[Joint, ...], words: str) -> None:
    with pytest.raises(ModelError, match=words):
        tree(links, *joints)
