"""What a posture asks of the person: joints, back, holding time, and the load and posture by worksheets.

Information, not objectives (`human_effort`, `back_compression` and others are): all of it follows from a
posture as it is logged.

    H, A: length and direction of the horizontal line from the middle of the ankles to the middle of the hands
    V: height of the middle of the hands            L = -(f_left + f_right) . z / g

An ankle is the origin of the link that carries the sole, which its joint to the leg gives. Straight ahead is
the way that the person looks at the load. RULA and REBA are those of the arm that has the larger score; the
posture is held for longer than a minute unless it moves, and the grip is poor, as handles are not described.

Source: see `human.niosh`, `human.strength`, `human.back`, `human.endurance` and `human.worksheets`;
docs/people.md says what the figures mean.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evodesign.body.placement import Placement, Vector, add, scale
from evodesign.human.back import ACTION_LIMIT, FLEXION
from evodesign.human.endurance import Endurance, endurance
from evodesign.human.niosh import LiftingTask, NioshMultipliers, multipliers
from evodesign.human.strength import RelativeTorque, largest_relative_torque
from evodesign.human.worksheets import HeldLoad, Score, reba, rula
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.load_torques import load_torques
from evodesign.mechanics.lumbar_load import LumbarLoad, has_lumbar_disc, lumbar_load
from evodesign.quantities.observed import observed
from evodesign.records import AgentDetail
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree


@dataclass(frozen=True, slots=True)
class Ergonomics:
    """What a posture asks of the person.

    Args:
        strain: of the joint that works hardest; None for a person without strengths.
        task: where the hands are, as the lifting equation sees it.
        multipliers: of the equation.
        load: the part of the load that the person holds up [kg].
        load_torque: norm of the torques that the load adds to those with empty hands [N m].
        back: what the disc L5/S1 bears; None for a person without that joint.
        endurance: the joint that tires first; None for a person without strengths.
        rula, reba: scores of the posture; None for a person whose links have other names.
    """

    strain: RelativeTorque | None
    task: LiftingTask
    multipliers: NioshMultipliers
    load: float
    load_torque: float
    back: LumbarLoad | None
    endurance: Endurance | None
    rula: Score | None
    reba: Score | None

    @property
    def recommended_weight(self) -> float:
        """The recommended weight limit [kg]; zero where the equation recommends nothing."""
        return self.multipliers.recommended_weight

    @property
    def lifting_index(self) -> float | None:
        """The part of the load over what is recommended; None where nothing is."""
        return self.load / self.recommended_weight if self.recommended_weight else None


def ergonomics(person: Agent, posture: AgentDetail) -> Ergonomics:
    """What a posture asks of a person.

    Args:
        person: the agent as the problem names it.
        posture: in the agent's own frame.
    """
    root = Placement.from_xyz_rpy(posture.base_position_m, posture.base_rpy_rad)
    at = link_frames(person.tree, root, posture.joints_rad)
    hands = _middle([at[hand.frame].translation for hand in person.hands])
    ankles = _middle([at[_ankle(person.tree, foot.frame)].translation for foot in person.feet])
    ahead, aside = hands[0] - ankles[0], hands[1] - ankles[1]
    task = LiftingTask(
        horizontal=math.hypot(ahead, aside),
        vertical=hands[2],
        asymmetry=math.degrees(abs(math.atan2(aside, ahead))),
    )
    held = -math.fsum(posture.wrenches[hand.name][2] for hand in person.hands) / GRAVITY
    scores = _scores(person, posture, held)
    return Ergonomics(
        strain=largest_relative_torque(posture.torques_n_m, person.strengths),
        task=task,
        multipliers=multipliers(task),
        load=held,
        load_torque=_load_torque(person, posture),
        back=_back(person, posture),
        endurance=endurance(posture.torques_n_m, person.strengths),
        rula=scores[0],
        reba=scores[1],
    )


def _load_torque(person: Agent, posture: AgentDetail) -> float:
    hands = np.concatenate([posture.wrenches[hand.name] for hand in person.hands])
    return load_torques(person, np.array(posture.base_rpy_rad), _joints(person, posture), hands).norm


def _back(person: Agent, posture: AgentDetail) -> LumbarLoad | None:
    if not has_lumbar_disc(person):
        return None
    feet = np.concatenate([posture.wrenches[foot.name] for foot in person.feet])
    torque, angles = posture.torques_n_m[FLEXION], np.array(posture.base_rpy_rad)
    return lumbar_load(person, angles, _joints(person, posture), feet, torque)


def _joints(person: Agent, posture: AgentDetail) -> NDArray[np.float64]:
    return np.array([posture.joints_rad[name] for name in person.joints])


def _scores(person: Agent, posture: AgentDetail, load: float) -> tuple[Score | None, Score | None]:
    """RULA and REBA of the worse arm."""
    seen = observed(person, posture)
    if seen is None:
        return None, None
    (arms, body), held = seen, HeldLoad(max(load, 0.0), still=not posture.speeds_rad_s)
    found = [[score(arm, body, held) for arm in arms] for score in (rula, reba)]
    worse = [max(scores, key=lambda each: (each.whole, each.arm)) for scores in found]
    return worse[0], worse[1]


def of_most_loaded_back(people: Iterable[Agent], postures: Mapping[str, AgentDetail]) -> Ergonomics:
    """What postures ask of the one of several people whose back bears most.

    Args:
        people: one at least.
        postures: of everybody, by name.
    """
    every = (ergonomics(person, postures[person.name]) for person in people)
    return max(every, key=lambda one: 0.0 if one.back is None else one.back.compression)


def ergonomics_json(asked: Ergonomics) -> dict[str, Any]:
    """The same as a JSON object; its shape is a promise. Nulls are what the person or the posture lacks."""
    strain, task, back, tires = asked.strain, asked.task, asked.back, asked.endurance
    return {
        "effort": strain.share if strain else None,
        "hardest_joint": strain.joint if strain else None,
        "movement": strain.movement if strain else None,
        "hands_ahead_m": task.horizontal,
        "hands_height_m": task.vertical,
        "asymmetry_deg": task.asymmetry,
        "multipliers": asdict(asked.multipliers),
        "held_kg": asked.load,
        "recommended_weight_kg": asked.recommended_weight,
        "lifting_index": asked.lifting_index,
        "load_torque_n_m": asked.load_torque,
        "back_compression_n": back.compression if back else None,
        "back_shear_n": back.shear if back else None,
        "back_limit_n": ACTION_LIMIT,
        "endurance_s": tires.seconds if tires else None,
        "endurance_joint": tires.joint.joint if tires else None,
        "endurance_measured": tires.measured if tires else None,
        "rula": asdict(asked.rula) if asked.rula else None,
        "reba": asdict(asked.reba) if asked.reba else None,
    }


def _ankle(tree: Tree, sole: str) -> str:
    """The link that carries a sole: the first one up from it that a joint moves."""
    link = sole
    while link != tree.root and tree.parent_joint[link].kind is JointKind.FIXED:
        link = tree.parent_joint[link].parent
    return link


def _middle(points: list[Vector]) -> Vector:
    return scale(0.5, add(points[0], points[1]))
