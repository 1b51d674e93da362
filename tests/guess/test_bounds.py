"""How short and how long `init` lets links get: until bodies near each other would overlap."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import coal
import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Solid
from evodesign.guess.parameters import LOWER, STEP, UPPER, length_bounds
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.resize import resize
from tests.guess.humanoid import Build, humanoid


def stack(gap: float, *, near: bool = True) -> Tree:
    """A slab, a thin rod of 0.5 m below it, and beside its end a block so far below the slab [m].

    Between slab and block there are two joints, or four where they are not to be near.
    """
    links = [
        Link("slab", solids=(Solid(Box(1.0, 1.0, 0.1), Placement(translation=(0.0, 0.0, 0.05)), 500.0),)),
        Link("rod", solids=(Solid(Box(0.02, 0.02, 0.5), Placement(translation=(0.0, 0.0, -0.25)), 500.0),)),
    ]
    joints = [joint("slide", "slab", "rod", (0.0, 0.0, 0.0))]
    names = ["block"] if near else ["one", "two", "block"]
    for parent, child in zip(["rod", *names[:-1]], names, strict=True):
        links.append(Link(child))
        at = (0.0, 0.0, -0.5) if parent == "rod" else (0.0, 0.0, 0.0)
        joints.append(joint(f"to_{child}", parent, child, at))
    height = 0.5 - gap
    links[-1] = Link(
        "block",
        solids=(Solid(Box(0.1, 0.1, height), Placement(translation=(0.2, 0.0, height / 2.0)), 500.0),),
    )
    return Tree("stack", tuple(links), tuple(joints))


def joint(name: str, parent: str, child: str, at: tuple[float, float, float]) -> Joint:
    return Joint(
        name, JointKind.REVOLUTE, parent, child, Placement(translation=at), (0.0, 1.0, 0.0), -1.0, 1.0
    )


def test_a_rod_gets_no_shorter_than_what_hangs_on_it_leaves_room_for() -> None:
    """The block ends 0.1 m below the slab; a rod of m times 0.5 m lifts it by (1 - m) 0.5 m: m >= 0.8."""
    lower, upper = length_bounds(stack(0.102), ["rod"])
    assert (lower.multiplier, lower.overlap) == (0.8, ("slab", "block"))
    assert (upper.multiplier, upper.overlap) == (UPPER, None)


def test_bodies_with_many_joints_between_them_are_left_to_the_posture() -> None:
    assert [bound.multiplier for bound in length_bounds(stack(0.102, near=False), ["rod"])] == [LOWER, UPPER]


def test_what_overlaps_in_the_robot_as_it_is_bounds_nothing() -> None:
    assert [bound.overlap for bound in length_bounds(stack(-0.05), ["rod"])] == [None, None]


def test_no_links_and_no_shapes_have_the_farthest_bounds() -> None:
    assert [bound.multiplier for bound in length_bounds(stack(0.1), [])] == [LOWER, UPPER]
    tree = stack(0.1)
    shapeless = (replace(link, solids=(), own_inertia=link.inertia) for link in tree.links if link.solids)
    others = (link for link in tree.links if not link.solids)
    bare = Tree(tree.name, (*shapeless, *others), tree.joints)
    assert [bound.multiplier for bound in length_bounds(bare, ["rod"])] == [LOWER, UPPER]


@pytest.mark.parametrize("names", [("chest",), ("left_upper_arm", "right_upper_arm")])
def test_within_the_bounds_coal_finds_no_new_overlap_of_bodies_near_each_other(
    names: tuple[str, ...],
) -> None:
    tree = humanoid(Build())
    lower, upper = (bound.multiplier for bound in length_bounds(tree, names))
    before = overlapping(tree)
    for multiplier in np.arange(lower, upper + STEP / 2.0, STEP):
        assert overlapping(resize(tree, dict.fromkeys(names, float(multiplier)), {})) <= before


def overlapping(tree: Tree) -> set[frozenset[str]]:
    """Pairs of links at most three joints from each other whose boxes overlap by 3 mm, by coal itself."""
    frames, found = link_frames(tree, Placement(), {}), set()
    for one, other in combinations([link for link in tree.links if link.solids], 2):
        ways = [set(tree.to_root(link.name)) for link in (one, other)]
        if len(ways[0] ^ ways[1]) not in (2, 3):
            continue
        boxes = []
        for link in (one, other):
            place = frames[link.name] @ link.solids[0].link_from_solid
            where = coal.Transform3s(np.array(place.rotation, float), np.array(place.translation, float))
            boxes += [coal.Box(*map(float, link.solids[0].shape.sides)), where]
        if coal.distance(*boxes, coal.DistanceRequest(), coal.DistanceResult()) < -0.003:
            found.add(frozenset((one.name, other.name)))
    return found
