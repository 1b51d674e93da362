"""The joints of largest torque: what a card, a plot or a layout shows where there is no space for all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["ranked_joints"]


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
