"""Quantities of a robot whose actuators a design chooses.

    holding_power    sum over actuators of (m / K)^2 [W], K the motor constant at the output, m the motor's
                     torque: the joint's, less what friction of the gear bears (`hardware.friction`)
    actuator_mass    sum of the actuators' masses [kg]
    hand_deflection  how far the hands give way under the load: bending, twist and windup [mm]
    least_safety_factor  of all links with walls and cases, against yield and buckling
    fatigue_safety_factor  of all links with walls and cases, each held as often as the duty says
    torque_margin    least rated torque over |tau| of all actuators and cases: 1 for one at its limit
    cost             sum of the actuators' prices [EUR]
    winding_temperature  of the actuator that gets warmest in the problem's duty (`hardware.heat`) [deg C]

A joint without an actuator takes no part. A scene's robots have the tree of the design here; of several the
masses and prices are those of one, powers are added up, and the rest is that of the one that has it worst.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evodesign.body.placement import Placement
from evodesign.hardware.friction import MotorTorque
from evodesign.hardware.heat import RATED_AIR
from evodesign.hardware.structure import von_mises
from evodesign.mechanics import link_beams
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.robot_gradient import RobotGradient
from evodesign.posture.results import AgentPosture, Array
from evodesign.quantities.design_result import CaseQuantity, PostureSlopes
from evodesign.quantities.over_agents import designed, largest, least, over_agents, total
from evodesign.tree.equip import actuators_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

NEED_ACTUATORS = ("holding_power", "actuator_mass", "torque_margin", "hand_deflection")
"""How the names of quantities end that tell nothing where no design chooses actuators."""

WINDING = "winding_temperature"
"""The quantity that needs a `[duty]`."""

COST = "cost"
"""The quantity that needs models whose prices are known."""

FATIGUE = "fatigue_safety_factor"
"""The quantity that needs a `[duty]` with a life, and walls whose fatigue is known."""

NEED_WALLS = ("least_safety_factor", FATIGUE)
"""How the names of quantities end that tell nothing without walls."""


def copper_loss(robot: Agent, posture: AgentPosture) -> float:
    """Copper loss in the posture [W]."""
    return float(sum((motor.value / k) ** 2 for motor, k in _motors(robot, posture).values()))


def power_by_torque(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """D P / d tau = 2 m / K^2 dm / d tau."""
    motors = _motors(robot, posture)
    return {joint: 2.0 * motor.value / k**2 * motor.by_torque for joint, (motor, k) in motors.items()}


def power_by_speed(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """D P / d w = 2 m / K^2 dm / d w."""
    motors = _motors(robot, posture)
    return {joint: 2.0 * motor.value / k**2 * motor.by_speed for joint, (motor, k) in motors.items()}


def motor_torque(robot: Agent, posture: AgentPosture, joint: str) -> MotorTorque:
    """The torque of a joint's motor in a posture [N m]: the joint's where no actuator is known."""
    actuator, torque = actuators_of(robot.tree).get(joint), posture.torques[joint]
    return MotorTorque(torque, 1.0) if actuator is None else actuator.motor(torque, posture.speeds.get(joint))


def _motors(robot: Agent, posture: AgentPosture) -> dict[str, tuple[MotorTorque, float]]:
    """The torque of each actuator's motor, and its constant K [N m/W^0.5]."""
    return {
        joint: (motor_torque(robot, posture, joint), float(each.motor_constant))
        for joint, each in actuators_of(robot.tree).items()
        if joint in posture.torques
    }


HOLDING_POWER = over_agents(designed, total, "W", copper_loss, by_torque=power_by_torque)


def winding_temperature(robot: Agent, posture: AgentPosture) -> float:
    """Of the actuator that gets warmest where the posture is held in the problem's duty [deg C].

    Without a duty none gets warmer than the air.
    """
    return max((value for value, _ in _windings(robot, posture).values()), default=RATED_AIR)


def warmest_by_torque(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """The warmest winding moves with its joint's torque [K/(N m)]."""
    windings = _windings(robot, posture)
    joint = max(windings, key=lambda name: windings[name][0], default="")
    return {joint: windings[joint][1]} if joint else {}


def _windings(robot: Agent, posture: AgentPosture) -> dict[str, tuple[float, float]]:
    """The temperature of each actuator's winding, and its derivative by the torque."""
    found = {}
    for joint, each in actuators_of(robot.tree).items():
        if each.duty is not None and joint in posture.torques:
            rated, motor = float(each.rated), each.motor(posture.torques[joint])
            share = abs(motor.value) / rated
            slope = np.copysign(each.duty.slope(share) / rated, motor.value) * motor.by_torque
            found[joint] = each.duty.temperature(share), float(slope)
    return found


WINDING_TEMPERATURE = over_agents(
    designed, largest, "deg C", winding_temperature, by_torque=warmest_by_torque
)


def torque_share(robot: Agent, posture: AgentPosture) -> float:
    """The largest |tau| over rated torque of the actuators; 0 without any."""
    torques, actuators = posture.torques, actuators_of(robot.tree)
    shares = (abs(torques[joint]) / each.rated for joint, each in actuators.items() if joint in torques)
    return float(max(shares, default=0.0))


TORQUE_SHARE = over_agents(designed, largest, "1", torque_share)


def hand_deflection(robot: Agent, posture: AgentPosture) -> float:
    """How far a robot's hands give way downwards under the load, the mean of both [mm]."""
    return 1000.0 * deflection_shares(robot, posture).total


def deflection_shares(robot: Agent, posture: AgentPosture) -> link_beams.Shares:
    """What each link and each joint with an actuator adds to it."""
    hands = {hand.frame: posture.wrenches[hand.name] for hand in robot.hands}
    return link_beams.hand_deflection(robot.tree, _base(posture), posture.joints, hands, robot.foot_frames)


def deflection_slopes(
    gradient: RobotGradient, values: Sequence[float], robot: Agent, posture: AgentPosture
) -> tuple[Array, PostureSlopes]:
    """Its derivatives by what programs are given, and by posture and wrenches of the load [mm/...]."""
    angles, held = np.asarray(posture.base_angles), posture.wrenches
    found = gradient.deflection(robot).at(robot.tree, values, angles, posture.joints, held)
    by_posture = PostureSlopes(found.base_angles, found.joints, found.wrenches)
    return 1000.0 * found.values, by_posture.times(1000.0)


HAND_DEFLECTION = over_agents(designed, largest, "mm", hand_deflection, by_robot=deflection_slopes)


def least_safety_factor(robot: Agent, posture: AgentPosture) -> float:
    """The least safety factor of a robot's links with walls; infinite without any."""
    return min((each.factor for each in link_safety(robot, posture).values()), default=np.inf)


SAFETY_FACTOR = over_agents(designed, least, "1", least_safety_factor)


def link_safety(robot: Agent, posture: AgentPosture) -> dict[str, link_beams.Safety]:
    """The safety of each of a robot's links that is a beam, by name; its tree is the design's."""
    return link_beams.link_safety(robot.tree, _base(posture), posture.joints, _wrenches(robot, posture))


def fatigue_factor(cycles: float) -> CaseQuantity:
    """The least factor by which stresses may grow that come and go so often; infinite without walls."""

    def of_robot(robot: Agent, posture: AgentPosture) -> float:
        wrenches = _wrenches(robot, posture)
        ends = link_beams.loaded_ends(robot.tree, _base(posture), posture.joints, wrenches)
        return min(
            (
                beam.material.fatigue.safety_factor(von_mises(beam.section, load), cycles)
                for beam, load in ends
                if beam.material.fatigue is not None
            ),
            default=np.inf,
        )

    return over_agents(designed, least, "1", of_robot)


def _wrenches(robot: Agent, posture: AgentPosture) -> list[link_beams.Wrench]:
    """On hands and feet, in the world's axes."""
    base = _base(posture)
    places = link_frames(robot.tree, base, posture.joints)
    held = [(hand.frame, posture.wrenches[hand.name]) for hand in robot.hands]
    wrenches = [(frame, wrench[:3], wrench[3:]) for frame, wrench in held]
    for foot in robot.feet:
        turn, wrench = np.array(places[foot.frame].rotation, float), posture.wrenches[foot.name]
        wrenches.append((foot.frame, turn @ wrench[:3], turn @ wrench[3:]))
    return wrenches


def _base(posture: AgentPosture) -> Placement:
    return Placement.from_xyz_rpy(tuple(posture.base_position.tolist()), tuple(posture.base_angles.tolist()))


def actuator_mass(tree: Tree) -> float:
    """Mass of all actuators [kg]."""
    return float(sum(each.mass for each in actuators_of(tree).values()))


def cost(tree: Tree) -> float | None:
    """Price of all actuators [EUR]; None where one has none."""
    prices = [each.price for each in actuators_of(tree).values()]
    known = [price for price in prices if price is not None]
    return float(sum(known)) if prices and len(known) == len(prices) else None


OF_BEAMS = ("hand_deflection", *NEED_WALLS)
"""How the names of quantities end that need walls of known stiffness and strength."""
