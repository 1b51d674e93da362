"""Files of named designs: the unscaled robot, starting populations."""

from __future__ import annotations

from collections.abc import Mapping

from evodesign.design.space import DesignSpace, ParameterKind
from evodesign.errors import InputError, nearest_name
from evodesign.problem.decode import decode_toml
from evodesign.problem.file import DesignEntry, PopulationFile
from evodesign.records import Genome
from evodesign.tree.model import Tree

__all__ = ["read_designs", "start_genomes"]


def read_designs(text: str, source: str, space: DesignSpace, tree: Tree) -> dict[str, tuple[float, ...]]:
    """Parameter values of every design of a population file, by name; what it leaves out stays unscaled.

    Raises:
        InputError: the file does not decode, names a design twice, or names an unknown parameter.
    """
    file = decode_toml(text, source, PopulationFile)
    unscaled = space.named(space.unscaled(tree))
    designs: dict[str, tuple[float, ...]] = {}
    for position, entry in enumerate(file.design):
        key = f"design[{position}]"
        if entry.name in designs:
            raise InputError(source, f"{key}.name", "a unique name", f"'{entry.name}' twice")
        given = _given(entry, source, key, unscaled)
        designs[entry.name] = tuple({**unscaled, **given}.values())
    return designs


def _given(entry: DesignEntry, source: str, key: str, known: Mapping[str, float]) -> dict[str, float]:
    tables = {
        ParameterKind.LENGTH: ("length", entry.length),
        ParameterKind.DENSITY: ("density_kg_per_m3", entry.density_kg_per_m3),
    }
    given: dict[str, float] = {}
    for kind, (table, values) in tables.items():
        for group, value in values.items():
            name = f"{kind}.{group}"
            if name not in known:
                groups = [other.split(".", 1)[1] for other in known if other.startswith(f"{kind}.")]
                found = f"'{group}'{nearest_name(group, groups)}"
                raise InputError(source, f"{key}.{table}", f"a {kind} parameter of the problem", found)
            given[name] = value
    return given


def start_genomes(
    designs: Mapping[str, tuple[float, ...]], space: DesignSpace, source: str
) -> tuple[Genome, ...]:
    """Genomes of designs that a search begins with.

    Raises:
        InputError: a design lies outside the bounds of the problem.
    """
    genomes = []
    for name, values in designs.items():
        for parameter, value in zip(space.parameters, values, strict=True):
            if not parameter.lower <= value <= parameter.upper:
                wanted = f"{parameter.name} within [{parameter.lower:g}, {parameter.upper:g}]"
                raise InputError(source, f"design '{name}'", wanted, f"{value:g}")
        genomes.append(space.genome(values))
    return tuple(genomes)
