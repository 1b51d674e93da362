"""The bill of materials for people: one row for each group of joints that share an actuator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from evodesign.cli.output import printable, rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled


def mass_title(bill: Mapping[str, Any]) -> str:
    """The masses of a bill in words."""
    parts = (f"{name} {rounded(bill['mass_kg'][name])}" for name in ("actuators", "structure", "rest"))
    return f"hardware ({rounded(bill['mass_kg']['total'])} kg: {', '.join(parts)})"


def clearance_in_words(bill: Mapping[str, Any]) -> str:
    """Which parts of a bill have least room; empty where no actuator is a body."""
    if (least := bill.get("least_clearance")) is None:
        return ""
    one, other = least["parts"]
    fit = "" if least["clearance_m"] >= 0.0 else " too little"
    return f"{one} and {other} have least room: {abs(1e3 * least['clearance_m']):.2g} mm{fit}"


def captions(bill: Mapping[str, Any]) -> str:
    """What governs walls and actuators, and which parts have least room; a line each."""
    return "\n".join(printable(each) for each in (clearance_in_words(bill), *bill["governs"]) if each)


def actuators_table(bill: Mapping[str, Any]) -> FittedTable:
    """The masses of a bill of materials, and its actuators, each with the joint that is used most."""
    columns = [
        *names("actuator"),
        *numbers("joints", "rated [N m]", "peak [N m]", "kg each", "used"),
        *names("most by", "joint"),
    ]
    table = titled(mass_title(bill), columns, caption=captions(bill))
    groups: dict[str, dict[str, Mapping[str, Any]]] = {}
    for joint, row in bill["joints"].items():
        groups.setdefault(row["actuator"], {})[joint] = row
    for group, rows in groups.items():
        worst = max(rows, key=lambda joint: rows[joint]["share"])
        row = rows[worst]
        model = f" ({row['model']})" if row["model"] else ""
        table.add_row(
            group + model,
            f"{len(rows)}",
            row["rated_torque_n_m"],
            row["peak_torque_n_m"],
            row["mass_kg"],
            f"{row['share']:.0%}",
            row["asked_by"],
            worst,
        )
    return table
