"""The disturbances of a problem file."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.errors import InputError
from evodesign.mechanics.disturbance import Disturbance, Disturbances, PushedAt
from evodesign.mechanics.scene import Agent, Payload
from evodesign.problem.file import DisturbanceTable, ProblemFile
from evodesign.records import ProblemSource

__all__ = ["scene_disturbances"]


def scene_disturbances(
    tables: ProblemFile, source: ProblemSource, agents: Sequence[Agent], payloads: Sequence[Payload]
) -> Disturbances:
    """What may happen to every load and to those who hold it.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        agents: robot and people.
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
        _refuse_trunkless(table, agents, f"{key}.at", source)
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


def _refuse_trunkless(
    table: DisturbanceTable, agents: Sequence[Agent], key: str, source: ProblemSource
) -> None:
    for agent in agents:
        if table.at is PushedAt(agent.name) and not agent.trunk:
            wanted = f"a trunk to push: frames in {agent.name}.trunk"
            raise InputError(source.path, key, wanted, "none")
