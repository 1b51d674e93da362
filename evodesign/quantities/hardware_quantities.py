"""Quantities of a robot whose actuators a design chooses.

    holding_power    sum over actuators of (tau / K)^2 [W], K the motor constant at the output
    actuator_mass    sum of the actuators' masses [kg]
    hand_deflection  how far the hands give way under the load: bending, twist and windup [mm]
    least_safety_factor  of all links with walls and cases, against yield and buckling
    torque_margin    least rated torque over |tau| of all actuators and cases: 1 for one at its limit
    cost             sum of the actuators' prices [EUR]

A joint without an actuator takes no part. A scene's robot has the tree of the design here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from evodesign.body.placement import Placement
from evodesign.mechanics import link_beams
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.mechanics.floating_base import FloatingBody
from evodesign.mechanics.scene import Scene
from evodesign.mechanics.stance_case import StanceCase, StanceTorques, stance_torques
from evodesign.posture.results import AgentPosture
from evodesign.tree.equip import actuators_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

NEED_ACTUATORS = ("holding_power", "actuator_mass", "torque_margin", "hand_deflection")
"""How the names of quantities end that tell nothing where no design chooses actuators."""

COST = "cost"
"""The quantity that needs models whose prices are known."""

NEED_WALLS = ("least_safety_factor",)
"""How the names of quantities end that tell nothing without walls."""

Postures = Mapping[str, AgentPosture]


def holding_power(scene: Scene, postures: Postures) -> float:
    """Copper loss of holding the posture [W]."""
    torques = postures[ROBOT].torques
    actuators = actuators_of(scene.robot.tree)
    return float(sum(each.loss(torques[joint]) for joint, each in actuators.items() if joint in torques))


def power_by_torque(scene: Scene, postures: Postures) -> dict[str, dict[str, float]]:
    """D P / d tau = 2 tau / K^2."""
    torques = postures[ROBOT].torques
    actuators = actuators_of(scene.robot.tree)
    slopes = {
        joint: float(2.0 * torques[joint] / each.motor_constant**2)
        for joint, each in actuators.items()
        if joint in torques
    }
    return {ROBOT: slopes}


def torque_share(scene: Scene, postures: Postures) -> float:
    """The largest |tau| over rated torque of the actuators; 0 without any."""
    torques = postures[ROBOT].torques
    actuators = actuators_of(scene.robot.tree)
    shares = (abs(torques[joint]) / each.rated for joint, each in actuators.items() if joint in torques)
    return float(max(shares, default=0.0))


def hand_deflection(scene: Scene, postures: Postures) -> float:
    """How far the robot's hands give way downwards under the load, the mean of both [mm]."""
    robot, posture = scene.robot, postures[ROBOT]
    hands = {hand.frame: posture.wrenches[hand.name] for hand in robot.hands}
    soles = robot.foot_frames
    return 1000.0 * link_beams.hand_deflection(robot.tree, _base(posture), posture.joints, hands, soles)


def least_safety_factor(scene: Scene, postures: Postures) -> float:
    """The least safety factor of the robot's links with walls; infinite without any."""
    return min(link_safety(scene.robot, postures[ROBOT]).values(), default=np.inf)


def link_safety(robot: Agent, posture: AgentPosture) -> dict[str, float]:
    """The safety factor of each of a robot's links that is a beam, by name; its tree is the design's."""
    base = _base(posture)
    places = link_frames(robot.tree, base, posture.joints)
    held = [(hand.frame, posture.wrenches[hand.name]) for hand in robot.hands]
    wrenches = [(frame, wrench[:3], wrench[3:]) for frame, wrench in held]
    for foot in robot.feet:
        turn, wrench = np.array(places[foot.frame].rotation, float), posture.wrenches[foot.name]
        wrenches.append((foot.frame, turn @ wrench[:3], turn @ wrench[3:]))
    return link_beams.safety_factors(robot.tree, base, posture.joints, wrenches)


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


OF_BEAMS = ("hand_deflection", "least_safety_factor")
"""How the names of quantities end that need walls of known stiffness and strength."""


class StanceModel:
    """The robot in the problem's standing postures, whatever its design; results of one design are kept.

    Args:
        cases: of the problem.
        body: the robot with all joints that move or are driven, of any design.
        latest: the tree of a design, and the body with it.
    """

    def __init__(
        self,
        cases: tuple[StanceCase, ...],
        body: FloatingBody,
        latest: tuple[Tree, FloatingBody] | None = None,
    ) -> None:
        self.cases, self.body = cases, body
        self._latest = latest
        self._known: tuple[Tree, list[tuple[StanceCase, StanceTorques]]] | None = None

    @classmethod
    def of(cls, cases: tuple[StanceCase, ...], agent: Agent, driven: Sequence[str]) -> StanceModel:
        """Of a robot some of whose joints are driven, by name; they count whether they move in the lift."""
        joints = (*agent.joints, *(name for name in driven if name not in agent.joints))
        return cls(cases, FloatingBody.of_tree(agent.tree, joints, np.eye(3)))

    def torques(self, tree: Tree) -> list[tuple[StanceCase, StanceTorques]]:
        """What became of each case with the tree of a design."""
        if self._known is None or self._known[0] is not tree:
            known = self._latest
            body = known[1] if known is not None and known[0] is tree else self.body.resized(tree)
            self._known = tree, [(case, stance_torques(body, case)) for case in self.cases]
        return self._known[1]

    def needed(self, tree: Tree) -> list[Mapping[str, float]] | str:
        """Factor x |tau| [N m] of each case by joint, which peak torques must be; or why one cannot be."""
        found = self.torques(tree)
        for _, each in found:
            if each.reason:
                return each.reason
        return [
            {joint: case.factor * abs(torque) for joint, torque in each.torques.items()}
            for case, each in found
        ]

    def shares(self, tree: Tree) -> list[float] | None:
        """The largest of these over peak torque, of each case; None where the robot cannot stand."""
        needed, actuators = self.needed(tree), actuators_of(tree)
        if isinstance(needed, str):
            return None
        return [
            float(
                max(
                    (asked[joint] / actuators[joint].peak for joint in actuators if joint in asked), default=0
                )
            )
            for asked in needed
        ]
