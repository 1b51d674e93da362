"""The JSON Schema of a problem file, made of the tables that decode it, and the same as rows for a page.

A key's type, default and range are the table's own, its unit follows from how the key ends, and what it does
stands in the table's docstring, under `Attributes`. TOML has no null: where a table says None, the key is
left out. Names of quantities are those of the registry.

Source: JSON Schema 2020-12.
"""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import msgspec

from evodesign.problem.constraints import constraint_key
from evodesign.problem.file import BoundsTable, ProblemFile
from evodesign.problem.table import FILL_IN, struct_in
from evodesign.quantities.design_result import WORST
from evodesign.quantities.meanings import MEANINGS
from evodesign.quantities.objectives import QUANTITIES, objective_kinds
from evodesign.searches.registry import SEARCHES

Schema = dict[str, Any]
TableType = type[msgspec.Struct]

UNITS: Mapping[str, str] = {
    "n_m_per_a": "N m/A",
    "kg_per_m3": "kg/m^3",
    "k_per_w": "K/W",
    "kg_cm2": "kg cm^2",
    "kg_m2": "kg m^2",
    "n_m": "N m",
    "percent": "%",
    "deg": "deg",
    "eur": "EUR",
    "ohm": "ohm",
    "rad": "rad",
    "rpm": "1/min",
    "hours": "h",
    "hour": "1/h",
    "seconds": "s",
    "gb": "GB",
    "kg": "kg",
    "c": "deg C",
    "h": "h",
    "m": "m",
    "n": "N",
    "s": "s",
    "w": "W",
}
"""Units by how a key ends."""

SINCE = re.compile(r" Since (\d+\.\d+)\.$")
SCHEMA_FILE, SCHEMA_LINE = "evodesign.schema.json", "#:schema"
"""Name of the schema's file beside a problem, and how the line begins that names it; source: Taplo."""

OUTSIDE = ":"
"""In the name of a quantity or search of the user's own, `MODULE:NAME`."""


@dataclass(frozen=True, slots=True)
class Key:
    """A key of a table.

    Attributes:
        name: as it is written.
        text: what it does, without a unit and a version.
        since: the version that it came with; empty for the first.
        required: whether it has no default.
        schema: of its value; `default` is the value of a key that is left out, where it has one.
        table: what its value is made of, or a list of; None for other values.
    """

    name: str
    text: str
    since: str
    required: bool
    schema: Schema
    table: TableType | None

    @property
    def unit(self) -> str:
        """The unit of its numbers; empty for none."""
        return next((unit for end, unit in UNITS.items() if re.search(rf"(^|_){end}$", self.name)), "")


def summary(table: TableType) -> str:
    """What a table is, without its keys."""
    return " ".join(inspect.getdoc(table).split("\nAttributes:")[0].split())  # type: ignore[union-attr]


def keys(table: TableType) -> Iterator[Key]:
    """The keys of a table, in its order.

    Raises:
        KeyError: the docstring does not say what a key does.
    """
    texts = _texts(table)
    properties = _parts()[table.__name__]["properties"]
    for field in msgspec.structs.fields(table):
        name = field.encode_name
        text, since = texts[name], SINCE.search(texts[name])
        yield Key(
            name=name,
            text=SINCE.sub("", text),
            since=since[1] if since else "",
            required=field.required,
            schema=properties[name],
            table=struct_in(field.type),
        )


def problem_schema() -> Schema:
    """The JSON Schema (2020-12) of a problem file.

    A file that it refuses is refused by `check` as well. The converse does not hold: names of links, and how
    keys fit each other, are beyond it.
    """
    parts = dict(_parts())
    whole = parts.pop(ProblemFile.__name__) | {"title": "evodesign problem file"}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **whole, "$defs": parts}


def schema_file() -> str:
    """The schema as the text of a file."""
    return msgspec.json.format(msgspec.json.encode(problem_schema()), indent=1).decode() + "\n"


def with_schema_line(problem: str) -> str:
    """A problem's text with a first line that leads editors to a schema file beside it."""
    return problem if problem.startswith(SCHEMA_LINE) else f"{SCHEMA_LINE} ./{SCHEMA_FILE}\n{problem}"


@functools.cache
def _parts() -> Mapping[str, Schema]:
    """The schemas of all tables and enumerations by name."""
    _, found = msgspec.json.schema_components([ProblemFile], ref_template="#/$defs/{name}")
    parts = {name: _without_null(part) for name, part in found.items()}
    for table in tables():
        part, texts = parts[table.__name__], _texts(table)
        part["description"] = summary(table)
        for name, value in part["properties"].items():
            value["description"] = texts[name]
    _add_names(parts)
    return parts


def tables() -> tuple[TableType, ...]:
    """Every table of a problem file, each before those inside of it."""
    found: dict[TableType, None] = {}

    def walk(table: TableType) -> None:
        if table not in found:
            found[table] = None
            for field in msgspec.structs.fields(table):
                if (inner := struct_in(field.type)) is not None:
                    walk(inner)

    walk(ProblemFile)
    return tuple(found)


def _texts(table: TableType) -> Mapping[str, str]:
    """What the docstring says of each key."""
    _, _, attributes = (inspect.getdoc(table) or "").partition("\nAttributes:\n")
    entries = re.findall(r"^ {4}(\w+): (.*(?:\n {8}.*)*)", attributes, re.MULTILINE)
    return {name: " ".join(text.split()) for name, text in entries}


def _without_null(value: Any) -> Any:
    """A schema without null, with no text that `init` leaves to be filled in."""
    if isinstance(value, list | tuple):
        return [_without_null(each) for each in value]
    if not isinstance(value, dict):
        return value
    kept = {key: _without_null(each) for key, each in value.items() if key != "default" or _plain(each)}
    if "anyOf" in kept:
        kinds = [each for each in kept.pop("anyOf") if each != {"type": "null"}]
        kept = {**(kinds[0] if len(kinds) == 1 else {"anyOf": kinds}), **kept}
    if places := kept.pop("prefixItems", None):  # which Taplo does not know; all places are alike
        kept["items"] = places[0]
    if kept.get("type") == "string" and "minLength" in kept:
        kept["not"] = {"const": FILL_IN}
    return kept


def _plain(default: Any) -> bool:
    """Whether a default says something that the defaults of inner tables do not."""
    return default is not None and not isinstance(default, dict)


def _add_names(parts: Mapping[str, Schema]) -> None:
    """Say which quantities there are, what they are, and which searches."""
    outside = {"type": "string", "pattern": OUTSIDE}
    known = [{"const": name, "description": meaning(name)} for name in objective_kinds()]
    quantile = {"type": "string", "pattern": rf"^q[1-9][0-9]?_({'|'.join(QUANTITIES)})$"}
    for sense in parts["ObjectivesTable"]["properties"].values():
        sense["items"] = {"anyOf": [*known, quantile, outside]}
    bounds = {"$ref": f"#/$defs/{BoundsTable.__name__}"}
    constraints = parts[ProblemFile.__name__]["properties"]["constraints"]
    quantiles = "|".join(constraint_key(name) for name in QUANTITIES)
    constraints["properties"] = {
        constraint_key(name): {**bounds, "description": meaning(name)} for name in objective_kinds()
    }
    constraints["patternProperties"] = {rf"^q[1-9][0-9]?_({quantiles})$": bounds, OUTSIDE: bounds}
    constraints["additionalProperties"] = False
    algorithm = parts["SearchTable"]["properties"]["algorithm"]
    del algorithm["type"], algorithm["minLength"], algorithm["not"]
    algorithm["anyOf"] = [{"enum": sorted(SEARCHES)}, outside]


def meaning(name: str) -> str:
    """What a quantity is, without links, and its unit."""
    quantity = name if name in MEANINGS else name.removeprefix(WORST)
    text = re.sub(r" \(\[[^]]*\]\([^)]*\)\)", "", MEANINGS[quantity].text)
    return f"{'' if quantity == name else 'largest value of: '}{text} [{objective_kinds()[name].unit}]"
