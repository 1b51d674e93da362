"""What bodies are asked to be apart where the robot's build leaves them less."""

from __future__ import annotations

from itertools import pairwise

import pytest

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Sphere
from evodesign.collision.margins import narrow_margins
from evodesign.collision.rules import CollisionRules
from evodesign.tree.model import Joint, JointKind, Link, Look, Tree


def chain(*places: float) -> Tree:
    """Balls of 0.1 m along x, each on a joint of the one before."""
    names = [f"ball {number}" for number in range(len(places))]
    links = [Link(n, own_inertia=Inertia(1.0), looks=(Look(Sphere(0.1), Placement()),)) for n in names]
    steps = [place - before for before, place in pairwise(places)]
    joints = [
        Joint(
            f"joint {number}",
            JointKind.REVOLUTE,
            names[number],
            names[number + 1],
            Placement(translation=(step, 0.0, 0.0)),
            (0.0, 0.0, 1.0),
            -1.0,
            1.0,
        )
        for number, step in enumerate(steps)
    ]
    return Tree("chain", tuple(links), tuple(joints))


def test_what_is_built_nearer_than_the_margin_keeps_what_it_has() -> None:
    tree = chain(0.0, 0.1, 0.202, 0.5, 0.69)
    pairs = [("ball 0", "ball 2"), ("ball 0", "ball 3"), ("ball 2", "ball 3"), ("ball 3", "ball 4")]
    narrow = narrow_margins(tree, pairs, 0.005)
    assert narrow == {("ball 0", "ball 2"): pytest.approx(0.202 - 0.2, abs=1e-6)}
    rules = CollisionRules(0.005, tuple(pairs), narrow=narrow)
    assert rules.margin_of(("ball 2", "ball 0")) == pytest.approx(0.002, abs=1e-6)
    assert rules.margin_of(("ball 0", "ball 3")) == 0.005
    assert rules.margin_of(("ball 3", "ball 4")) == 0.005  # in each other at zero, as arms beside hips are
