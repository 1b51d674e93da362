"""The loads of a problem file, and the disturbances under which they are held."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from evodesign.body.placement import Vector
from evodesign.errors import InputError
from evodesign.mechanics.agent import HUMAN, ROBOT, SIDES, TO_THE_LEFT, Agent
from evodesign.mechanics.disturbance import Disturbance, Disturbances, PushedAt
from evodesign.mechanics.elbow import elbow
from evodesign.mechanics.payload import WRIST_MOMENT, Grasp, GraspDirection, Payload
from evodesign.problem.file import ProblemFile
from evodesign.problem.task_tables import DisturbanceTable, PayloadTable
from evodesign.problem.unknown_names import refuse_unlisted
from evodesign.records import ProblemSource

FROM_CORNERS = 0.25
"""How far hands are from the middle of their side where somebody stands at a neighbouring one, in widths."""

GRASP_CONE = math.radians(60.0)
"""Largest angle of a forearm from the direction of the grasp [rad]: about what a wrist bends."""


def payloads(tables: ProblemFile, source: ProblemSource) -> tuple[Payload, ...]:
    """The loads of the `payload` tables; where there are several, each has a label of its own.

    Raises:
        InputError: a centre of mass outside the box, a moment of point grasps, or two loads of one name or of
            different grasps.
    """
    loads = [_payload(key, table, source) for key, table in tables.loads.items()]
    if len(loads) == 1:
        return tuple(loads)
    labelled: list[Payload] = []
    for (key, table), load in zip(tables.loads.items(), loads, strict=True):
        label = table.name or f"{load.mass:g} kg"
        if any(other.label == label for other in labelled):
            raise InputError(source.path, f"{key}.name", "a name of its own", f"'{label}' twice")
        if load.grasp is not loads[0].grasp:  # programs and their starts are those of all loads
            wanted = f"'{loads[0].grasp}', the grasp of the first load"
            raise InputError(source.path, f"{key}.grasp", wanted, f"'{load.grasp}'")
        labelled.append(replace(load, label=label))
    return tuple(labelled)


def _payload(key: str, table: PayloadTable, source: ProblemSource) -> Payload:
    for axis, (offset, size) in enumerate(zip(table.center_of_mass_m, table.size_m, strict=True)):
        if abs(offset) > size / 2.0:
            where = f"{key}.center_of_mass_m[{axis}]"
            raise InputError(source.path, where, f"a point in the box, at most {size / 2.0:g}", f"{offset:g}")
    points = {
        (agent, f"{side}_hand"): getattr(grasps, side)
        for agent, grasps in ((ROBOT, table.robot_grasps_m), (HUMAN, table.human_grasps_m))
        if grasps is not None
        for side in SIDES
        if getattr(grasps, side) is not None
    }
    moment = _hand_moment(key, table, source)
    return Payload(
        size=table.size_m,
        mass=table.mass_kg,
        center_of_mass=table.center_of_mass_m,
        grasp=table.grasp,
        hand_moment=moment,
        grasp_points=points,
        grasp_direction=table.grasp_direction,
        grasp_cone=_grasp_cone(key, table, source),
    )


def held_by(load: Payload, team: Sequence[Agent]) -> Payload:
    """A load as a team holds it, where the file does not say where.

    Who holds it alone does so by the middles of its sides: hands in points on its near edge would not balance
    it. One hand is in the middle: of the top, or of the near edge beside others. Who has somebody at a
    neighbouring side keeps away from the corner between them.
    """
    points: dict[tuple[str, str], Vector] = {}
    for agent in team:
        depth, width, height = load.faced(agent)
        ahead, up, out = -depth / 2.0, height / 2.0, FROM_CORNERS * width
        if len(team) == 1:
            ahead, up, out = (0.0, 0.0, width / 2.0) if len(agent.hands) > 1 else (0.0, up, 0.0)
        elif len(agent.hands) == 1:
            out = 0.0
        elif not any((each.quarters - agent.quarters) % 2 for each in team):
            continue
        for hand in agent.hands:
            points[agent.name, hand.name] = agent.to_world((ahead, out * TO_THE_LEFT[hand.side], up))
    return replace(load, grasp_points={**points, **load.grasp_points})


def _grasp_cone(key: str, table: PayloadTable, source: ProblemSource) -> float:
    """Largest angle of a forearm from the direction of the grasp [rad]."""
    if table.grasp_cone_deg is None:
        return GRASP_CONE
    if table.grasp_direction is GraspDirection.FREE:
        wanted, found = "a grasp_direction with it", f"{table.grasp_cone_deg:g} for free forearms"
        raise InputError(source.path, f"{key}.grasp_cone_deg", wanted, found)
    return math.radians(table.grasp_cone_deg)


def _hand_moment(key: str, table: PayloadTable, source: ProblemSource) -> float:
    """Largest moment of a hand [N m]: infinite where `inf` is written, and for point grasps."""
    if table.hand_moment_n_m is None:
        return WRIST_MOMENT if table.grasp is Grasp.RIGID else math.inf
    if table.grasp is Grasp.POINT:
        found = f"{table.hand_moment_n_m:g} for point grasps, which pass no moment"
        raise InputError(source.path, f"{key}.hand_moment_n_m", "grasp = 'rigid' with it", found)
    return table.hand_moment_n_m


def refuse_stiff_arms(source: ProblemSource, loads: Sequence[Payload], agents: Sequence[Agent]) -> None:
    """Refuse a direction of the grasp where an arm has no elbow.

    Raises:
        InputError: no joint between the trunk and a hand bends the arm.
    """
    if all(load.grasp_direction is GraspDirection.FREE for load in loads):
        return
    for agent in agents:
        for hand in agent.hands:
            if elbow(agent, hand) is None:
                wanted = f"'free', or an arm of '{agent.tree.name}' that bends"
                found = f"no moving joint between the trunk and '{hand.frame}'"
                raise InputError(source.path, "payload.grasp_direction", wanted, found)


def scene_disturbances(
    tables: ProblemFile, source: ProblemSource, agents: Sequence[Agent], payloads: Sequence[Payload]
) -> Disturbances:
    """What may happen to every load and to those who hold it.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        agents: robots and people.
        payloads: all loads.
    Raises:
        InputError: a name that is there twice, a centre of mass outside a box, a push on no trunk.
    """
    cases: list[Disturbance] = []
    for position, table in enumerate(tables.disturbance):
        key = f"disturbance[{position}]"
        disturbance = Disturbance(
            name=table.name or f"disturbance_{position + 1}",
            mass_share=table.load_mass_share,
            center_of_mass=table.center_of_mass_m,
            push=table.push_n,
            at=table.at,
        )
        if disturbance.name in [other.name for other in cases]:
            raise InputError(source.path, f"{key}.name", "a unique name", f"'{disturbance.name}' twice")
        for payload in payloads:
            _refuse_outside(disturbance, payload, f"{key}.center_of_mass_m", source)
        _refuse_unpushed(table, agents, f"{key}.at", source)
        cases.append(disturbance)
    return Disturbances(tuple(cases), tables.task.disturbed_effort)


def _refuse_outside(disturbance: Disturbance, payload: Payload, key: str, source: ProblemSource) -> None:
    centers = payload.disturbed(disturbance).center_of_mass
    for axis, (center, size) in enumerate(zip(centers, payload.size, strict=True)):
        if abs(center) > size / 2.0:
            wanted = (
                f"a shift that leaves the centre of mass in the box, at most {size / 2.0:g} from its middle"
            )
            raise InputError(source.path, f"{key}[{axis}]", wanted, f"{center:g} from it")


def _refuse_unpushed(
    table: DisturbanceTable, agents: Sequence[Agent], key: str, source: ProblemSource
) -> None:
    names = [PushedAt.LOAD.value, *dict.fromkeys(agent.name for agent in agents)]
    refuse_unlisted(source.path, key, table.at, names)
    for agent in agents:
        if table.at == agent.name and not agent.trunk:
            wanted = f"a trunk to push: frames in {agent.name}.trunk"
            raise InputError(source.path, key, wanted, "none")
