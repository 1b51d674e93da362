"""Densities of a problem file: within bounds, or those of materials from a catalogue.

The catalogue is `body.material.CATALOGUE` and the problem's own `[[material]]` tables together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from evodesign.body.material import CATALOGUE, Material
from evodesign.design.space import DesignParameter, DesignSpace, ParameterKind
from evodesign.errors import InputError, nearest_name
from evodesign.problem.file import DensityTable, ProblemFile
from evodesign.records import ProblemSource

__all__ = ["density_parameters", "known_materials", "refuse_choices", "refuse_no_choice"]

BOUNDS = ("lower_kg_per_m3", "upper_kg_per_m3")


def known_materials(tables: ProblemFile, source: ProblemSource) -> Mapping[str, Material]:
    """All materials that a problem may name.

    Raises:
        InputError: a material of a name that is taken.
    """
    known = dict(CATALOGUE)
    for position, table in enumerate(tables.material):
        if table.name in known:
            where = "the catalogue" if table.name in CATALOGUE else "an earlier [[material]]"
            key = f"material[{position}].name"
            raise InputError(source.path, key, "a new name", f"'{table.name}', which is in {where}")
        known[table.name] = Material(table.name, table.density_kg_per_m3, table.source)
    return known


def density_parameters(tables: ProblemFile, source: ProblemSource) -> list[DesignParameter]:
    """The parameters of the `[[design.density]]` tables.

    Raises:
        InputError: neither bounds nor materials, both of them, or materials between which there is no choice.
    """
    known = known_materials(tables, source)
    return [
        _parameter(table, f"design.density[{position}]", source, known)
        for position, table in enumerate(tables.design.density)
    ]


def _parameter(
    table: DensityTable, key: str, source: ProblemSource, known: Mapping[str, Material]
) -> DesignParameter:
    lower, upper = (getattr(table, bound) for bound in BOUNDS)
    if table.materials is not None:
        if lower is not None or upper is not None:
            raise InputError(source.path, f"{key}.materials", "either materials or bounds", "both")
        chosen = _chosen(table.materials, f"{key}.materials", source, known)
        ends = (chosen[0].density, chosen[-1].density)
        return DesignParameter(ParameterKind.DENSITY, table.name, table.links, *ends, chosen)
    if lower is None or upper is None:
        missing = BOUNDS[0] if lower is None else BOUNDS[1]
        raise InputError(source.path, f"{key}.{missing}", "this key, or materials", "nothing")
    return DesignParameter(ParameterKind.DENSITY, table.name, table.links, lower, upper)


def _chosen(
    names: Sequence[str], key: str, source: ProblemSource, known: Mapping[str, Material]
) -> tuple[Material, ...]:
    """Materials by name, the lightest first."""
    if len(names) < 2:
        raise InputError(source.path, key, "at least two materials", f"{len(names)}")
    for position, name in enumerate(names):
        where = f"{key}[{position}]"
        if name not in known:
            wanted = "a material of the catalogue or of a [[material]] table"
            raise InputError(source.path, where, wanted, f"'{name}'{nearest_name(name, known)}")
        if name in names[:position]:
            raise InputError(source.path, where, "each material once", f"'{name}' twice")
    chosen = sorted((known[name] for name in names), key=lambda material: material.density)
    for one, other in pairwise(chosen):
        if one.density == other.density:
            found = f"'{one.name}' and '{other.name}', both of {one.density:g} kg/m^3"
            raise InputError(source.path, key, "materials of different densities", found)
    return tuple(chosen)


def refuse_choices(space: DesignSpace, source: ProblemSource) -> None:
    """Refuse materials for the paper's joint problem, in which densities are variables.

    Raises:
        InputError: naming a parameter.
    """
    for parameter in space.parameters:
        if parameter.choices:
            wanted = (
                f"bounds of {parameter.name} instead of materials for the baseline, which moves it smoothly"
            )
            raise InputError(source.path, "design.density", wanted, f"{len(parameter.choices)} materials")


def refuse_no_choice(parameter: DesignParameter, value: float, source: str, key: str) -> None:
    """Refuse a density that is none of a parameter's materials.

    Args:
        parameter: one without materials takes any value.
        value: [kg/m^3].
        source: the file, for messages.
        key: where in it.
    Raises:
        InputError: naming the nearest material.
    """
    if parameter.choices and value not in parameter.choices:
        near = parameter.nearest(value)
        wanted = f"the density of a material of {parameter.name}"
        found = f"{value:g} kg/m^3; the nearest material is '{near.name}' with {near.density:g}"
        raise InputError(source, key, wanted, found)
