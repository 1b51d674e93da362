"""What is asked of sized actuators by the postures of a design, and how it grows with their masses.

    demand on a group = max over its joints of  |tau| of every case of the lift,
                                               factor |tau| / peak ratio of standing cases

A joint that does not move in the lift, but is driven, counts in standing cases.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import scale
from evodesign.design.space import DesignSpace
from evodesign.hardware.actuators import Actuator, ActuatorLaw, actuator_law
from evodesign.mechanics.added_mass import AddedMasses, joint_slopes
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.mechanics.floating_base import Configuration, FloatingBody
from evodesign.mechanics.stance_case import StanceCase, StanceTorques
from evodesign.mechanics.stance_torques import stance_slopes, stance_torques
from evodesign.posture.results import CaseSolution
from evodesign.tree.model import Tree

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SizedRobot:
    """A design's robot without the actuators that are sized, which rounds put into it.

    Args:
        agent: as the file describes it.
        tree: of the design.
        body: with all joints that move or are driven.
        stances: in which it stands alone.
        near: a similar robot in them.
        added: the groups of sized actuators.
    """

    agent: Agent
    tree: Tree
    body: FloatingBody
    stances: tuple[StanceCase, ...]
    near: tuple[StanceTorques, ...]
    added: AddedMasses


@dataclass(frozen=True, slots=True)
class Demand:
    """What is asked of each sized group, and how it changes with the masses of all of them.

    Args:
        groups: names.
        laws: of their actuators.
        members: of each group, the columns of its joints in `torques`.
        joints: names, one per column.
        sizes: rated torques for which the postures were found [N m].
        torques: of every case, those of standing ones over the peak ratio [N m], shape (cases, joints).
        slopes: by the mass of one actuator of each group [N m/kg], shape (cases, joints, groups); about.
        alone: what became of the standing cases.
    """

    groups: tuple[str, ...]
    laws: tuple[ActuatorLaw, ...]
    members: tuple[tuple[int, ...], ...]
    joints: tuple[str, ...]
    sizes: Mapping[str, float]
    torques: Array
    slopes: Array
    alone: tuple[StanceTorques, ...]

    def of_lift(self, cases: Sequence[CaseSolution]) -> Demand:
        """The same with other postures of the lift."""
        rows = _lift_rows(cases, self.joints)
        return replace(self, torques=np.vstack([rows, self.torques[len(rows) :]]))

    def at(self, sizes: Mapping[str, float]) -> dict[str, float]:
        """The largest |tau| of each group at other sizes [N m], in the same postures."""
        heavier = self._masses(sizes) - self._masses(self.sizes)
        torques = np.abs(self.torques + self.slopes @ heavier).max(axis=0)
        pairs = zip(self.groups, self.members, strict=True)
        return {name: float(torques[list(columns)].max(initial=0.0)) for name, columns in pairs}

    def _masses(self, sizes: Mapping[str, float]) -> Array:
        rated = np.array([sizes[name] for name in self.groups])
        masses = np.empty(len(rated))
        for law in dict.fromkeys(self.laws):
            chosen = [each == law for each in self.laws]
            masses[chosen] = law.mass(law.peak(rated[chosen]))
        return masses


def demand_of(
    space: DesignSpace,
    values: Sequence[float],
    robot: SizedRobot,
    cases: Sequence[CaseSolution],
    before: Demand | None = None,
) -> Demand | str:
    """What the postures of a round ask of the sized groups; a reason where that is not known.

    Args:
        space: of the problem.
        values: of the design, with rated torques for margins.
        robot: of the design.
        cases: of the round.
        before: what an earlier round asked, whose slopes are taken, and near whose postures it stands.
    """
    if not all(solution.solved for solution in cases):
        return "a height is not held"
    parameters, joints = [space.parameters[place] for place in space.margins], robot.body.joints
    laws = tuple(parameter.law for parameter in parameters)
    sized = [each.actuators(values[place]) for each, place in zip(parameters, space.margins, strict=True)]
    body = _with_actuators(robot, sized)
    of_joint = {joint: each.law for each in parameters for joint in each.joints}
    peaks = [float(of_joint.get(name, actuator_law()).peak(1.0)) for name in joints]
    shares = 1.0 / np.array(peaks)
    rows = _lift_rows(cases, joints)
    alone = []
    near = robot.near if before is None else before.alone
    for case, similar in zip(robot.stances, near, strict=True):
        found = stance_torques(body, case, similar)
        if found.reason:
            return found.reason
        alone.append(found)
        asked = zip(shares.tolist(), joints, strict=True)
        rows.append([case.factor * share * found.torques[name] for share, name in asked])
    places = {name: place for place, name in enumerate(joints)}
    return Demand(
        groups=tuple(each.name for each in parameters),
        laws=laws,
        members=tuple(tuple(places[joint] for joint in each.joints) for each in parameters),
        joints=joints,
        sizes={each.name: values[place] for each, place in zip(parameters, space.margins, strict=True)},
        torques=np.array(rows),
        slopes=_slopes(robot, body, cases, alone, shares) if before is None else before.slopes,
        alone=tuple(alone),
    )


def _with_actuators(robot: SizedRobot, sized: Sequence[Mapping[str, Actuator]]) -> FloatingBody:
    """The robot's body with the actuators of each group, by joint."""
    masses = [next(iter(group.values())).mass for group in sized]
    aside = [
        (0.0, 0.0, 0.0)
        if each.mounting is None
        else scale(each.mounting.share * each.size[1], robot.tree.joint_by_name[joint].axis)
        for group in sized
        for joint, each in group.items()
    ]
    return robot.added.loaded(robot.body, masses, aside)


def _lift_rows(cases: Sequence[CaseSolution], joints: Sequence[str]) -> list[list[float]]:
    """Torques of the robot's joints in every case [N m], in the order of `sized_slopes`."""
    return [
        [postures[ROBOT].torques.get(name, 0.0) for name in joints]
        for solution in cases
        for instant in solution.instants
        for postures in (instant.postures, *instant.disturbed.values())
    ]


def _slopes(
    robot: SizedRobot,
    body: FloatingBody,
    cases: Sequence[CaseSolution],
    alone: Sequence[StanceTorques],
    shares: Array,
) -> Array:
    """[N m/kg], shape (cases, joints, groups); a case of a lift has the same under all disturbances."""
    soles, slopes = robot.agent.foot_frames, []
    for instant in (instant for solution in cases for instant in solution.instants):
        posture = instant.postures[ROBOT]
        positions = {**dict.fromkeys(body.joints, 0.0), **posture.joints}
        place = Configuration(posture.base_position, posture.base_angles, positions)
        state = body.at(place, np.zeros(body.size))
        feet = np.vstack([state.jacobian_in_frame(sole) for sole in soles])[:, np.argsort(body.order)].T
        rows = robot.added.rows(body, state.coordinates)
        slopes += [joint_slopes(rows, feet, body.order)] * (1 + len(instant.disturbed))
    for case, found in zip(robot.stances, alone, strict=True):
        of_case = stance_slopes(body, case, found, robot.added)
        slopes.append((case.factor * shares)[:, np.newaxis] * of_case)
    return np.array(slopes)
