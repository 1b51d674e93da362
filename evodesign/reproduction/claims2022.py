"""What the paper claims of its robots, and whether other robots confirm it.

Source: Sartore et al. 2022, Table II and Section IV-A.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TorqueNorms:
    """Torque norms of both agents at one height [N m], and the compression of the person's L5/S1 [N]."""

    robot: float
    human: float
    back: float | None = None


TorqueNormsByHeight = Mapping[float, TorqueNorms]
"""Torque norms by height [m], for the heights at which there is a posture."""

PAPER_ORIGINAL: TorqueNormsByHeight = {
    0.8: TorqueNorms(41.0307, 181.7120),
    1.0: TorqueNorms(144.2744, 140.6781),
    1.2: TorqueNorms(20.9576, 120.8854),
}
PAPER_OPTIMISED: TorqueNormsByHeight = {
    0.8: TorqueNorms(58.7634, 192.4057),
    1.0: TorqueNorms(90.4088, 141.5792),
    1.2: TorqueNorms(23.5889, 120.5903),
    1.5: TorqueNorms(38.7279, 113.0994),
}

ORIGINAL_HEIGHTS, OPTIMISED_HEIGHTS = tuple(PAPER_ORIGINAL), tuple(PAPER_OPTIMISED)
AT = 1.0
"""Height of the load at which the paper compares robot torques [m]."""

REDUCTION = 0.33
PRESERVED = 0.10
"""Share by which human torque may rise and still count as preserved."""

ALIKE = 0.25
"""Share by which a torque norm may differ from the paper's and still count as its own."""


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim and what became of it.

    Args:
        subject: what is claimed.
        by: which robot it was tried on.
        paper: the paper's figure.
        found: ours.
        reproduced: whether ours confirms the claim.
        reason: why, in a sentence.
    """

    subject: str
    by: str
    paper: str
    found: str
    reproduced: bool
    reason: str


def reach_claim(by: str, original: TorqueNormsByHeight, optimised: TorqueNormsByHeight) -> Claim:
    """The original robot holds the load at 0.8 to 1.2 m and not at 1.5 m, the optimised one at all four."""
    right_before = tuple(original) == ORIGINAL_HEIGHTS
    missing = [height for height in OPTIMISED_HEIGHTS if height not in optimised]
    if not right_before:
        reason = f"the original robot holds the load at {_heights(original)}"
    elif missing:
        reason = f"no posture was found at {_heights(missing)}"
    else:
        reason = "every posture is checked by separate code, and 1.5 m is beyond the original robot's reach"
    return Claim(
        subject="reach",
        by=by,
        paper=f"{_heights(ORIGINAL_HEIGHTS)}, then {_heights(OPTIMISED_HEIGHTS)}",
        found=f"{_heights(original)}, then {_heights(optimised)}",
        reproduced=right_before and not missing,
        reason=reason,
    )


def reduction_claim(
    by: str, original: TorqueNormsByHeight, optimised: TorqueNormsByHeight, least: float, among: int
) -> Claim:
    """The optimised robot's torque at 1.0 m is about 33 % less than the original one's.

    Args:
        by: how the optimised robot was found.
        original: the robot as it is, at its own best postures.
        optimised: the robot of least cost.
        least: torque norm at 1.0 m of the best robot of all that were found [N m].
        among: how many those are.
    """
    if AT not in original or AT not in optimised:
        lacking = "original" if AT not in original else "optimised"
        reason = f"the {lacking} robot has no posture at {AT:g} m"
        return Claim("robot torque at 1 m", by, "-37 %, called about 33 %", "-", False, reason)
    before, after = original[AT].robot, optimised[AT].robot
    fall = 1.0 - after / before
    enough = fall >= REDUCTION
    reason = f"the largest fall of all {among} robots that were found is {1.0 - least / before:.0%}"
    if not enough:
        reason = f"the robot of least cost over all heights gains less at this one; {reason}"
    return Claim(
        subject="robot torque at 1 m",
        by=by,
        paper="144.3 to 90.4 N m: -37 %, called about 33 %",
        found=f"{before:.2f} to {after:.2f} N m: {-fall:+.0%}",
        reproduced=enough,
        reason=reason,
    )


def human_claim(by: str, original: TorqueNormsByHeight, optimised: TorqueNormsByHeight) -> Claim:
    """The person's torque rises by no more than a tenth beside the optimised robot."""
    common = [height for height in original if height in optimised]
    changes = [optimised[height].human / original[height].human - 1.0 for height in common]
    preserved = bool(common) and max(changes) <= PRESERVED
    if not common:
        reason = "there is no height at which both robots hold the load"
    elif preserved:
        reason = "with point grasps a person carries half the load whatever the robot"
    else:
        reason = "the postures that were found need higher torques of the person; a better one may exist"
    paper = [PAPER_OPTIMISED[h].human / PAPER_ORIGINAL[h].human - 1.0 for h in ORIGINAL_HEIGHTS]
    return Claim(
        subject="human torque preserved",
        by=by,
        paper=f"{min(paper):+.0%} to {max(paper):+.0%}",
        found=f"{min(changes):+.0%} to {max(changes):+.0%}" if changes else "-",
        reproduced=preserved,
        reason=reason,
    )


def table_claim(by: str, original: TorqueNormsByHeight, optimised: TorqueNormsByHeight, broken: str) -> Claim:
    """The torque norms of Table II themselves.

    Args:
        by: the setting.
        original: what it gives for the robot as it is.
        optimised: what it gives for the optimised one.
        broken: the physical limits that its postures break, in words; empty for none.
    """
    pairs = [(PAPER_ORIGINAL, original), (PAPER_OPTIMISED, optimised)]
    shares = [
        found / said
        for paper, ours in pairs
        for height in paper
        if height in ours
        for found, said in (
            (ours[height].robot, paper[height].robot),
            (ours[height].human, paper[height].human),
        )
    ]
    alike = bool(shares) and all(abs(share - 1.0) <= ALIKE for share in shares)
    people = [norms.human for ours in (original, optimised) for norms in ours.values()]
    reason = "other postures need far lower torques, so the table is a local solution and not an optimum"
    if broken:
        reason += f"; without limits nothing holds torques up, and these postures break {broken}"
    return Claim(
        subject="Table II",
        by=by,
        paper="human 113 to 192 N m, robot 21 to 144 N m",
        found=f"human {min(people):.2g} to {max(people):.2g} N m" if people else "no posture",
        reproduced=alike,
        reason="the figures agree" if alike else reason,
    )


def _heights(heights: Mapping[float, TorqueNorms] | tuple[float, ...] | list[float]) -> str:
    return ", ".join(f"{height:g}" for height in heights) + " m" if heights else "no height"
