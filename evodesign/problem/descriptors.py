"""Descriptors of `[[search.descriptor]]`: their names checked, and bounds of parameters filled in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from evodesign.design.parameter import DesignParameter
from evodesign.errors import InputError, nearest_name
from evodesign.problem.file import DescriptorTable
from evodesign.records import SUM, Constraint, Descriptor, Objective

LOWEST_REACH = "lowest_reach"
REACHES = (LOWEST_REACH, "highest_reach")
TORQUES = ("robot_torque", "human_torque")


def search_descriptors(
    tables: Sequence[DescriptorTable],
    parameters: Sequence[DesignParameter],
    quantities: Iterable[Objective | Constraint],
    tasks: Iterable[str],
    source: str,
) -> tuple[Descriptor, ...] | msgspec.UnsetType:
    """The descriptors of a search; sums of parameters have the sums of their bounds where none are given.

    Args:
        tables: of the file.
        parameters: of the design.
        quantities: objectives and constraints.
        tasks: their names, with which torques have names.
        source: the file, for messages.
    Raises:
        InputError: an unknown name, the same descriptor twice, or bounds that hold nothing.
    """
    bounds = {each.name: (each.lower, each.upper) for each in parameters}
    torques = [f"{name}@{task}" for task in tasks for name in TORQUES]
    known = [*bounds, *dict.fromkeys(each.name for each in quantities), *REACHES, *torques]
    found: list[Descriptor] = []
    for index, table in enumerate(tables):
        key, names = f"search.descriptor[{index}]", table.name.split(SUM)
        for name in names:
            if name not in known:
                wanted = f"a sum such as 'a{SUM}b' of {', '.join(known)}"
                raise InputError(source, f"{key}.name", wanted, f"'{name}'{nearest_name(name, known)}")
        if table.name in [each.name for each in found]:
            raise InputError(source, f"{key}.name", "every descriptor once", f"'{table.name}' twice")
        lower, upper = table.lower, table.upper
        if all(name in bounds for name in names):
            lower = sum(bounds[name][0] for name in names) if lower is None else lower
            upper = sum(bounds[name][1] for name in names) if upper is None else upper
        if lower is not None and upper is not None and lower >= upper:
            raise InputError(source, f"{key}.upper", f"more than the lower bound {lower:g}", f"{upper:g}")
        found.append(Descriptor(table.name, lower, upper, table.cells))
    return tuple(found) or msgspec.UNSET
