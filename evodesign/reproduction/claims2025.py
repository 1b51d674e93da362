"""What the robots of 2025 are optimised for, and whether other postures and people confirm it.

Robots B and C minimise 1e11 |tau_h|^2 + 1e5 |tau_r|^2 summed over four heights: the person first. So beside
them a person should need lower torques than beside robot A and the iCub, and no robot should do better.

Source: Sartore et al. 2025, published code (ami-iit/paper_sartore_2025_ergocub_nature_machine_intelligence).
Its repository prints no torques of these robots; verdicts are on what its problem asks for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from evodesign.reproduction.claims2022 import Claim, TorqueNormsByHeight

ICUB, REFERENCE = "iCub", "A"
BEFORE, OPTIMISED = (REFERENCE, ICUB), ("B", "C")
BY_COST, BY_FRONT = "by_cost", "by_front"
"""Names of the robots of our two searches."""

LOWER = 0.02
"""Share by which a figure must fall to count as lower.

At 0.8 m least torque has optima of 0.7 to 1.7 N m for the person, which differ by 1.3 % of the cost.
"""


@dataclass(frozen=True, slots=True)
class ErgonomicRobot:
    """What a robot asks and gives.

    Args:
        mass: [kg].
        highest: load that it can hold [m]; None when not solved.
        cost: of 2025 with the paper's person, over 1e11 [(N m)^2]; None where a height is not held.
        by_person: torques of robot and person and the compression of L5/S1, by person and height.
    """

    mass: float
    highest: float | None
    cost: float | None
    by_person: Mapping[str, TorqueNormsByHeight]


Robots = Mapping[str, ErgonomicRobot]
Figure = Literal["robot", "human", "back"]
"""A field of `TorqueNorms`."""


def change(before: TorqueNormsByHeight, after: TorqueNormsByHeight, figure: Figure) -> float | None:
    """By which share a figure's mean over the heights that both robots hold differs; None without any."""
    shared = [height for height in before if height in after]
    first, then = (
        sum(value for height in shared if (value := getattr(norms[height], figure)) is not None)
        for norms in (before, after)
    )
    return then / first - 1.0 if first else None


def reach_claim(robots: Robots, heights: Sequence[float]) -> Claim:
    """B and C hold the load at every height, and higher than A and the iCub."""
    whole = {name: next(iter(robot.by_person.values())) for name, robot in robots.items()}
    lost = [name for name in OPTIMISED if tuple(whole[name]) != tuple(heights)]
    highest = {name: robots[name].highest or 0.0 for name in (*BEFORE, *OPTIMISED)}
    higher = min(highest[name] for name in OPTIMISED) > max(highest[name] for name in BEFORE)
    short = [name for name in BEFORE if max(heights) not in whole[name]]
    return Claim(
        subject="reach",
        by="B and C",
        paper="0.8 to 1.5 m, A 0.8 to 1.2 m",
        found=", ".join(f"{name} {reach:.3f}" for name, reach in highest.items()) + " m",
        reproduced=not lost and higher,
        reason=f"{' and '.join(lost)} lack a height"
        if lost
        else f"{' and '.join(short) or 'neither A nor the iCub'} cannot hold the load at {max(heights):g} m",
    )


def human_claim(robots: Robots, person: str) -> Claim:
    """A person needs lower torques beside B and C than beside A, at the heights that they share."""
    backs = _changes(robots, person, "back")[REFERENCE]
    return _fall_claim(
        robots, person, "human torque", "human", f"compression of L5/S1 {_shares(backs)} against A"
    )


def robot_claim(robots: Robots, person: str) -> Claim:
    """B and C need lower torques themselves than A, at the heights that they share."""
    return _fall_claim(
        robots, person, "robot torque", "robot", "in their cost it weighs a millionth of the person's"
    )


def _changes(robots: Robots, person: str, figure: Figure) -> dict[str, list[float | None]]:
    """By which share B and C differ from A and from the iCub."""
    norms = {name: robots[name].by_person[person] for name in (*BEFORE, *OPTIMISED)}
    return {one: [change(norms[one], norms[name], figure) for name in OPTIMISED] for one in BEFORE}


def _fall_claim(robots: Robots, person: str, subject: str, figure: Figure, remark: str) -> Claim:
    changes = _changes(robots, person, figure)
    return Claim(
        subject=subject,
        by=f"B, C; {person}",
        paper="lower",
        found=f"{_shares(changes[REFERENCE])} against A",
        reproduced=all(each is not None and each <= -LOWER for each in changes[REFERENCE]),
        reason=f"{_shares(changes[ICUB])} against the iCub; {remark}",
    )


def cost_claim(robots: Robots, costs: Sequence[float]) -> Claim:
    """No design that a search of ours finds has a cost that counts as lower than that of B and C.

    Args:
        robots: all of them.
        costs: of the search's feasible designs [(N m)^2].
    """
    shown = {name: robots[name].cost for name in (*OPTIMISED, BY_COST) if name in robots}
    theirs = [cost for name in OPTIMISED if (cost := shown[name]) is not None]
    best = bool(theirs) and bool(costs) and min(costs) > min(theirs) * (1.0 - LOWER)
    span = f"{min(costs):.2f} to {max(costs):.2f} (N m)^2" if costs else "none"
    return Claim(
        subject="least cost",
        by="our search of the cost",
        paper="B and C minimise it",
        found=", ".join(f"{name} {'-' if cost is None else f'{cost:.2f}'}" for name, cost in shown.items()),
        reproduced=best,
        reason=f"{len(costs)} feasible designs of our search cost {span}",
    )


def front_claim(robots: Robots, dominating: Mapping[str, int], designs: int) -> Claim:
    """No design of our front dominates B or C in robot torque, human torque and reach.

    Args:
        robots: all of them.
        dominating: how many designs do, by robot.
        designs: feasible ones of the search.
    """
    counts = ", ".join(f"{name} by {dominating[name]}" for name in OPTIMISED)
    ours = robots.get(BY_FRONT)
    return Claim(
        subject="not dominated",
        by="our front",
        paper="B and C are optima",
        found=f"{counts} of {designs} designs",
        reproduced=designs > 0 and not any(dominating.values()),
        reason="the search has no feasible design"
        if ours is None
        else f"robot torque of its shown robot {_shares(_against(ours, robots, 'robot'))} against B, C, "
        f"human torque {_shares(_against(ours, robots, 'human'))}",
    )


def _against(robot: ErgonomicRobot, robots: Robots, figure: Figure) -> list[float | None]:
    """By which share a robot differs from B and C, beside the paper's person."""
    first = next(iter(robot.by_person))
    return [change(robots[name].by_person[first], robot.by_person[first], figure) for name in OPTIMISED]


def _shares(changes: Sequence[float | None]) -> str:
    return ", ".join("-" if each is None else f"{each:+.1%}" for each in changes)
