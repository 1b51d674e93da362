"""Objectives: pure functions of a design's results.

A case is a person with a load at a task, undisturbed or under one of the problem's disturbances. A quantity
has a value in every case; an objective is its mean over the cases, its largest value, or a quantile, so that
a front may be asked to hold for everyone and not only on average. The way stands before the quantity's name:
`human_torque` is the mean, and there are `worst_human_torque` and `q90_human_torque`. In a lift a quantity
has a value at every instant: its mean over time is the value of the case, and the largest of all instants is
the `worst_` one.

Adding one is a function here and a line in `QUANTITIES`, for a value of every case, or in `WHOLE`, for one of
the design; the problem file then knows its name. Without touching the package, one is a `CaseQuantity` or an
`ObjectiveKind` in a module of its own, which every process imports, and its name is `MODULE:NAME` (see
`outside`). What does
not exist (no posture, no reach) is absent, never large.

Beyond 300 lines: the list of objectives, a few lines each.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from evodesign.collision.parts import part_clearance
from evodesign.collision.zero_posture import built_in_slack
from evodesign.errors import InputError, explain
from evodesign.human.strength import largest_relative_torque
from evodesign.mechanics.agent import HUMAN, ROBOT, Agent
from evodesign.mechanics.balance import standing_height_of_mass
from evodesign.motion.solution import MotionCase
from evodesign.outside import imported, is_outside
from evodesign.posture.results import AgentPosture
from evodesign.posture.terms.base import TORQUE_UNIT
from evodesign.posture.terms.paper_tasks import pressure_task
from evodesign.quantities.design_result import (
    WORST,
    CaseQuantity,
    DesignResult,
    ObjectiveKind,
    aggregate,
    largest_value,
    mean_over_time,
    values_over_cases,
    values_over_instants,
)
from evodesign.quantities.hardware_quantities import (
    FATIGUE,
    HAND_DEFLECTION,
    HOLDING_POWER,
    SAFETY_FACTOR,
    TORQUE_SHARE,
    WINDING,
    WINDING_TEMPERATURE,
    actuator_mass,
    cost,
    fatigue_factor,
)
from evodesign.quantities.motion_quantities import (
    ENDURANCE,
    ENERGY,
    L5S1_MOMENT,
    LEAST_TIME,
    PAPER_COSTS,
    POWER,
    ROBOT_POWER,
    SPINE,
)
from evodesign.quantities.over_agents import largest, norm, over_agents, people, robots
from evodesign.quantities.person_quantities import (
    BACK,
    BACK_COMPRESSION,
    HUMAN_LOAD_TORQUE,
    endurance_seconds,
)
from evodesign.quantities.push_quantities import (
    ALONE,
    MARGIN,
    RECOVERY,
    SATURATION,
    SIMULATED,
    TRACKING,
    load_tracking,
    push_margin,
    push_margin_alone,
    recovery_seconds,
    torque_saturation,
)
from evodesign.records import Constraint, Lift, Objective
from evodesign.violations import BODIES_APART, PARTS_APART


def torque_norm(agent: Agent, posture: AgentPosture) -> float:
    """|tau|_2 of an agent [N m] (paper, task t1)."""
    return posture.torque_norm


def _by_norm(agent: Agent, posture: AgentPosture) -> dict[str, float]:
    """D |tau| / d tau = tau / |tau|."""
    norm = posture.torque_norm or 1.0
    return {joint: torque / norm for joint, torque in posture.torques.items()}


def peak_torque(robot: Agent, posture: AgentPosture) -> float:
    """A robot's largest |tau| over its limit, over the joints: 1 for a joint at its limit."""
    torques, limits = posture.torques, robot.torque_limits
    return max(abs(torques[joint]) / limits[joint] for joint in robot.joints)


def _by_peak(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """The largest share moves with one joint."""
    torques, limits = posture.torques, robot.torque_limits
    joint = max(robot.joints, key=lambda name: abs(torques[name]) / limits[name])
    return {joint: float(np.copysign(1.0 / limits[joint], torques[joint]))}


def effort(person: Agent, posture: AgentPosture) -> float:
    """A person's largest |torque| over the joint's strength in that direction; 1 is all that they have."""
    hardest = largest_relative_torque(posture.torques, person.strengths)
    return 0.0 if hardest is None else hardest.share


def _by_effort(person: Agent, posture: AgentPosture) -> dict[str, float]:
    """As the peak, for a person."""
    hardest = largest_relative_torque(posture.torques, person.strengths)
    return {hardest.joint: hardest.share / hardest.torque} if hardest and hardest.torque else {}


ROBOT_TORQUE = over_agents(robots, norm, "N m", torque_norm, by_torque=_by_norm, of_actuators=False)
"""|tau|_2 of all joints of all robots."""

HUMAN_TORQUE = over_agents(people, norm, "N m", torque_norm, by_torque=_by_norm)
"""|tau|_2 of all joints of all people who hold the load together."""


def shared_reach_height(result: DesignResult) -> float | None:
    """Highest load that the robot and all of the people can hold [m]."""
    if result.reach.highest is None or result.people_highest is None:
        return None
    return min(result.reach.highest, result.people_highest)


def bodies_apart(result: DesignResult) -> float | None:
    """By how much bodies that designs may bring together are farther apart than asked, joints at zero [m].

    None where bodies may pass through anything, or where no design brings any together.
    """
    found = built_in_slack(result.tree, result.robot.collisions)
    return None if found is None else found[0]


def parts_apart(result: DesignResult) -> float | None:
    """How much room the parts have that have least, or minus what all lack [m]; None without such parts."""
    found = part_clearance(result.tree, result.scenes[0].designed_tree)
    return None if found is None else found.apart


def torque_margin(result: DesignResult) -> float | None:
    """The least rated torque over |tau|, over actuators and cases; None also where nothing is held.

    Where the robot stands alone, the peak torque over the case's factor is in the place of rated torque.
    """
    share = largest_value(TORQUE_SHARE.value, result)
    alone = [] if result.standing is None else result.standing.shares(result.tree)
    if share is None or alone is None or max(share, *alone, 0.0) <= 0.0:
        return None
    return 1.0 / max(share, *alone, 0.0)


def safety_of_links(result: DesignResult) -> float | None:
    """The least safety factor of the robot's links, over all cases and load cases; None without walls."""
    factors = values_over_instants(SAFETY_FACTOR.value, result)
    if factors is None:
        return None
    alone = () if result.standing is None else result.standing.safety(result.tree)
    standing = [each.factor for _, links in alone for each in links.values()]
    least = min([each for values in factors for each in values] + standing, default=math.inf)
    return least if least < math.inf else None


def fatigue_of_links(result: DesignResult) -> float | None:
    """The least fatigue safety factor of the robot's links, over all cases; None without walls or a life."""
    cycles = [wall.cycles for wall in result.space.walls if wall.cycles is not None]
    factors = values_over_instants(fatigue_factor(cycles[0]).value, result) if cycles else None
    least = math.inf if factors is None else min(each for values in factors for each in values)
    return least if least < math.inf else None


def energy(result: DesignResult) -> float | None:
    """What the robot's joints and actuators draw in a lift [J], the mean over all lifts; None without any."""
    found = values_over_instants(ROBOT_POWER.value, result)
    if found is None:
        return None
    lifts = [
        mean_over_time(solution.times, values) * solution.case.task.seconds
        for (solution, _), values in zip(result.every_case(), found, strict=True)
        if isinstance(solution.case.task, Lift)
    ]
    return float(np.mean(lifts)) if lifts else None


def least_times(result: DesignResult) -> list[float] | None:
    """The least time of every lift [s]; None without any, and where one is not known."""
    lifts = [solution for solution in result.cases if isinstance(solution.case.task, Lift)]
    found = [each.least_seconds for each in lifts if isinstance(each, MotionCase) and each.solved]
    known = [seconds for seconds in found if seconds is not None]
    return known if known and len(known) == len(lifts) else None


def mean_least_time(result: DesignResult) -> float | None:
    """The mean over all lifts of the least time in which they can be done [s]."""
    found = least_times(result)
    return None if found is None else float(np.mean(found))


def worst_least_time(result: DesignResult) -> float | None:
    """The largest of them [s]."""
    found = least_times(result)
    return None if found is None else max(found)


def com_height(result: DesignResult) -> float:
    """Height of the robot's centre of mass above its soles, all joints at zero [m] (paper, task t4)."""
    return float(standing_height_of_mass(result.tree, result.robot.foot_frames))


def paper_cost(result: DesignResult) -> float | None:
    """W1 t1 + W3 t3 of all undisturbed cases + W2 t2 + W4 t4 [(10 N m)^2], the paper's cost (Eq. 14)."""
    torques = (ROBOT_TORQUE.value, HUMAN_TORQUE.value)
    robot, human = (values_over_cases(t1, result, disturbed=False) for t1 in torques)
    if robot is None or human is None:
        return None
    efforts, tasks = result.paper.efforts, result.paper.tasks
    strain = efforts.robot * np.square(robot) + efforts.human * np.square(human)
    cost = tasks.weights.torque * strain.sum() / TORQUE_UNIT**2
    cost += tasks.of_design(result.space, result.values, result.robot, result.tree)
    if tasks.weights.center_of_pressure:
        for case in result.cases:
            for agent in result.scene_of(case.case).agents:
                feet = {foot.name: case.postures[agent.name].wrenches[foot.name] for foot in agent.feet}
                cost += tasks.weights.center_of_pressure * pressure_task(feet)
    return float(cost)


def paper2023_cost(result: DesignResult) -> float | None:
    """The largest sum of torque norms over the heights, of all people with all loads [N m].

        max over pairs of  sum over heights of  |tau_r|_2 / 160 + |tau_h|_2

    The sequel's fitness is 100 over it: the robot's torques count at the motors, whose ratio is 160 (its
    models M and L). Source: Sartore et al. 2023, published code (`GA_with_PyGad.py`).
    """
    if not all(solution.solved for solution in result.cases):
        return None
    sums: dict[tuple[str, str], float] = {}
    for solution in result.cases:
        postures, pair = solution.postures, solution.case.pair
        norms = postures[ROBOT].torque_norm / MOTOR_RATIO + postures[HUMAN].torque_norm
        sums[pair] = sums.get(pair, 0.0) + norms
    return max(sums.values())


MOTOR_RATIO = 160.0
"""Turns of a motor M or L per turn of its joint in the published code of Sartore et al. 2023."""


def paper2025_cost(result: DesignResult) -> float | None:
    """Sum of |tau_h|^2 + 1e-6 |tau_r|^2 over all undisturbed cases [(N m)^2].

    The torque terms of the cost of 2025, 1e11 |tau_h|^2 + 1e5 |tau_r|^2, over 1e11. Source: published code of
    Sartore et al. 2025 (ami-iit/paper_sartore_2025_ergocub_nature_machine_intelligence).
    """
    robot, human = (values_over_cases(t.value, result, disturbed=False) for t in (ROBOT_TORQUE, HUMAN_TORQUE))
    if robot is None or human is None:
        return None
    return float(np.square(human).sum() + ROBOT_WEIGHT_2025 * np.square(robot).sum())


ROBOT_WEIGHT_2025 = 1e-6
"""Of a robot's squared torques where a person's have the weight 1."""

HUMAN_EFFORT = "human_effort"
"""The hardest joint's share of the person's strength."""

NEED_PEOPLE = (
    "human_torque",
    "human_load_torque",
    HUMAN_EFFORT,
    SPINE,
    BACK,
    ENDURANCE,
    "shared_reach_height",
    *PAPER_COSTS,
)
"""How the names of quantities end that are of people, or of robot and people together."""

NEED_ROBOTS = frozenset(
    {
        *("robot_torque", "peak_torque", "holding_power", "hand_deflection", WINDING, POWER, ENERGY),
        *("mass", "com_height", "actuator_mass", "cost", "torque_margin", "least_safety_factor"),
        FATIGUE,
        *(BODIES_APART, PARTS_APART, *PAPER_COSTS),
        *SIMULATED,
    }
)
"""Quantities that are of robots."""

NEED_STRENGTHS = (HUMAN_EFFORT, ENDURANCE)
"""How the names of quantities end that need people of known strength."""

QUANTITIES: Mapping[str, CaseQuantity] = {
    "robot_torque": ROBOT_TORQUE,
    "human_torque": HUMAN_TORQUE,
    "peak_torque": over_agents(robots, largest, "1", peak_torque, by_torque=_by_peak),
    HUMAN_EFFORT: over_agents(people, largest, "1", effort, by_torque=_by_effort),
    "holding_power": HOLDING_POWER,
    "hand_deflection": HAND_DEFLECTION,
    WINDING: WINDING_TEMPERATURE,
    POWER: ROBOT_POWER,
    SPINE: L5S1_MOMENT,
    "human_load_torque": HUMAN_LOAD_TORQUE,
    BACK: BACK_COMPRESSION,
}
"""Values of single cases; an objective is the mean of one, or its `worst_` or `q90_`."""

REACH, SHARED_REACH = "reach_height", "shared_reach_height"

WHOLE: Mapping[str, ObjectiveKind] = {
    REACH: ObjectiveKind("m", lambda result: result.reach.highest),
    SHARED_REACH: ObjectiveKind("m", shared_reach_height),
    BODIES_APART: ObjectiveKind("m", bodies_apart),
    PARTS_APART: ObjectiveKind("m", parts_apart),
    "mass": ObjectiveKind("kg", lambda result: float(result.tree.mass)),
    "actuator_mass": ObjectiveKind("kg", lambda result: actuator_mass(result.tree)),
    "cost": ObjectiveKind("EUR", lambda result: cost(result.tree)),
    ENDURANCE: ObjectiveKind("s", endurance_seconds),
    "torque_margin": ObjectiveKind("1", torque_margin),
    "least_safety_factor": ObjectiveKind("1", safety_of_links),
    FATIGUE: ObjectiveKind("1", fatigue_of_links),
    "com_height": ObjectiveKind("m", com_height),
    ENERGY: ObjectiveKind("J", energy),
    LEAST_TIME: ObjectiveKind("s", mean_least_time),
    f"{WORST}{LEAST_TIME}": ObjectiveKind("s", worst_least_time),
    MARGIN: ObjectiveKind("N s", push_margin),
    ALONE: ObjectiveKind("N s", push_margin_alone),
    TRACKING: ObjectiveKind("m", load_tracking),
    SATURATION: ObjectiveKind("1", torque_saturation),
    RECOVERY: ObjectiveKind("s", recovery_seconds),
    "paper_cost": ObjectiveKind("(10 N m)^2", paper_cost),
    "paper2023_cost": ObjectiveKind("N m", paper2023_cost),
    "paper2025_cost": ObjectiveKind("(N m)^2", paper2025_cost),
}
"""Values of a design as a whole."""


OTHERWISE_CALLED: Mapping[str, str] = {"peak_power": f"{WORST}{POWER}"}
"""What somebody means who asks for a quantity by a name that it might have."""


def objective_kinds() -> Mapping[str, ObjectiveKind]:
    """Objectives by name; quantiles, of which there are many, are left to `objective_kind`."""
    ways = ((over, name) for over in ("", WORST) for name in QUANTITIES)
    return {**{f"{over}{name}": aggregate(QUANTITIES[name], over) for over, name in ways}, **WHOLE}


def objective_kind(name: str) -> ObjectiveKind | None:
    """The objective of a name, such as `robot_torque`, `worst_robot_torque` or `q90_robot_torque`.

    Raises:
        InputError: a name of the form `MODULE:NAME` that is no objective, or may not be imported.
    """
    way, quantity = split_name(name)
    if is_outside(quantity):
        found = imported(quantity, "objectives", "")
        if isinstance(found, ObjectiveKind) and not way:
            return found
        if isinstance(found, CaseQuantity):
            return aggregate(replace(found, value=lambda *case: _number(found.value(*case))), way)
        wanted = "a CaseQuantity" if way else "a CaseQuantity or an ObjectiveKind"
        raise InputError("objectives", "", wanted, f"'{quantity}', which is {type(found).__name__}")
    if way in ("", WORST) or quantity not in QUANTITIES:
        return objective_kinds().get(name)
    return aggregate(QUANTITIES[quantity], way)


def _number(value: Any) -> float:
    """What a function of the user's gives, as a finite number."""
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"it gives {value}, which is no finite number")
    return number


def split_name(name: str) -> tuple[str, str]:
    """How an objective is taken over the cases (`worst_`, `q90_` or nothing), and of which quantity."""
    match = re.fullmatch(rf"({WORST}|q[1-9]\d?_|)(.+)", name)
    return (match[1], match[2]) if match else ("", name)


def objective_values(quantities: Sequence[Objective | Constraint], result: DesignResult) -> dict[str, float]:
    """Natural values of objectives or constrained quantities, by name, without those that do not exist."""
    found = {quantity.name: objective_value(quantity.name, result) for quantity in quantities}
    return {name: value for name, value in found.items() if value is not None}


def objective_value(name: str, result: DesignResult) -> float | None:
    """An objective's value; None where it does not exist.

    Raises:
        KeyError: no objective has this name.
        InputError: a function of the user's failed.
    """
    kind = objective_kind(name)
    if kind is None:
        raise KeyError(name)
    try:
        value = kind.value(result)
        return _number(value) if is_outside(name) and value is not None else value
    except Exception as error:  # a function of the user's may raise anything
        if not is_outside(name):
            raise
        found = f"'{name}', which fails: {explain(error)}"
        raise InputError("objectives", "", "a function that gives a value, or None", found) from error
