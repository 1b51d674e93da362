"""The bill of materials of a design in the page: actuators by group, links with walls, masses."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from evodesign.evaluation.bill import bill_of_materials
from evodesign.mechanics.agent import ROBOT
from evodesign.problem.build import DesignProblem
from evodesign.records import CaseDetail
from evodesign.report.page.content import ActuatorContent, HardwareContent, WallContent
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree


def hardware_content(
    problem: DesignProblem, tree: Tree, cases: Sequence[CaseDetail]
) -> HardwareContent | None:
    """What a design is built of; None for a problem without hardware.

    Args:
        problem: whose design it is.
        tree: of the design, numbers.
        cases: its postures.
    """
    bill = bill_of_materials(problem, tree, cases)
    if not bill:
        return None
    groups: dict[str, dict[str, Mapping[str, Any]]] = {}
    for joint, row in bill["joints"].items():
        groups.setdefault(row["actuator"], {})[joint] = row
    return HardwareContent(
        actuators=tuple(_actuator(name, rows, tree, cases) for name, rows in groups.items()),
        walls=tuple(
            WallContent(link, *(row[key] for key in WallContent.__struct_fields__[1:]))
            for link, row in bill["links"].items()
        ),
        mass_kg=bill["mass_kg"],
        governs=tuple(bill["governs"]),
        least_clearance=bill.get("least_clearance"),
    )


def _actuator(
    name: str, rows: Mapping[str, Mapping[str, Any]], tree: Tree, cases: Sequence[CaseDetail]
) -> ActuatorContent:
    """A group of joints with the same actuator, told by the joint that is used most."""
    joint = max(rows, key=lambda each: rows[each]["share"])
    row, actuator = rows[joint], actuators_of(tree)[joint]
    duty, warming = actuator.duty, actuator.motor(_held(rows, cases)).value
    return ActuatorContent(
        name=name,
        model=row["model"] or "",
        count=len(rows),
        rated_torque_n_m=row["rated_torque_n_m"],
        peak_torque_n_m=row["peak_torque_n_m"],
        mass_kg=row["mass_kg"],
        price_eur=row["price_eur"],
        joint=joint,
        asked_n_m=row["asked_n_m"],
        asked_by=row["asked_by"],
        share=row["share"],
        loss_w=sum(each["loss_w"] for each in rows.values()),
        winding_c=None if duty is None else duty.temperature(warming / row["rated_torque_n_m"]),
        winding_limit_c=None if duty is None else duty.limit,
    )


def _held(joints: Collection[str], cases: Sequence[CaseDetail]) -> float:
    """The largest torque of some of the robot's joints in any case, disturbed or not [N m]."""
    held = []
    for instant in (instant for case in cases for instant in case.instants):
        held.append(instant.agents[ROBOT].torques_n_m)
        held += [agents[ROBOT].torques_n_m for agents in instant.disturbed.values()]
    return max((abs(torques.get(joint, 0.0)) for torques in held for joint in joints), default=0.0)
