"""What a posture asks of the person: the joint that works hardest, and the load by NIOSH's equation.

Information, not objectives (`human_effort` is one): both follow from a posture as it is logged.

    H, A: length and direction of the horizontal line from the middle of the ankles to the middle of the hands
    V: height of the middle of the hands            L = -(f_left + f_right) . z / g

An ankle is the origin of the link that carries the sole, which its joint to the leg gives. Straight ahead is
the way that the person looks at the load.

Source: see `human.niosh` and `human.strength`; docs/people.md says what the figures mean.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from evodesign.body.placement import Placement, Vector, add, scale
from evodesign.human.niosh import LiftingTask, NioshMultipliers, multipliers
from evodesign.human.strength import RelativeTorque, largest_relative_torque
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.scene import SIDES, Agent
from evodesign.records import AgentDetail
from evodesign.tree.frames import link_frames
from evodesign.tree.model import JointKind, Tree

__all__ = ["Ergonomics", "ergonomics", "ergonomics_json"]


@dataclass(frozen=True, slots=True)
class Ergonomics:
    """What a posture asks of the person.

    Args:
        strain: of the joint that works hardest; None for a person without strengths.
        task: where the hands are, as the lifting equation sees it.
        multipliers: of the equation.
        load: the part of the load that the person holds up [kg].
    """

    strain: RelativeTorque | None
    task: LiftingTask
    multipliers: NioshMultipliers
    load: float

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
    hands = _middle([at[person.hands[side]].translation for side in SIDES])
    ankles = _middle([at[_ankle(person.tree, person.soles[side])].translation for side in SIDES])
    ahead, aside = hands[0] - ankles[0], hands[1] - ankles[1]
    task = LiftingTask(
        horizontal=math.hypot(ahead, aside),
        vertical=hands[2],
        asymmetry=math.degrees(abs(math.atan2(aside, ahead))),
    )
    held = -math.fsum(posture.hand_wrenches[side][2] for side in SIDES) / GRAVITY
    return Ergonomics(
        strain=largest_relative_torque(posture.torques_n_m, person.strengths),
        task=task,
        multipliers=multipliers(task),
        load=held,
    )


def ergonomics_json(asked: Ergonomics) -> dict[str, Any]:
    """The same as a JSON object; its shape is a promise. Nulls: no strengths, or nothing recommended."""
    strain, task = asked.strain, asked.task
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
    }


def _ankle(tree: Tree, sole: str) -> str:
    """The link that carries a sole: the first one up from it that a joint moves."""
    link = sole
    while link != tree.root and tree.parent_joint[link].kind is JointKind.FIXED:
        link = tree.parent_joint[link].parent
    return link


def _middle(points: list[Vector]) -> Vector:
    return scale(0.5, add(points[0], points[1]))
