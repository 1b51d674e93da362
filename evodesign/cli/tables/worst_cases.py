"""Joint torques and contact forces: at each height, or of many cases the worst."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import AgentDetail, CaseDetail
from evodesign.report.subset import ranked_joints
from evodesign.tree.words import in_words

JOINTS_SHOWN = 6
"""Rows of joints per agent; the others have smaller torques."""

ValuesOf = Callable[[Sequence[AgentDetail]], dict[str, Sequence[float | None]]]
"""From an agent's postures to the values of each row of a table."""


def moment_tables(cases: Sequence[CaseDetail]) -> tuple[FittedTable, FittedTable]:
    """The largest joint torques [N m], and the sizes of the forces on hands and feet [N].

    Where there is one person with one load, at each height; else the mean size, the largest value, and in
    which case it is.
    """
    torques, forces = "largest joint torques [N m]", "contact forces [N]"
    if any(detail.case.label for detail in cases):
        return (
            _worst(torques, "joint", ("mean size", "worst"), cases, largest_torques),
            _worst(forces, "contact", ("mean", "largest"), cases, contact_forces),
        )
    return (
        _by_height(torques, "joint", cases, largest_torques),
        _by_height(forces, "contact", cases, contact_forces),
    )


def largest_torques(postures: Sequence[AgentDetail]) -> dict[str, Sequence[float | None]]:
    """Torques of the joints of largest torque, posture by posture; None where a person lacks the joint."""
    torques = [posture.torques_n_m for posture in postures]
    shown = ranked_joints(torques)[:JOINTS_SHOWN]
    return {in_words(joint): [by.get(joint) for by in torques] for joint in shown}


def contact_forces(postures: Sequence[AgentDetail]) -> dict[str, Sequence[float | None]]:
    """Size of the force at each contact, posture by posture."""
    return {
        name.replace("_", " "): [math.hypot(*posture.wrenches[name][:3]) for posture in postures]
        for name in postures[0].wrenches
    }


def _rows(
    cases: Sequence[CaseDetail], values_of: ValuesOf
) -> Iterator[tuple[str, str, Sequence[float | None], bool]]:
    """Agent, name and values of each row, and whether it is the agent's last one."""
    for agent in cases[0].agents:
        found = values_of([detail.agents[agent] for detail in cases])
        for name, values in found.items():
            yield agent, name, values, name == [*found][-1]


def _by_height(title: str, named: str, cases: Sequence[CaseDetail], values_of: ValuesOf) -> FittedTable:
    columns = [*names("agent", named), *numbers(*(detail.place for detail in cases))]
    table = titled(title, columns, keys=2)
    for agent, name, values, last in _rows(cases, values_of):
        table.add_row(agent, name, *values, end_section=last)
    return table


def _worst(
    title: str, named: str, measured: tuple[str, str], cases: Sequence[CaseDetail], values_of: ValuesOf
) -> FittedTable:
    columns = [*names("agent", named), *numbers(*measured), *names("in the case")]
    table = titled(title, columns, keys=2)
    for agent, name, values, last in _rows(cases, values_of):
        known = [(value, detail) for value, detail in zip(values, cases, strict=True) if value is not None]
        worst, where = max(known, key=lambda found: abs(found[0]))
        mean = sum(abs(value) for value, _ in known) / len(known)
        case = where.case.name
        table.add_row(agent, name, mean, worst, case, end_section=last)
    return table
