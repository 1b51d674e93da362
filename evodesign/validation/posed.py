"""A person of numbers in a posture: posed by measured angles or joint places, with moments and angles.

Moments are of statics at rest, of both sides together, positive where what lies above the joint tips forward:
each hand holds half of a weight, and the feet carry what gravity leaves over,

    tau = h - J_hands^T f_hands - J_feet^T f_feet

with f_feet of least norm among those that balance the six rows of the root.

Source: pinocchio's gravity terms h and Jacobians J; postures from angles: `posture.seeking.measured_starts`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from evodesign.human.anthropometry import Person, sole_size
from evodesign.human.body import DEFAULT_JOINTS, HANDS, SOLES, TRUNK, human_tree
from evodesign.human.coupled_joints import rhythms
from evodesign.human.measured_posture import MARK, SIDES, HumanPosture, PostureRow, measured_posture
from evodesign.mechanics.agent import HUMAN, Agent, Role, two_hands_two_feet
from evodesign.mechanics.contact import SoleSize
from evodesign.mechanics.floating_base import ROOT, BodyState
from evodesign.posture.check import AgentModel
from evodesign.posture.results import AgentPosture
from evodesign.posture.seeking.measured_starts import posture_of_features
from evodesign.posture.symmetry import Form, half

Array = NDArray[np.float64]
Places = Mapping[str, tuple[float, float]]
"""Of joints in the sagittal plane [m], x forward and z up, by name."""

MOMENTS: Mapping[str, tuple[float, tuple[str, ...]]] = {
    "l5s1": (-1.0, ("jL5S1_roty",)),
    "hips": (1.0, tuple(f"j{name}Hip_roty" for name in SIDES.values())),
    "knees": (1.0, tuple(f"j{name}Knee_roty" for name in SIDES.values())),
    "ankles": (1.0, tuple(f"j{name}Ankle_roty" for name in SIDES.values())),
}
"""Joints of a moment, and its sign: a torque turns the link below the hips, but above L5/S1."""

OF_LEGS = frozenset({"knees", "ankles", "hip_flex", "knee", "shank", "ankle"})
"""Moments, angles and places that tell nothing where the posture of the legs is unknown."""

ANGLES = ("trunk_low", "trunk_up", "hip_flex", "knee", "shank", "arm", "elbow")

LINK_OF: Mapping[str, str] = {
    "ankle": "LeftFoot",
    "knee": "LeftLowerLeg",
    "hip": "LeftUpperLeg",
    "l5s1": "L5",
    "t12": "T12",
    "shoulder": "LeftUpperArm",
    "elbow": "LeftForeArm",
    "wrist": "LeftHand",
}
"""Links whose origins are the joints that a recording may place."""

CHAIN = ("ankle", "knee", "hip", "l5s1", "t12", "shoulder", "elbow", "wrist")
"""Joints that a stick figure connects."""

BEND = {
    "Hip_roty": (-2.3, 0.5),
    "Knee_roty": (0.0, 2.6),
    "Ankle_roty": (-0.9, 0.9),
    "Shoulder_rotz": (-3.2, 1.5),
    "Elbow_rotz": (-2.6, 0.0),
}
"""Ranges [rad] of the left side's joints that follow measured places."""

STILL = 0.005
"""Weight of a bend [m/rad] that places say nothing of, beside a distance."""


def agent_of(person: Person, posture: HumanPosture, rows: Sequence[PostureRow] | None = None) -> Agent:
    """A generated person alone, as a problem file's would be.

    Args:
        person: stature, mass, sex.
        posture: what decides how the person stands.
        rows: of measured postures, in place of those of the data file.
    """
    agent = Agent(
        name=HUMAN,
        role=Role.PERSON,
        tree=human_tree(person),
        joints=DEFAULT_JOINTS,
        contacts=two_hands_two_feet(HANDS, SOLES, SoleSize(*sole_size(person))),
        trunk=TRUNK,
        quarters=2,
    )
    if posture is HumanPosture.LEAST_TORQUE:
        return agent
    return replace(agent, rhythms=rhythms(), measured=measured_posture(person.stature, rows))


@dataclass(frozen=True, slots=True)
class Posed:
    """A person in a posture.

    Args:
        moments: [N m], by name as in `MOMENTS`.
        angles: [degrees], by name as in `ANGLES`.
        places: of joints [m].
    """

    moments: Mapping[str, float]
    angles: Mapping[str, float]
    places: Places

    def above_legs(self) -> Posed:
        """The same without what the posture of the legs decides."""
        return Posed(
            {name: value for name, value in self.moments.items() if name not in OF_LEGS},
            {name: value for name, value in self.angles.items() if name not in OF_LEGS},
            {name: value for name, value in self.places.items() if name not in OF_LEGS},
        )


@dataclass(frozen=True)
class PosedPerson:
    """A person whose posture is given.

    Args:
        person: stature, mass, sex.
    """

    person: Person

    @cached_property
    def form(self) -> Form:
        """Half of the person, with a spine that bends as one."""
        return half(agent_of(self.person, HumanPosture.MEASURED))

    @cached_property
    def model(self) -> AgentModel:
        """The person as pinocchio sees it."""
        return AgentModel.of(self.form.agent, self.form.agent.tree)

    @cached_property
    def mark(self) -> tuple[str, Array]:
        """The link with the mark on the back where lower and upper trunk meet, and its place there [m]."""
        height = {self.form.agent.tree.root: 0.0}
        for joint in self.form.agent.tree.joints:
            height[joint.child] = height[joint.parent] + joint.parent_from_child.translation[2]
        mark = height["LeftUpperLeg"] + MARK * self.person.stature
        link = max((each for each in ("L5", "L3") if height[each] < mark), key=height.__getitem__)
        return link, np.array([0.0, 0.0, mark - height[link]])

    def from_angles(self, features: Mapping[str, float]) -> AgentPosture:
        """The posture of angles [rad], named as in `human.measured_posture`, with ankles at x = 0."""
        stature = self.person.stature
        return posture_of_features(self.form, stature, features, features["ahead"] * stature)

    def from_places(self, places: Places) -> AgentPosture:
        """The posture whose joints are nearest to measured places, in least squares of distances."""
        names = [name for name in LINK_OF if name in places]
        wanted = np.array([places[name] for name in names])
        bent = {"hip": "Hip_roty", "knee": "Knee_roty", "ankle": "Ankle_roty"}
        followed = [bend for place, bend in bent.items() if place in places or bend == "Hip_roty"]
        followed += ["Shoulder_rotz", "Elbow_rotz"]
        upright = self.from_angles(dict.fromkeys((*ANGLES, "ahead"), 0.0))
        hip = np.array(places["hip"]) - np.array(self.places(self.model.at(upright))["hip"])
        start = np.array([*(upright.base_position[::2] + hip), 0.0, 0.0, 0.0, *(0.0 for _ in followed)])
        low = np.array([-np.inf, -np.inf, -1.6, -0.6, -0.3, *(BEND[name][0] for name in followed)])
        high = np.array([np.inf, np.inf, 1.9, 1.6, 0.3, *(BEND[name][1] for name in followed)])

        def away(x: Array) -> Array:
            found = self.places(self.model.at(self._bent(upright, followed, x)))
            return np.concatenate(
                [(np.array([found[name] for name in names]) - wanted).ravel(), STILL * (x[3:] - start[3:])]
            )

        middle = np.clip(start, low + 1e-3, high - 1e-3)
        return self._bent(upright, followed, least_squares(away, middle, bounds=(low, high)).x)

    def _bent(self, upright: AgentPosture, followed: Sequence[str], x: Array) -> AgentPosture:
        """The posture of a place of the root, pitch, lumbar and thoracic flexion, and bends of limbs."""
        joints, agent = dict(upright.joints), self.form.agent
        (lumbar,) = (each for each in agent.rhythms if each.name == "lumbar_flexion")
        joints |= {name: share * x[3] for name, share in zip(lumbar.joints, lumbar.shares, strict=True)}
        joints["jT9T8_roty"] = x[4]
        for name, angle in zip(followed, x[5:], strict=True):
            joints[f"jLeft{name}"] = angle
            joints[f"jRight{name}"] = angle if name.endswith("y") else -angle
        base = np.array([x[0], 0.0, x[1]])
        return replace(upright, base_position=base, base_angles=np.array([0.0, x[2], 0.0]), joints=joints)

    def posed(self, posture: AgentPosture, hand_force: float) -> Posed:
        """Moments, angles and places of a posture in which the hands hold a weight [N]."""
        state = self.model.at(posture)
        return Posed(self._moments(state, hand_force), self._angles(state), self.places(state))

    def l5s1_from_below(
        self, posture: AgentPosture, hand_force: float, ground: tuple[float, float], x: float
    ) -> float:
        """Moment at L5/S1 [N m] that a force plate tells: of ground, legs and pelvis below it.

        The weights below are those of statics, so it differs by the ground's force alone. With F the plate's
        force at (x_p, 0), F* that which balances the posture at x*, and L5/S1 at (x_l, z_l):

            M = M_statics + z_l F_x + (x_p - x_l) F_z - (x* - x_l) F*_z

        Args:
            posture: of the person.
            hand_force: weight in the hands [N].
            ground: components of the plate's force forward and up [N].
            x: of its centre of pressure [m].
        """
        state = self.model.at(posture)
        root = self.form.agent.tree.root
        turn, origin = state.pose(root)
        left_over = self._left_over(state, hand_force)[:ROOT]
        force = turn @ left_over[:3]
        moment = turn @ left_over[3:] + np.cross(origin, force)
        low_x, low_z = self.places(state)["l5s1"]
        balanced = -moment[1] - low_x * force[2]
        statics = self._moments(state, hand_force)["l5s1"]
        return float(statics + low_z * ground[0] + (x - low_x) * ground[1] - balanced)

    def places(self, state: BodyState) -> Places:
        """Of the joints of the left side and the middle, in the sagittal plane."""
        found = {name: state.pose(link)[1] for name, link in LINK_OF.items()}
        return {name: (float(place[0]), float(place[2])) for name, place in found.items()}

    def _moments(self, state: BodyState, hand_force: float) -> dict[str, float]:
        left_over = self._left_over(state, hand_force)
        feet = np.hstack([state.jacobian_in_world(link).T for link in SOLES.values()])
        ground = np.linalg.lstsq(feet[:ROOT], left_over[:ROOT], rcond=None)[0]
        torques = dict(zip(self.form.agent.joints, (left_over - feet @ ground)[ROOT:].tolist(), strict=True))
        return {
            name: sign * math.fsum(torques[each] for each in joints)
            for name, (sign, joints) in MOMENTS.items()
        }

    def _left_over(self, state: BodyState, hand_force: float) -> Array:
        """Gravity terms and the weight in the hands, before the ground bears them."""
        weight = np.array([0.0, 0.0, -hand_force / 2.0, 0.0, 0.0, 0.0])
        hands: Array = sum(
            (state.jacobian_in_world(link).T @ weight for link in HANDS.values()),
            start=np.zeros(len(state.bias)),
        )
        return state.bias - hands

    def _angles(self, state: BodyState) -> dict[str, float]:
        """As markers give them: inclinations of lines between points."""
        link, offset = self.mark
        turn, origin = state.pose(link)
        mark = origin + turn @ offset
        ankle, knee, hip, shoulder, elbow, wrist = (
            state.pose(LINK_OF[name])[1] for name in ("ankle", "knee", "hip", "shoulder", "elbow", "wrist")
        )
        low, thigh, shank = _lean(hip, mark), _lean(knee, hip), _lean(ankle, knee)
        upper, fore = elbow - shoulder, wrist - elbow
        bend = upper @ fore / np.linalg.norm(upper) / np.linalg.norm(fore)
        return {
            "trunk_low": low,
            "trunk_up": _lean(mark, shoulder),
            "hip_flex": low - thigh,
            "knee": shank - thigh,
            "shank": shank,
            "arm": math.degrees(math.atan2(upper[0], -upper[2])),
            "elbow": math.degrees(math.acos(float(np.clip(bend, -1.0, 1.0)))),
        }


def _lean(lower: Array, upper: Array) -> float:
    """Of a line from the vertical, forward positive [degrees]."""
    return math.degrees(math.atan2(upper[0] - lower[0], upper[2] - lower[2]))
