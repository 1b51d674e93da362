"""What is shown where there is no space for all: points evenly, joints by their largest torque."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

T = TypeVar("T")


def subsample(items: Sequence[T], most: int) -> list[T]:
    """At most so many of the items, in order, evenly over the whole: item i of n is floor(i len / n)."""
    if len(items) <= most:
        return list(items)
    return [items[i * len(items) // most] for i in range(most)]


def ranked_joints(torques: Sequence[Mapping[str, float]]) -> list[str]:
    """All joints, those with the largest torque in any posture first.

    Args:
        torques: of each posture [N m], by joint.
    """
    peaks: dict[str, float] = {}
    for of_posture in torques:
        for joint, torque in of_posture.items():
            peaks[joint] = max(peaks.get(joint, 0.0), abs(torque))
    return sorted(peaks, key=lambda joint: -peaks[joint])
