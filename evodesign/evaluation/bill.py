"""The bill of materials of a design: what drives each joint and what asks most of it, and what links are of.

    {"joints": {joint: {"actuator": group, "model": name or null, "rated_torque_n_m", "peak_torque_n_m",
                        "mass_kg", "price_eur": or null, "asked_n_m", "asked_by": case,
                        "share": of rated or peak torque, "loss_w": largest copper loss of the lift,
                        "friction_torque_n_m": that turns it without current, or null}},
     "links": {link: {"material": name, "wall_m", "mass_kg": without actuators,
                      "safety_factor": or null, "safety_case": case of the lift, or null}},
     "mass_kg": {"actuators", "structure", "rest", "total"},
     "least_clearance": {"parts": two names, "clearance_m": negative where they do not go together}}

What is asked by a load case is its factor times the torque, and its share that of peak torque; by a case of
the lift, of rated torque. Structure is the walls' own mass. Least room is told where actuators are bodies
(`collision.parts`). A problem without actuators and walls has none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from evodesign.collision.parts import part_clearance
from evodesign.design.space import DesignSpace
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.hardware.actuators import Actuator
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.mechanics.stance_case import StanceCase
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem
from evodesign.quantities.hardware_quantities import link_safety
from evodesign.quantities.stance_model import StanceModel
from evodesign.records import CaseDetail
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree

Asked = tuple[str, dict[str, float], bool]
"""A case's name, what it asks of each joint [N m], and whether for a moment only."""


def bill_of_materials(problem: DesignProblem, tree: Tree, cases: Sequence[CaseDetail]) -> dict[str, Any]:
    """The bill of a design; empty for a problem without hardware.

    Args:
        problem: whose design it is.
        tree: of the design, numbers.
        cases: its postures.
    """
    space, actuators = problem.space, actuators_of(tree)
    if not actuators and not space.walls:
        return {}
    asked = [*_lifted(cases), *_alone(problem.scene.robot, problem.stances, tree)]
    groups = {joint: parameter.group for parameter in space.parameters for joint in parameter.joints}
    joints = {
        joint: {"actuator": groups[joint], **_row(joint, each, asked)} for joint, each in actuators.items()
    }
    links, structure = _links(space, tree)
    for name, safety in _safety(problem.scene.robot, tree, cases if space.walls else ()).items():
        links[name] |= safety
    total = float(tree.mass)
    mass = float(sum(each.mass for each in actuators.values()))
    split = {"actuators": mass, "structure": structure, "rest": total - mass - structure, "total": total}
    bill: dict[str, Any] = {"joints": joints, "links": links, "mass_kg": split}
    if clearance := part_clearance(tree, problem.scene.designed_tree):
        least = clearance.least
        bill["least_clearance"] = {"parts": [least.first, least.second], "clearance_m": least.distance}
    return bill


def _lifted(cases: Sequence[CaseDetail]) -> Iterator[Asked]:
    for name, posture in _postures(cases):
        yield name, dict(posture.torques), False


def _postures(cases: Sequence[CaseDetail]) -> Iterator[tuple[str, AgentPosture]]:
    """The robot in every case of the lift, disturbed or not, by what it is called."""
    for detail in cases:
        name = ", ".join(part for part in (str(detail.case.task), detail.case.label) if part)
        for instant in detail.instants:
            own = instant.agents[ROBOT]
            yield name, logged_posture(own)
            for disturbance, agents in instant.disturbed.items():
                yield f"{name}, {disturbance}", logged_posture(own, agents[ROBOT])


def _safety(robot: Agent, tree: Tree, cases: Sequence[CaseDetail]) -> dict[str, dict[str, Any]]:
    """The least safety factor of each link that is a beam, and the case of the lift that governs it."""
    least: dict[str, tuple[float, str]] = {}
    for name, posture in _postures(cases):
        for link, factor in link_safety(replace(robot, tree=tree), posture).items():
            least[link] = min((factor, name), least.get(link, (math.inf, "")))
    return {
        link: {"safety_factor": factor, "safety_case": name}
        for link, (factor, name) in least.items()
        if factor < math.inf
    }


def _alone(robot: Agent, stances: Sequence[StanceCase], tree: Tree) -> Iterator[Asked]:
    model = StanceModel.of(tuple(stances), robot, tuple(actuators_of(tree)))
    for case, found in model.torques(tree) if stances else ():
        yield case.name, {joint: case.factor * torque for joint, torque in found.torques.items()}, True


def _row(joint: str, actuator: Actuator, asked: Sequence[Asked]) -> dict[str, Any]:
    most, by, share, loss, friction = 0.0, "", 0.0, 0.0, actuator.friction
    for name, torques, briefly in asked:
        torque = abs(torques.get(joint, 0.0))
        limit = float(actuator.peak if briefly else actuator.rated)
        if torque / limit > share:
            most, by, share = torque, name, torque / limit
        loss = loss if briefly else max(loss, actuator.loss(torque))
    return {
        "model": actuator.model or None,
        "rated_torque_n_m": float(actuator.rated),
        "peak_torque_n_m": float(actuator.peak),
        "mass_kg": float(actuator.mass),
        "price_eur": actuator.price,
        "asked_n_m": most,
        "asked_by": by,
        "share": share,
        "loss_w": loss,
        "friction_torque_n_m": None if friction is None else float(friction.backdrive),
    }


def _links(space: DesignSpace, tree: Tree) -> tuple[dict[str, Any], float]:
    """What links with walls are made of, and the mass of all walls [kg]."""
    materials = link_materials(space, tree)
    rows, structure = {}, 0.0
    for wall in space.walls:
        for name in wall.links:
            solids = tree.link_by_name[name].solids
            mass = float(sum(solid.mass for solid in solids))
            structure += mass - float(sum(solid.filling for solid in solids))
            thickness = float(solids[0].wall or 0.0)
            rows[name] = {
                "material": materials.get(name),
                "wall_m": thickness,
                "mass_kg": mass,
                "safety_factor": None,
                "safety_case": None,
            }
    return rows, structure


def link_materials(space: DesignSpace, tree: Tree) -> dict[str, str]:
    """The names of materials by link, of walls and of densities that are chosen among materials.

    Args:
        space: of the problem.
        tree: of the design, numbers.
    """
    chosen = {
        link: parameter.nearest(float(tree.link_by_name[link].solids[0].density))[0]
        for parameter in space.parameters
        if parameter.materials
        for link in parameter.links
    }
    walls = {link: wall.material for wall in space.walls if wall.material for link in wall.links}
    return chosen | walls
