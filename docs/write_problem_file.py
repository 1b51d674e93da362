"""Writes the tables of docs/problem_file.md from the schema: `python -m docs.write_problem_file`."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docs.write_actuators import table
from evodesign.problem.constraints import constraint_key
from evodesign.problem.file import ProblemFile
from evodesign.problem.schema import Key, TableType, keys, problem_schema, summary, tables
from evodesign.quantities.meanings import MEANINGS
from evodesign.quantities.objectives import QUANTITIES, objective_kinds

PAGE = Path(__file__).parent / "problem_file.md"
HEAD = ("key", "type", "unit", "default", "range", "what it does", "since")
BOUNDS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
KINDS = {"number": "number", "integer": "whole number", "boolean": "true or false", "string": "text"}


def places(of: TableType = ProblemFile, place: str = "") -> dict[TableType, str]:
    """Where each table stands first in a file: `[robot]`, `[[robot.frames]]`, nothing for the whole."""
    found = {of: place}
    for key in keys(of):
        if key.table is not None:
            path = f"{place.strip('[]')}.{key.name}".lstrip(".")
            listed = _kind(key.schema).startswith("list")
            found = {**places(key.table, f"[[{path}]]" if listed else f"[{path}]"), **found}
    return found


def key_tables() -> str:
    """A section for each table of a problem file; a table that two share stands once."""
    whole = places()
    return "\n".join(_section(of, whole) for of in tables())


def _section(of: TableType, whole: Mapping[TableType, str]) -> str:
    place = whole[of]
    title = f"`{place}`" if place else "The whole file"
    rows = (_row(key, whole) for key in keys(of))
    return f"{'#' * (3 + ('.' in place))} {title}\n\n{_linked(summary(of))}\n\n{table(HEAD, rows)}"


def _linked(text: str) -> str:
    """A text with links to the pages that it names."""
    return re.sub(r"\bDocs: (.*)\.$", lambda found: f"See {_links(found[1])}.", text)


def _links(names: str) -> str:
    return re.sub(r"(\w+)\.md", r"[\1](\1.md)", names)


def _row(key: Key, whole: Mapping[TableType, str]) -> tuple[str, ...]:
    default, kind = key.schema.get("default"), _kind(key.schema)
    shown = "required" if key.required else "" if default in (None, "", []) else f"`{json.dumps(default)}`"
    if key.table is not None:
        kind = f"[{kind}](#{re.sub(r'[^a-z_]', '', whole[key.table])})"
    return (f"`{key.name}`", kind, key.unit, shown, _range(key.schema), key.text, key.since)


def _kind(value: Any) -> str:
    """What kind of value a schema asks for."""
    if "$ref" in value:
        words = problem_schema()["$defs"][value["$ref"].rpartition("/")[2]].get("enum")
        return "table" if words is None else ", ".join(f"`{word}`" for word in words)
    if "anyOf" in value:
        if not {"enum", "const"}.isdisjoint(value["anyOf"][0]):
            return "name"
        return " or ".join(sorted(map(_kind, value["anyOf"]), reverse=True))
    if value["type"] == "array":
        count = _count(value)
        inner = _kind(value["items"])
        many = f"{inner}s" if inner in ("table", "number", "name") else f"({inner})"
        return f"{count} {many}" if count else f"list of {many}"
    if value["type"] == "object":
        inner = _kind(value["additionalProperties"] or value["patternProperties"][":"])
        return f"{'numbers' if inner == 'number' else inner} by name"
    return "name" if value.get("minLength") else KINDS[value["type"]]


def _count(value: Any) -> int:
    """How many values a list has; 0 where that is free."""
    least, most = value.get("minItems"), value.get("maxItems")
    return least if least and least == most else 0


def _range(value: Any) -> str:
    """The bounds of a number, of the numbers in a list, and of the list's length."""
    inner = next((value[key] for key in ("items", "additionalProperties") if value.get(key)), None)
    own = [f"{sign} {value[bound]:g}" for bound, sign in BOUNDS.items() if bound in value]
    if not _count(value):
        least, most = value.get("minItems"), value.get("maxItems")
        own += [f"at least {least}"] if least else []
        own += [f"at most {most}"] if most else []
    inside = [_range(inner)] if inner and "$ref" not in inner and "anyOf" not in inner else []
    return ", ".join(each for each in (*inside, *own) if each)


def quantity_table() -> str:
    """Every quantity, with what it is called in `[constraints]`."""
    kinds = objective_kinds()
    head = ("name", "key in `[constraints]`", "unit", "usual sense", "what it is")
    mean = dict.fromkeys(QUANTITIES, "; mean over all cases")
    rows = (
        (
            f"`{name}`",
            f"`{constraint_key(name)}`",
            kinds[name].unit,
            each.sense,
            each.text + mean.get(name, ""),
        )
        for name, each in MEANINGS.items()
    )
    return table(head, rows)


TABLES = {"keys": key_tables, "quantities": quantity_table}


def page() -> str:
    """The page with the tables of today."""
    text = PAGE.read_text(encoding="utf-8")
    for name, written in TABLES.items():
        before, rest = text.split(f"<!-- {name} -->\n")
        after = rest.split(f"<!-- end of {name} -->\n")[1]
        text = f"{before}<!-- {name} -->\n\n{written()}\n<!-- end of {name} -->\n{after}"
    return text


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
