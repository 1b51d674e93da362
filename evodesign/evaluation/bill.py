"""The bill of materials of a design: what drives each joint and what asks most of it, and what links are of.

    {"joints": {joint: {"actuator": group, "model": name or null, "rated_torque_n_m", "peak_torque_n_m",
                        "mass_kg", "price_eur": or null, "asked_n_m", "asked_by": case,
                        "share": of rated or peak torque, "loss_w": largest copper loss of the lift,
                        "friction_torque_n_m": that turns it without current, or null}},
     "links": {link: {"material": name, "wall_m", "mass_kg": without actuators,
                      "least_wall_m": that can be made, "safety_factor", "safety_mode", "safety_case",
                      "deflection_share": of that of the hands in the case in which it is largest,
                      these four null of a link that is no beam,
                      "governed_by": the mode, "stiffness", "least wall", "problem file" or "design"}},
     "governs": sentences on walls and on actuators,
     "mass_kg": {"actuators", "structure", "rest", "total"},
     "least_clearance": {"parts": two names, "clearance_m": negative where they do not go together}}

What is asked by a load case is its factor times the torque, and its share that of peak torque; by a case of
the lift, of rated torque. Structure is the walls' own mass. Least room is told where actuators are bodies
(`collision.parts`). What governs is `evaluation.governs`. A problem without actuators and walls has none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from evodesign.collision.parts import part_clearance
from evodesign.design.space import DesignSpace
from evodesign.evaluation.governs import governing, sentences
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.hardware.actuators import Actuator
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.mechanics.link_beams import Safety
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem
from evodesign.quantities.hardware_quantities import deflection_shares, link_safety
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
    robot = replace(problem.scene.robot, tree=tree)
    alone = (
        StanceModel.of(problem.stances, problem.scene.robot, tuple(actuators)) if problem.stances else None
    )
    asked = [*_lifted(cases), *(_alone(alone, tree) if alone else ())]
    groups = {joint: parameter.group for parameter in space.parameters for joint in parameter.joints}
    joints = {
        joint: {"actuator": groups[joint], **_row(joint, each, asked)} for joint, each in actuators.items()
    }
    links, structure = _links(space, tree)
    if links:
        for name, safety in _safety(robot, alone, cases).items():
            links[name] |= safety
        deflections = _deflect(robot, cases, links)
        for name, by in governing(problem, links, deflections).items():
            links[name]["governed_by"] = by
    total = float(tree.mass)
    mass = float(sum(each.mass for each in actuators.values()))
    split = {"actuators": mass, "structure": structure, "rest": total - mass - structure, "total": total}
    bill: dict[str, Any] = {"joints": joints, "links": links, "mass_kg": split}
    bill["governs"] = [*sentences(problem, bill)]
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


def _safety(
    robot: Agent, alone: StanceModel | None, cases: Sequence[CaseDetail]
) -> dict[str, dict[str, Any]]:
    """The least safety factor of each link that is a beam, how it gives way, and in which case."""
    found = [(name, link_safety(robot, posture)) for name, posture in _postures(cases)]
    found += alone.safety(robot.tree) if alone else ()
    least: dict[str, tuple[Safety, str]] = {}
    for name, links in found:
        for link, safety in links.items():
            least[link] = min((safety, name), least.get(link, (safety, name)))
    return {
        link: {"safety_factor": safety.factor, "safety_mode": safety.failure.value, "safety_case": name}
        for link, (safety, name) in least.items()
    }


def _deflect(
    robot: Agent, cases: Sequence[CaseDetail], links: Mapping[str, dict[str, Any]]
) -> dict[str, float]:
    """The deflection of the hands in every case [mm]; links are told their share of the largest."""
    found = {name: deflection_shares(robot, posture) for name, posture in _postures(cases)}
    if found:
        largest = max(found.values(), key=lambda each: each.total)
        for link, part in largest.links.items():
            links[link]["deflection_share"] = part / largest.total
    return {name: 1e3 * each.total for name, each in found.items()}


def _alone(model: StanceModel, tree: Tree) -> Iterator[Asked]:
    for case, found in model.torques(tree):
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
                "least_wall_m": wall.least,
                **dict.fromkeys(("safety_factor", "safety_mode", "safety_case", "deflection_share")),
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
