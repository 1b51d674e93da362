"""Quantities of a robot whose actuators a design chooses.

    holding_power    sum over actuators of (tau / K)^2 [W], K the motor constant at the output
    actuator_mass    sum of the actuators' masses [kg]
    torque_margin    least rated torque over |tau| of all actuators and cases: 1 for one at its limit

A joint without an actuator takes no part. A scene's robot has the tree of the design here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from evodesign.errors import InputError
from evodesign.mechanics.scene import ROBOT, Scene
from evodesign.mechanics.stance_case import StanceCase, StanceTorques, stance_torques
from evodesign.posture.check import AgentModel
from evodesign.posture.results import AgentPosture
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree

__all__ = [
    "NEED_ACTUATORS",
    "StanceModel",
    "actuator_mass",
    "holding_power",
    "power_by_torque",
    "refuse_without_actuators",
    "torque_share",
]

NEED_ACTUATORS = ("holding_power", "actuator_mass", "torque_margin")
"""How the names of quantities end that tell nothing where no design chooses actuators."""

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


def actuator_mass(tree: Tree) -> float:
    """Mass of all actuators [kg]."""
    return float(sum(each.mass for each in actuators_of(tree).values()))


@dataclass(frozen=True, slots=True, eq=False)
class StanceModel:
    """The robot in the problem's standing postures, whatever its design.

    Args:
        cases: of the problem.
        robot: as pinocchio sees it, of any design.
    """

    cases: tuple[StanceCase, ...]
    robot: AgentModel

    def torques(self, tree: Tree) -> list[tuple[StanceCase, StanceTorques]]:
        """What became of each case with the tree of a design."""
        body = self.robot.resized(tree).body
        return [(case, stance_torques(body, case)) for case in self.cases]

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


def refuse_without_actuators(key: str, name: str, tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse a quantity of actuators where no design chooses any.

    Args:
        key: where the problem file names it.
        name: of the quantity.
        tables: the problem file.
        source: the problem, for messages.
    Raises:
        InputError: naming the quantity.
    """
    if name.endswith(NEED_ACTUATORS) and not tables.design.actuator:
        raise InputError(source.path, key, f"a [[design.actuator]] for '{name}'", "none")
