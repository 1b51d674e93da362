"""Where an arm's elbow is, found by geometry: the names of a robot's joints do not say it.

With all joints at zero, r_j is the distance of the hand from the axis of joint j. Joints of a wrist have a
short r, joints that turn the forearm or the upper arm about itself one of almost none. The elbow is the first
joint above the hand whose r is at least `REACH` of the largest of the arm's joints. Its place is the point of
its axis that is nearest to the hand then, since files put a joint's origin anywhere on its axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from evodesign.body.placement import Vector, dot, scale
from evodesign.mechanics.agent import Agent, Contact
from evodesign.tree.model import Joint, JointKind, Tree

REACH = 0.45
"""Of the humanoids that tests look at, wrists have a share of at most 0.35 and elbows of at least 0.55."""

ORIGIN: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Elbow:
    """A point that moves with a link.

    Args:
        joint: that bends the arm there.
        link: the joint's child.
        place: in that link [m].
    """

    joint: str
    link: str
    place: Vector


def elbow(agent: Agent, holding: Contact) -> Elbow | None:
    """The elbow of an arm; None if no joint between the trunk and the hand turns.

    Args:
        agent: whose arm it is, with the unscaled tree: lengths do not change which joint bends the arm.
        holding: its contact with the load.
    """
    others = [hand.frame for hand in agent.hands if hand != holding]
    shared = {joint.name for other in others for joint in _above(agent.tree, other)}
    hand, found = ORIGIN, list[tuple[float, Elbow]]()
    for joint in _above(agent.tree, holding.frame):
        if joint.name in agent.joints and joint.name not in shared and joint.kind is not JointKind.PRISMATIC:
            place = scale(dot(joint.axis, hand), joint.axis)
            found.append((math.dist(hand, place), Elbow(joint.name, joint.child, place)))
        hand = joint.parent_from_child.apply(hand)
    longest = max((distance for distance, _ in found), default=0.0)
    return next((each for distance, each in found if distance >= REACH * longest > 0.0), None)


def _above(tree: Tree, link: str) -> Iterator[Joint]:
    """The joints from a link to the root."""
    while link != tree.root:
        joint = tree.parent_joint[link]
        yield joint
        link = joint.parent
