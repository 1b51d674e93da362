"""Ranges of knees and elbows that stay bent: straight legs hold any load, and cannot be controlled.

A limb's bend is its joint that is farthest from both ends. Its flexion is the angle, about its axis, from the
segment above to the segment below, so that it is zero where the limb is straight and its Jacobian loses rank;
it grows towards the side to which the joint turns farther.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.mechanics.agent import Agent, Contact
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Joint, JointKind

Array = NDArray[np.float64]

PARALLEL = 0.9
"""Least cosine of the angle between two axes that bend a limb in one plane."""

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class _Hinge:
    """A joint of the unscaled robot at its zero posture, in the root's frame [m]."""

    joint: Joint
    origin: Array
    axis: Array


def bent_ranges(
    agent: Agent, ends: Iterable[Contact], flexion: float, key: str, source: ProblemSource
) -> Mapping[str, Range]:
    """The ranges of the joints that bend limbs, with a least flexion, by joint [rad].

    Args:
        agent: unscaled.
        ends: contacts at the limbs' ends.
        flexion: least [rad].
        key: that asks for it, for messages.
        source: the problem, likewise.
    Raises:
        InputError: a limb has no joint that bends it so far, or one without limits.
    """
    frames = link_frames(agent.tree, Placement(), {})
    places = {name: np.array(frame.translation, float) for name, frame in frames.items()}
    frame_of = {end.side: end.frame for end in ends}
    chains = {side: _chain(agent, end) for side, end in frame_of.items()}
    shared = set.intersection(*({joint.name for joint in chain} for chain in chains.values()))
    found: dict[str, Range] = {}
    for side, chain in chains.items():
        hinges = [
            _Hinge(joint, places[joint.child], np.array(frames[joint.child].rotation, float) @ joint.axis)
            for joint in chain
            if joint.name not in shared
        ]
        if not hinges:  # both ends are of one limb, which `check` names
            continue
        bend = _bend(hinges, places[frame_of[side]])
        wanted = f"at most what the {side} limb above '{frame_of[side]}' bends"
        if bend is None:
            raise InputError(source.path, key, wanted, "a limb without a joint between its ends")
        joint = hinges[bend].joint
        if not math.isfinite(joint.upper - joint.lower):
            wanted = f"limits of '{joint.name}', which say to which side it bends"
            raise InputError(source.path, key, wanted, "a joint without limits")
        own = _bent(hinges, bend, places[frame_of[side]], flexion)
        if own is None:
            degrees = [f"{math.degrees(limit):g}" for limit in (joint.lower, joint.upper)]
            found_range = f"{math.degrees(flexion):g}, and '{joint.name}' from {' to '.join(degrees)} deg"
            raise InputError(source.path, key, wanted, found_range)
        found[joint.name] = own
    return found


def _chain(agent: Agent, end: str) -> list[Joint]:
    """The hinges that move above a frame, from the root outwards."""
    above = [agent.tree.parent_joint[name] for name in agent.tree.to_root(end)[:-1]]
    moving = [each for each in above if each.name in agent.joints and each.kind is not JointKind.PRISMATIC]
    return moving[::-1]


def _bend(hinges: Sequence[_Hinge], end: Array) -> int | None:
    """Index of the hinge that is farthest from both ends of a limb."""
    inner = range(1, len(hinges))

    def within(place: int) -> float:
        here = hinges[place].origin
        return float(min(np.linalg.norm(here - hinges[0].origin), np.linalg.norm(here - end)))

    return max(inner, key=within, default=None)


def _bent(hinges: Sequence[_Hinge], bend: int, end: Array, flexion: float) -> Range | None:
    """The range of a hinge that keeps a least flexion; None where nothing is left of it."""
    own = hinges[bend]
    above = max(hinges[:bend], key=lambda each: abs(float(each.axis @ own.axis)))
    below = next((each.origin for each in hinges[bend + 1 :] if abs(each.axis @ own.axis) > PARALLEL), end)
    first, second = own.origin - above.origin, below - own.origin
    at_zero = math.atan2(float(own.axis @ np.cross(first, second)), _in_plane(first, second, own.axis))
    straight, (lower, upper) = -at_zero, (own.joint.lower, own.joint.upper)
    if upper - straight >= straight - lower:
        lower = max(lower, straight + flexion)
    else:
        upper = min(upper, straight - flexion)
    return (lower, upper) if lower < upper else None


def _in_plane(first: Array, second: Array, axis: Array) -> float:
    """Dot product of two vectors' parts across an axis."""
    return float(first @ second - (axis @ first) * (axis @ second))
