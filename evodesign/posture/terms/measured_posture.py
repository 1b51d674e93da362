"""The measured posture: a person stands as people who were measured stand, as far as torques let it.

    cost = w mean over both sides of (y - mean(eta))^T P(eta) (y - mean(eta)) + w sum_j (q_j / s_j)^2

with eta the height of the palms over stature, y the features of `human.measured_posture` and q_j the joints
that no feature has. The lean of a chord between two points of the trunk is the mean of the leans of the links
in between, by their lengths, so that all features but the arm's direction, sideways and the distance of the
palms are linear in posture variables. A person who lifts is drawn to postures of people who lift
(`Body.moving`). The numbers by which a person differs from the mean are a parameter of programs, so that all
samples of people share their machine code.

Source: `human.measured_posture`; docs/person.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from evodesign.body.placement import Placement
from evodesign.human.measured_posture import FEATURES, MARK, MEAN_PERSON, SIDES, SPINE, Gaussians
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.scene import Scene
from evodesign.posture.terms.base import Body, BodyTerm, Expression
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree


def any_person(scene: Scene) -> tuple[Scene, Mapping[str, Expression]]:
    """A scene with any of the people of its people's distributions, and the parameters that say which.

    A parameter holds the standard normal numbers of a person; one whom no measured posture draws has none.
    """
    people, parameters = list[Agent](), dict[str, Expression]()
    for person in scene.people:
        if person.measured is not None:
            drawn: Any = ca.SX.sym(_parameter(person), len(FEATURES))
            parameters[_parameter(person)] = drawn
            people.append(replace(person, measured=replace(person.measured, drawn=drawn)))
    return scene.with_agents(*people), parameters


def person_parameters(scene: Scene) -> Mapping[str, tuple[float, ...]]:
    """The values of these parameters of a scene's people."""
    return {_parameter(each): each.measured.drawn for each in scene.people if each.measured is not None}


def _parameter(person: Agent) -> str:
    return f"drawn_{person.name}"


def chords(tree: Tree, stature: float) -> tuple[dict[str, float], dict[str, float]]:
    """How much each of the spine's joints turns the lower and the upper trunk, by joint.

    The lower trunk is the chord from the hips to the mark, the upper one that from the mark to the shoulders:
    a joint turns the share of a chord that lies above it.
    """
    frames = link_frames(tree, Placement(), {})
    height = {link: place.translation[2] for link, place in frames.items()}
    hips, top = height["LeftUpperLeg"], height["LeftUpperArm"]
    mark = hips + MARK * stature
    low, up = {}, {}
    for joint, link in SPINE.items():
        low[joint] = max(0.0, (mark - height[link]) / (mark - hips))
        up[joint] = min(1.0, (top - height[link]) / (top - mark))
    return low, up


def features(body: Body, side: str, stature: float) -> dict[str, Expression]:
    """The features of one side of a person of a stature [m], by name."""
    agent, name = body.agent, SIDES[side]
    joints = agent.tree.joint_by_name
    at = {joint: body.values["joints"][i] for i, joint in enumerate(body.form.joints)}
    bent = {joint: at.get(joint, 0.0) * joints[joint].axis[1] for joint in SPINE}
    pitch = body.values["base_angles"][1]
    low, up = chords(agent.tree, stature)
    left = 1.0 if side == "left" else -1.0
    elbow, shoulder = (body.poses[f"{name}{link}"].position for link in ("ForeArm", "UpperArm"))
    arm, palm = elbow - shoulder, body.poses[agent.frame(f"{side}_hand")].position
    knee, ankle, bend = f"j{name}Knee_roty", f"j{name}Ankle_roty", f"j{name}Elbow_rotz"
    return {
        "trunk_low": pitch + sum(low[joint] * bent[joint] for joint in SPINE),
        "trunk_up": pitch + sum(up[joint] * bent[joint] for joint in SPINE),
        "knee": at.get(knee, 0.0) * joints[knee].axis[1],
        "shank": -at.get(ankle, 0.0) * joints[ankle].axis[1],
        "arm": ca.atan2(arm[0], -arm[2]),
        "elbow": -left * at.get(bend, 0.0) * joints[bend].axis[2],
        "ahead": (palm[0] - body.poses[f"{name}Foot"].position[0]) / stature,
        "sideways": left * arm[1] / _upper_arm(agent.tree, name),
    }


def _upper_arm(tree: Tree, name: str) -> float:
    """From shoulder to elbow [m]."""
    frames = link_frames(tree, Placement(), {})
    return math.dist(*(frames[f"{name}{link}"].translation for link in ("UpperArm", "ForeArm")))


def deviation(
    y: Mapping[str, Expression], given: Gaussians, eta: Expression, drawn: Any = MEAN_PERSON
) -> Expression:
    """(y - mean_z)^T P (y - mean_z) at a height eta, a number or an expression.

    Args:
        y: features by name.
        given: means and inverse covariances.
        eta: height of the palms over stature.
        drawn: z, numbers or a symbol.
    """
    weights, z = _hats(given.knots, eta), ca.vertcat(*drawn) if isinstance(drawn, tuple) else drawn
    mean, roots = ca.horzsplit(ca.mtimes(weights, ca.DM(np.array(given.means)))), given.roots
    for i, j in zip(*np.nonzero(np.any(roots != 0.0, axis=0)), strict=True):
        mean[i] = mean[i] + ca.mtimes(weights, ca.DM(roots[:, i, j])) * z[int(j)]
    away = [y[name] - mean[i] for i, name in enumerate(FEATURES)]
    precisions, found = np.array(given.precisions), 0.0
    for i, j in zip(*np.nonzero(np.any(precisions != 0.0, axis=0)), strict=True):
        found += ca.mtimes(weights, ca.DM(precisions[:, i, j])) * away[i] * away[j]
    return found


def _hats(knots: tuple[float, ...], eta: Expression) -> Expression:
    """Weights of the knots in linear interpolation at a height, constant beyond the ends; a row."""
    passed = [ca.fmin(ca.fmax((eta - a) / (b - a), 0.0), 1.0) for a, b in pairwise(knots)]
    return ca.horzcat(*[here - there for here, there in zip([1.0, *passed], [*passed, 0.0], strict=True)])


def posture_cost(body: Body) -> Expression | None:
    """Squared standard deviations from the mean of people who were measured; of a robot nothing is said."""
    given, form = body.scene.agent(body.agent.name).measured, body.form
    if given is None:
        return None
    own, cost = given.lift if body.moving else given.hold, 0.0
    for hand in form.hands:
        palm = body.load_height + body.scene.payload.grasp_point(body.agent, hand)[2]
        found = features(body, hand.side, given.stature)
        cost += deviation(found, own, palm / given.stature, given.drawn) / len(form.hands)
    for place, (name, count) in enumerate(zip(form.joints, form.counts, strict=True)):
        bare = name.replace("jLeft", "j").replace("jRight", "j")
        if bare in given.joints:
            paired = 1.0 if bare == name else 2.0
            cost += count / paired * (body.values["joints"][place] / given.joints[bare]) ** 2
    return given.weight * cost


MEASURED_POSTURE = BodyTerm("measured_posture", posture_cost=posture_cost)
