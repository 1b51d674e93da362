"""Starts of a person who is drawn to measured postures: the mean of those, placed before the load.

Angles become joint positions of a symmetric posture, with arms that hang and turn forward. The lean of the
trunk's two chords gives the tilt of the pelvis and the lumbar flexion that its joints share.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from evodesign.body.placement import Placement
from evodesign.human.measured_posture import SIDES, SPINE, MeasuredPosture
from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import Program, Start
from evodesign.posture.assemble import JOINTS, Slot
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.measured_posture import chords
from evodesign.posture.warm_start import layout_of
from evodesign.tree.frames import link_frames

ELSEWHERE = (0.20, 0.35)
"""Heights of the palms over stature at which people stoop: their means are starts at any height."""

POSTURE = ("base_position", "base_angles", JOINTS)
"""Parts of a start that say where an agent is."""


def measured_starts(program: Program, form: Form, scene: Scene, heights: Sequence[float]) -> list[Start]:
    """The person's mean posture at each of a program's instants, and two that stoop; none of other people.

    Args:
        program: in which the person has a body.
        form: of the person.
        scene: with the load.
        heights: of the load's centre at each instant [m].
    """
    given, starts = form.agent.measured, list[Start]()
    if given is None:
        return starts
    grasp = scene.payload.grasp_point(form.agent, form.hands[0])
    bounds = {v.name: (v.lower, v.upper) for v in program.variables}
    for elsewhere in (None, *ELSEWHERE):
        start: dict[str, np.ndarray] = {}
        for number, height in enumerate(heights):
            eta = (height + grasp[2]) / given.stature if elsewhere is None else elsewhere
            parts = form.parts(mean_posture(form, given, grasp[0], eta))
            start |= {
                name: parts[slot.part]
                for slot, name in layout_of(program, form.agent.name).items()
                if slot == Slot(number, 0, form.agent.name, slot.part) and slot.part in POSTURE
            }
        starts.append({name: np.clip(value, *bounds[name]) for name, value in start.items()})
    return starts


def mean_posture(form: Form, given: MeasuredPosture, hand: float, eta: float) -> AgentPosture:
    """The mean posture with the palms at a height over stature, without torques and wrenches.

    Args:
        form: of the person.
        given: what the person's posture is drawn to.
        hand: place of the palms along x, in the person's frame [m].
        eta: height of the palms over stature.
    """
    return posture_of_features(form, given.stature, given.hold.mean(eta, given.drawn), hand)


def posture_of_features(form: Form, stature: float, mean: Mapping[str, float], hand: float) -> AgentPosture:
    """The posture of a person of a stature [m] with given features, named as in `FEATURES`, likewise."""
    joints = form.agent.tree.joint_by_name
    pitch, flexion = _trunk(form, chords(form.agent.tree, stature), mean)
    at = {joint: share * flexion * joints[joint].axis[1] for joint, share in _shares(form).items()}
    thigh, chest = mean["shank"] - mean["knee"], pitch + flexion
    for side, name in SIDES.items():
        left = 1.0 if side == "left" else -1.0
        bends = {"Hip_roty": thigh - pitch, "Knee_roty": mean["knee"], "Ankle_roty": -mean["shank"]}
        at |= {f"j{name}{joint}": angle * joints[f"j{name}{joint}"].axis[1] for joint, angle in bends.items()}
        turns = {"Shoulder_rotz": -left * (mean["arm"] + chest), "Elbow_rotz": -left * mean["elbow"]}
        at |= {f"j{name}{joint}": angle * joints[f"j{name}{joint}"].axis[2] for joint, angle in turns.items()}
        raised = joints[f"j{name}Shoulder_rotx"]
        at[raised.name] = -left * math.pi / 2.0 * raised.axis[0]
    positions = {name: at.get(name, 0.0) for name in form.agent.joints}
    base = _base(form, positions, pitch, hand - mean["ahead"] * stature)
    none = dict.fromkeys(form.agent.joints, 0.0)
    wrenches = {contact.name: np.zeros(6) for contact in form.agent.contacts}
    return AgentPosture(base, np.array([0.0, pitch, 0.0]), positions, none, wrenches)


def _shares(form: Form) -> Mapping[str, float]:
    """Of the lumbar joints in flexion, by name."""
    return next(
        dict(zip(r.joints, r.shares, strict=True)) for r in form.agent.rhythms if {*r.joints} < {*SPINE}
    )


def _trunk(
    form: Form, trunk: tuple[Mapping[str, float], Mapping[str, float]], mean: Mapping[str, float]
) -> tuple[float, float]:
    """Tilt of the pelvis and lumbar flexion [rad] that give the mean leans of lower and upper trunk."""
    shares = _shares(form).items()
    by_low, by_up = (sum(chord[joint] * share for joint, share in shares) for chord in trunk)
    flexion = (mean["trunk_up"] - mean["trunk_low"]) / (by_up - by_low)
    return mean["trunk_low"] - by_low * flexion, flexion


def _base(form: Form, positions: Mapping[str, float], pitch: float, ankle: float) -> np.ndarray:
    """Place of the base [m] at which the left ankle is at `ankle` along x and the left sole on the ground."""
    c, s = math.cos(pitch), math.sin(pitch)
    tilted = Placement(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)))
    frames = link_frames(form.agent.tree, tilted, positions)
    foot, sole = frames["LeftFoot"].translation, frames[form.agent.frame("left_foot")].translation
    return np.array([ankle - foot[0], 0.0, -sole[2]])
