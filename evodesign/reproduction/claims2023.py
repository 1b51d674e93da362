"""What the sequel of 2023 claims of its robots and its search, and whether other postures confirm it.

    fitness = 100 / max over people and loads of  sum over heights of  |tau_motor|_2 + |tau_h|_2

Figures are those of its published code: fitness by design, evaluations and failures from the log of its
search (`src/results/GA_NL/results/fitnessDatabase.csv`), hours from the log's first and last time, and the
gain of the log's best fitness over the unscaled robot's.

Source: Sartore et al. 2023, arXiv 2312.07459, and its published code
(ami-iit/paper_sartore_2023_humanoids_codesign-ga-nl).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evodesign.reproduction.claims2022 import ALIKE, Claim

LOGGED: Mapping[str, float] = {
    "log_1": 0.1862234773970584,
    "log_2": 0.18580286560046727,
    "log_3": 0.18570179334303819,
    "log_4": 0.1864188192071547,
    "log_5": 0.1869151896227604,
    "log_6": 0.18684898009242873,
    "log_7": 0.18658098277151847,
    "log_8": 0.18406809728435714,
    "log_9": 0.18413051158713023,
    "log_10": 0.16905270274457468,
    "log_11": 0.1769928433308573,
}
"""Fitness in its log of designs of `populations/sartore2023_robots.toml`."""

OTHER_MOTORS = 0.16589605463384577
"""Fitness in its log of the links of log_2 with other motors."""

FAILED = ("failed_1", "failed_2", "failed_3", "failed_4")
"""Designs whose fitness in its log is that of a failed program, 1e-8."""

EVALUATIONS, FAILURES, HOURS, WORKERS, GAIN = 2884, 567, 48.2, 19, 0.052

CORRELATED = 0.5
"""Rank correlation from which an order counts as the same."""

UNSCALED, NL, GA = "unscaled", "nl", "ga"


@dataclass(frozen=True, slots=True)
class RobotFigures:
    """What became of a robot with all people and loads.

    Args:
        name: of the design.
        cost: 100 over the fitness [N m]; None where a case is not held.
        robot_torque, human_torque: means over all cases [N m]; None likewise.
        mass: of the robot [kg].
        highest: load that it can hold [m]; None when not solved.
        held, cases: how many cases it holds, of how many.
        bodies_apart: by how much its bodies are farther apart than asked while all joints are at zero [m], as
            `problem.objectives.bodies_apart` has it; None where bodies may pass through anything.
    """

    name: str
    cost: float | None
    robot_torque: float | None
    human_torque: float | None
    mass: float
    highest: float | None
    held: int
    cases: int
    bodies_apart: float | None = None

    @property
    def fitness(self) -> float | None:
        """As the sequel has it [100/(N m)]."""
        return None if self.cost is None else 100.0 / self.cost


@dataclass(frozen=True, slots=True)
class SearchFigures:
    """What a search of ours took and found.

    Args:
        evaluations, infeasible: how many.
        minutes: with everything that is worked out beforehand.
        jobs: workers.
        reached: evaluations until one had a cost no larger than GA's; None for never.
        dominated: until one had less robot torque, too.
        least, most: cost of the feasible designs [N m]; None without any.
    """

    evaluations: int
    infeasible: int
    minutes: float
    jobs: int
    reached: int | None
    dominated: int | None
    least: float | None
    most: float | None


def log_claim(robots: Mapping[str, RobotFigures]) -> Claim:
    """The torques of its log, as sums over the heights with the worst pair of a person and a load."""
    said = [100.0 / fitness for fitness in LOGGED.values()]
    found = [cost for name in LOGGED if (cost := robots[name].cost) is not None]
    alike = len(found) == len(said) and all(
        abs(cost / one - 1.0) <= ALIKE for cost, one in zip(found, said, strict=True)
    )
    reason = (
        "other postures of these robots and people need far lower torques: its programs end in local optima"
    )
    return Claim(
        subject="torques of its log",
        by=f"{len(LOGGED)} logged designs",
        paper=f"{min(said):.0f} to {max(said):.0f} N m",
        found=f"{min(found):.1f} to {max(found):.1f} N m" if found else "no posture",
        reproduced=alike,
        reason="the figures agree" if alike else reason,
    )


def order_claim(robots: Mapping[str, RobotFigures]) -> Claim:
    """Its fitness orders designs."""
    pairs = [(LOGGED[name], fitness) for name in LOGGED if (fitness := robots[name].fitness) is not None]
    rank = rank_correlation([one for one, _ in pairs], [other for _, other in pairs])
    swing = 1.0 - OTHER_MOTORS / LOGGED["log_2"]
    return Claim(
        subject="order of designs",
        by=f"{len(LOGGED)} logged designs",
        paper="by fitness",
        found="too few postures" if rank is None else f"rank correlation {rank:+.2f}",
        reproduced=rank is not None and rank >= CORRELATED,
        reason=f"in its log the links of log_2 with other motors are {swing:.0%} less fit, though torques at "
        f"the motors are less than a hundredth of the sum; its whole search gains {GAIN:.1%}",
    )


def rank_correlation(one: Sequence[float], other: Sequence[float]) -> float | None:
    """Spearman's: the correlation of the ranks; None for fewer than three values. Without ties."""
    if len(one) < 3:
        return None
    ranks = np.array([np.argsort(np.argsort(values)) for values in (one, other)], dtype=float)
    return float(np.corrcoef(ranks)[0, 1])


def robot_claim(robots: Mapping[str, RobotFigures]) -> Claim:
    """The robot of its genetic algorithm needs less torque than that of its nonlinear program."""
    ga, nl = robots[GA], robots[NL]
    if ga.cost is None or nl.cost is None or ga.robot_torque is None or nl.robot_torque is None:
        return Claim(
            "GA against NL", GA, "improves ergonomics", "-", False, "one of them does not hold every load"
        )
    change, at_joints = ga.cost / nl.cost - 1.0, ga.robot_torque / nl.robot_torque - 1.0
    return Claim(
        subject="GA against NL",
        by=GA,
        paper="improves ergonomics",
        found=f"its sum of torques {change:+.1%}, robot torque {at_joints:+.0%}",
        reproduced=change < 0.0 and at_joints <= 0.0,
        reason="compared at the best postures that are found for each, with their densities",
    )


def gain_claim(robots: Mapping[str, RobotFigures], search: SearchFigures) -> Claim:
    """A search gains 5.2 % of fitness over the unscaled robot."""
    cost = robots[UNSCALED].cost
    gain = None if cost is None or search.least is None else cost / search.least - 1.0
    span = (
        "" if search.least is None or search.most is None else f"{search.least:.1f} to {search.most:.1f} N m"
    )
    return Claim(
        subject="gain over the unscaled robot",
        by="our search",
        paper=f"{GAIN:+.1%}",
        found="-" if gain is None else f"{gain:+.1%}",
        reproduced=gain is not None and gain >= GAIN,
        reason="with point grasps a person carries half of the load whatever the robot: "
        f"all feasible designs of our search lie within {span}"
        if span
        else "there is no feasible design to compare",
    )


def failure_claim(robots: Mapping[str, RobotFigures], search: SearchFigures) -> Claim:
    """A fifth of its designs has no fitness."""
    whole = sum(robots[name].held == robots[name].cases for name in FAILED)
    return Claim(
        subject="designs without fitness",
        by=f"{len(FAILED)} logged designs and our search",
        paper=f"{FAILURES} of {EVALUATIONS} ({FAILURES / EVALUATIONS:.0%})",
        found=f"{len(FAILED) - whole} of its {len(FAILED)}, {search.infeasible} of our {search.evaluations}",
        reproduced=whole < len(FAILED),
        reason=f"{whole} of the {len(FAILED)} robots hold every load: their programs failed, not they",
    )


def search_claim(search: SearchFigures) -> Claim:
    """A search as cheap as its own finds a robot as good as its own."""
    workers = f"{search.jobs} worker" + "s" * (search.jobs != 1)
    took = f"{search.evaluations} evaluations in {search.minutes:.1f} min with {workers}"
    reason = "no design has as small a cost as GA"
    if search.reached is not None:
        reason = f"as good as GA by its fitness after {search.reached} evaluations"
        reason += (
            "; none with less robot torque, too"
            if search.dominated is None
            else f", with less robot torque, too, after {search.dominated}"
        )
    return Claim(
        subject="search",
        by="our search",
        paper=f"{EVALUATIONS} evaluations in {HOURS:g} h with about {WORKERS} workers",
        found=took,
        reproduced=search.reached is not None and search.evaluations <= EVALUATIONS,
        reason=reason,
    )
