"""Files of named designs: the unscaled robot, starting populations; as a user writes them, and as values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.design.parameter import ALLOCATIONS, DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.problem.design_space import refuse_no_choice
from evodesign.problem.source import decode_toml
from evodesign.problem.table import Name, Positive, Table
from evodesign.problem.unknown_names import refuse_unlisted
from evodesign.records import Genome, Parameter
from evodesign.tree.model import Tree


class DesignEntry(Table, frozen=True):
    """`[[design]]` of a population file: values by group; what is left out stays unscaled.

    `material` names the material of a density that has materials, in place of `density_kg_per_m3`; `model`
    that of an actuator that has models, in place of `rated_torque_n_m`.
    """

    name: Name
    length: dict[str, Positive] = msgspec.field(default_factory=dict)
    density_kg_per_m3: dict[str, Positive] = msgspec.field(default_factory=dict)
    allocation: dict[str, float] = msgspec.field(default_factory=dict)
    material: dict[str, Name] = msgspec.field(default_factory=dict)
    wall_m: dict[str, Positive] = msgspec.field(default_factory=dict)
    rated_torque_n_m: dict[str, Positive] = msgspec.field(default_factory=dict)
    margin: dict[str, Positive] = msgspec.field(default_factory=dict)
    section: dict[str, Positive] = msgspec.field(default_factory=dict)
    offset_m: dict[str, float] = msgspec.field(default_factory=dict)
    tilt_rad: dict[str, float] = msgspec.field(default_factory=dict)
    lower_rad: dict[str, float] = msgspec.field(default_factory=dict)
    upper_rad: dict[str, float] = msgspec.field(default_factory=dict)
    model: dict[str, Name] = msgspec.field(default_factory=dict)


class PopulationFile(Table, frozen=True):
    """A whole population file."""

    name: Name
    design: Annotated[tuple[DesignEntry, ...], Meta(min_length=1)]


TABLES = {
    ParameterKind.LENGTH: "length",
    ParameterKind.DENSITY: "density_kg_per_m3",
    ParameterKind.WALL: "wall_m",
    ParameterKind.ACTUATOR: "rated_torque_n_m",
    ParameterKind.MARGIN: "margin",
    ParameterKind.ALLOCATION: "allocation",
    ParameterKind.SECTION: "section",
    ParameterKind.OFFSET: "offset_m",
    ParameterKind.TILT: "tilt_rad",
    ParameterKind.LOWER: "lower_rad",
    ParameterKind.UPPER: "upper_rad",
}
"""A design's table for each kind of parameter."""


def read_designs(text: str, source: str, space: DesignSpace, tree: Tree) -> dict[str, tuple[float, ...]]:
    """Parameter values of every design of a population file, by name; what it leaves out stays unscaled.

    Raises:
        InputError: the file does not decode, names a design twice or an unknown parameter, or has a density
            of no material.
    """
    file = decode_toml(text, source, PopulationFile)
    unscaled = space.named(space.unscaled(tree))
    designs: dict[str, tuple[float, ...]] = {}
    for position, entry in enumerate(file.design):
        key = f"design[{position}]"
        if entry.name in designs:
            raise InputError(source, f"{key}.name", "a unique name", f"'{entry.name}' twice")
        given = _given(entry, source, key, space)
        designs[entry.name] = space.values_of({**unscaled, **given})
    return designs


def _given(entry: DesignEntry, source: str, key: str, space: DesignSpace) -> dict[str, float]:
    known = {parameter.name: parameter for parameter in space.free}
    given: dict[str, float] = {}
    for kind, table in TABLES.items():
        values: dict[str, float] = getattr(entry, table)
        for group, value in values.items():
            name = f"{kind}.{group}"
            groups = [other.split(".", 1)[1] for other in known if other.startswith(f"{kind}.")]
            wanted = f"one of the problem's {kind} parameters"
            refuse_unlisted(source, f"{key}.{table}", group, groups, wanted)
            if kind is ParameterKind.ALLOCATION and not ALLOCATIONS[group].means(value):
                raise InputError(source, f"{key}.{table}.{group}", ALLOCATIONS[group].wanted, f"{value:g}")
            refuse_no_choice(known[name], value, source, f"{key}.{table}.{group}")
            given[name] = value
    for kind, word in CHOSEN.items():
        chosen: dict[str, str] = getattr(entry, word)
        for group, choice in chosen.items():
            name = f"{kind}.{group}"
            given[name] = _value_of(choice, known.get(name), source, f"{key}.{word}.{group}", given)
    return given


def unscaled_genome(space: DesignSpace, tree: Tree) -> Genome | None:
    """The file's own robot as a genome; None where it lies outside the bounds or is none of the choices."""
    values = space.unscaled(tree)
    genome = space.genome(values)
    inside = all(0.0 <= coordinate <= 1.0 for coordinate in genome)
    return genome if inside and alike(space.values(genome), values) else None


def beyond_bounds(parameters: Sequence[Parameter], values: Sequence[float]) -> dict[str, str]:
    """A sentence about each parameter whose value no search would propose, by its name.

    Args:
        parameters: of the problem.
        values: one for each, in its unit; those that are a choice are within bounds.
    """
    found = {}
    for each, value in zip(parameters, values, strict=True):
        tolerance = 1e-9 * (each.upper - each.lower)  # of values that come from a genome
        within = each.lower - tolerance <= value <= each.upper + tolerance
        if not within and value not in each.choices:
            unit = "" if each.unit == "1" else f" {each.unit}"
            bounds = f"{each.lower:g} to {each.upper:g}{unit}"
            found[each.name] = f"{each.name} = {value:.9g}{unit} is beyond its bounds, {bounds}"
    return found


def alike(values: Iterable[float], others: Iterable[float]) -> bool:
    """Whether parameters have the same values but for rounding."""
    return all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12) for a, b in zip(values, others, strict=True))


CHOSEN = {ParameterKind.DENSITY: "material", ParameterKind.ACTUATOR: "model"}
"""A design's table of choices by name, for each kind that has choices."""


def _value_of(
    choice: str, parameter: DesignParameter | None, source: str, key: str, given: Mapping[str, float]
) -> float:
    """The value of a material or model that a design names for a parameter."""
    word, figure = key.split(".")[1], "density" if ".material." in key else "rated torque"
    if parameter is None or not parameter.choices:
        raise InputError(source, key, f"a parameter that has {word}s", f"'{choice}' for another")
    if parameter.name in given:
        raise InputError(source, key, f"either a {word} or a {figure}", "both")
    values = dict(zip(parameter.choice_names, parameter.choices, strict=True))
    refuse_unlisted(source, key, choice, values)
    return values[choice]


def designs_text(name: str, designs: Mapping[str, Sequence[float]], space: DesignSpace, remark: str) -> str:
    """A population file that `read_designs` reads back to the same numbers.

    Args:
        name: of the file's population.
        designs: parameter values by name.
        space: the parameters.
        remark: a line of comment.
    """
    lines = [f"# {remark}", f"name = {_quoted(name)}"]
    for design, values in designs.items():
        lines += ["", "[[design]]", f"name = {_quoted(design)}"]
        for kind, table in TABLES.items():
            given = [
                f"{_quoted(parameter.group)} = {float(value)!r}"
                for parameter, value in zip(space.parameters, values, strict=True)
                if parameter.kind is kind and not parameter.is_fixed
            ]
            if given:
                lines.append(f"{table} = {{ {', '.join(given)} }}")
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    """A TOML basic string; its escapes are those of JSON."""
    return msgspec.json.encode(text).decode()


def start_genomes(
    designs: Mapping[str, tuple[float, ...]], space: DesignSpace, source: str
) -> tuple[Genome, ...]:
    """Genomes of designs that a search begins with.

    Raises:
        InputError: a design lies outside the bounds of the problem, or has a density of no material.
    """
    genomes = []
    for name, values in designs.items():
        for parameter, value in zip(space.parameters, values, strict=True):
            refuse_no_choice(parameter, value, source, f"design '{name}'")
            if not parameter.lower <= value <= parameter.upper:
                wanted = f"{parameter.name} within [{parameter.lower:g}, {parameter.upper:g}]"
                raise InputError(source, f"design '{name}'", wanted, f"{value:g}")
        genomes.append(space.genome(values))
    return tuple(genomes)
