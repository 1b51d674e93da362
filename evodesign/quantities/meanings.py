"""What each quantity of the registry is in words, and in which sense it is usually optimised."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.records import Sense


@dataclass(frozen=True, slots=True)
class Meaning:
    """A quantity in words.

    Args:
        text: what it is; links lead from docs/.
        sense: in which it is usually optimised.
    """

    text: str
    sense: Sense = Sense.MINIMISE


MEANINGS: Mapping[str, Meaning] = {
    "robot_torque": Meaning("Euclidean norm of the robot's joint torques"),
    "human_torque": Meaning("Euclidean norm of the person's joint torques"),
    "peak_torque": Meaning("largest joint torque of the robot, relative to the joint's limit"),
    "human_effort": Meaning("largest joint torque of the person, relative to the joint's strength"),
    "holding_power": Meaning(
        "copper loss of the robot's actuators while they hold ([hardware](hardware.md))"
    ),
    "hand_deflection": Meaning("deflection of the robot's hands under the load: bending, twist and windup"),
    "winding_temperature": Meaning(
        "winding temperature of the warmest actuator where the posture of a case is held in the problem's "
        "`[duty]` ([heat](hardware.md#heat))"
    ),
    "robot_power": Meaning(
        "positive power of the robot's joints and copper losses of its actuators, with lifts "
        "([motion](motion.md))"
    ),
    "l5s1_moment": Meaning("norm of the person's torques between lowest lumbar vertebra and sacrum"),
    "human_load_torque": Meaning(
        "norm of the joint torques that the load adds to the person's posture, compared with empty hands "
        "([people](people.md#what-the-figures-mean))"
    ),
    "back_compression": Meaning(
        "compression of the person's disc L5/S1 by back muscles and weight; NIOSH's action limit is 3400 N "
        "([people](people.md#the-back))"
    ),
    "reach_height": Meaning("highest load that the robot can hold", Sense.MAXIMISE),
    "shared_reach_height": Meaning("highest load that the robot and all people can hold", Sense.MAXIMISE),
    "bodies_apart": Meaning(
        "least distance, less the margin, of bodies that some design's build brings together, all joints at "
        "zero; at least 0 in every problem with `[collisions]`",
        Sense.MAXIMISE,
    ),
    "parts_apart": Meaning(
        "least clearance of two parts, all joints at zero; where parts overlap, minus the sum of all "
        "overlaps ([actuators that are bodies](hardware.md#actuators-that-are-bodies))",
        Sense.MAXIMISE,
    ),
    "mass": Meaning("mass of the robot"),
    "actuator_mass": Meaning("mass of the robot's actuators"),
    "cost": Meaning("price of the robot's actuators, all of which must be models with a `price_eur`"),
    "endurance_s": Meaning(
        "time for which all people can hold all loads, the least of all cases "
        "([people](people.md#holding-time))",
        Sense.MAXIMISE,
    ),
    "torque_margin": Meaning(
        "rated torque over joint torque, the least of all actuators and cases", Sense.MAXIMISE
    ),
    "least_safety_factor": Meaning(
        "least safety factor of links with walls over all cases and load cases, against yield and buckling",
        Sense.MAXIMISE,
    ),
    "fatigue_safety_factor": Meaning(
        "least factor by which stresses of links with walls may grow that come and go with every lift of the "
        "`[duty]` ([fatigue](hardware.md#impact-and-fatigue))",
        Sense.MAXIMISE,
    ),
    "com_height": Meaning(
        "height of the robot's centre of mass above its soles, all joints at zero", Sense.MAXIMISE
    ),
    "energy": Meaning("`robot_power` over the time of a lift; mean over all lifts"),
    "lift_seconds": Meaning("least time of a lift ([motion](motion.md#the-least-time)); mean over all lifts"),
    "push_margin": Meaning(
        "largest push on the robot's trunk, of any direction, that robot, people and load survive "
        "([control](control.md))",
        Sense.MAXIMISE,
    ),
    "push_margin_alone": Meaning("the same of the robot without load and people", Sense.MAXIMISE),
    "load_tracking": Meaning(
        "largest distance of the load from its path after the problem's push, of any direction"
    ),
    "torque_saturation": Meaning(
        "largest share of the time after that push in which a motor of the robot is at its limit"
    ),
    "recovery_seconds": Meaning(
        "longest time from that push until everybody and the load are back, at most 3 s"
    ),
    "paper_cost": Meaning("the paper's cost ([model](model.md))"),
    "paper2023_cost": Meaning(
        "the sequel's cost, 100 over its fitness: the largest sum of torque norms over the heights, of all "
        "people with all loads ([paper](paper.md#the-sequel))"
    ),
    "paper2025_cost": Meaning(
        "the cost of the third paper: the person's squared torque norm and a millionth of the robot's, "
        "summed over the heights ([paper](paper.md#the-2025-robots))"
    ),
}
"""Of every quantity but `worst_` ones; links are of docs/."""
