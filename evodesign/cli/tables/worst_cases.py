"""What joints and contacts bear in the cases of a design, where there are too many for a column each."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from rich.table import Table

from evodesign.cli.output import figure, shown
from evodesign.records import AgentDetail, CaseDetail
from evodesign.report.subset import ranked_joints

__all__ = ["JOINTS_SHOWN", "worst_forces", "worst_torques"]

JOINTS_SHOWN = 6
"""Rows of joints per agent; the others bear less."""

CONTACTS = ("hand", "foot")


def worst_torques(cases: Sequence[CaseDetail]) -> Table:
    """The joints that bear most: the mean size of their torques, the largest torque, and in which case."""
    table = _table("agent", "joint", ("mean size", "worst"))
    for agent in cases[0].agents:
        torques = [detail.agents[agent].torques_n_m for detail in cases]
        joints = ranked_joints(torques)[:JOINTS_SHOWN]
        for joint in joints:
            _add(table, agent, joint, cases, [by[joint] for by in torques], last=joint == joints[-1])
    return table


def worst_forces(cases: Sequence[CaseDetail]) -> Table:
    """Sizes of the forces on hands and feet: the mean, the largest, and in which case."""
    table = _table("agent", "contact", ("mean", "largest"))
    for agent in cases[0].agents:
        postures = [detail.agents[agent] for detail in cases]
        contacts = [(part, side) for part in CONTACTS for side in _wrenches(part)(postures[0])]
        for part, side in contacts:
            forces = [math.hypot(*_wrenches(part)(posture)[side][:3]) for posture in postures]
            _add(table, agent, f"{side} {part}", cases, forces, last=(part, side) == contacts[-1])
    return table


def _add(
    table: Table,
    agent: str,
    name: str,
    cases: Sequence[CaseDetail],
    values: Sequence[float],
    *,
    last: bool,
) -> None:
    worst = max(range(len(values)), key=lambda case: abs(values[case]))
    table.add_row(
        agent,
        shown(name),
        figure(sum(map(abs, values)) / len(values)),
        figure(values[worst]),
        shown(cases[worst].case.name),
        end_section=last,
    )


def _wrenches(part: str) -> Callable[[AgentDetail], dict[str, tuple[float, ...]]]:
    if part == "hand":
        return lambda posture: posture.hand_wrenches
    return lambda posture: posture.foot_wrenches


def _table(agent: str, named: str, numbers: tuple[str, str]) -> Table:
    table = Table()
    for column in (agent, named):
        table.add_column(column, overflow="fold")
    for column in numbers:
        table.add_column(column, justify="right")
    table.add_column("in the case", overflow="fold")
    return table
