"""The channels of a run's log: which record goes by which topic, and how it is described.

Messages are JSON (message encoding `json`), described by JSON Schema (schema encoding `jsonschema`): the
well-known encodings of the MCAP registry, which Foxglove, Lichtblick and PlotJuggler read.

A viewer lists the fields of a channel from its schema, and drops the channel when the schema's root is not
an object, or a listed field is a union, a list of lists or a map without `properties`. Therefore references
are resolved; a field that a viewer cannot list stands under `patternProperties`, where validators look and
viewers do not; a record of one of several kinds lists the fields of all of them; a map lists the names that
are known beforehand (objectives, design parameters), so that a plot panel can offer them. Every record
validates against its schema, and nothing beside a record does.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from typing import Any, Final

import msgspec

from evodesign.records import Detail, Evaluation, Front, Generation, RunHeader

RUN: Final = "/run"
EVALUATION: Final = "/evaluation"
GENERATION: Final = "/generation"
FRONT: Final = "/front"
DETAIL: Final = "/detail"

RECORDS: Final[Mapping[str, type[msgspec.Struct]]] = {
    RUN: RunHeader,
    EVALUATION: Evaluation,
    GENERATION: Generation,
    FRONT: Front,
    DETAIL: Detail,
}
"""The record that each topic carries."""

KNOWN_BY: Final = {EVALUATION: "number", GENERATION: "number", FRONT: "generation", DETAIL: "evaluation"}
"""The field that tells a topic's records from each other."""

AGENTS: Final = ("robot", "human")
"""Names of the agents, as fields of the schema."""

HEADER_COPY: Final = "run.json.zst"
"""Attachment that repeats the header, compressed: without a header a log cannot be interpreted."""

MESSAGE_ENCODING: Final = "json"
SCHEMA_ENCODING: Final = "jsonschema"

Schema = dict[str, Any]
Names = Mapping[str, tuple[str, ...]]
"""Keys known beforehand of the maps in a record, by the name of the field that holds the map."""

SCALARS = ("boolean", "integer", "number", "string")


def known_as(record: msgspec.Struct) -> tuple[str, int]:
    """The topic of a record that is no header, and its number there."""
    topic = next(topic for topic in KNOWN_BY if isinstance(record, RECORDS[topic]))
    return topic, getattr(record, KNOWN_BY[topic])


def described(header: RunHeader) -> dict[str, bytes]:
    """JSON Schema of each topic's messages, with the run's objectives and parameters as fields."""
    names = tuple(_names(header).items())
    return {topic: _schema_text(record, names) for topic, record in RECORDS.items()}


@functools.lru_cache(maxsize=64)
def _schema_text(record: type[msgspec.Struct], names: tuple[tuple[str, tuple[str, ...]], ...]) -> bytes:
    """The same for every segment of a run; to make it takes as long as to write a short one."""
    return msgspec.json.encode(schema_of(record, dict(names)))


def _names(header: RunHeader) -> Names:
    objectives = tuple(objective.name for objective in header.objectives)
    parameters = tuple(parameter.name for parameter in header.parameters)
    return {"design": parameters, "objectives": objectives, "best": objectives, "agents": AGENTS}


def schema_of(record: type[msgspec.Struct], names: Names) -> Schema:
    """Schema of a record's JSON."""
    whole = msgspec.json.schema(record)
    return {"title": record.__name__} | _plain(whole, whole["$defs"], names, field="")


def _plain(schema: Schema, definitions: Mapping[str, Schema], names: Names, field: str) -> Schema:
    """The schema of one field (or of the root) without references and remarks."""

    def plain(inner: Schema, inner_field: str = "") -> Schema:
        return _plain(inner, definitions, names, inner_field)

    match schema:
        case {"$ref": str(reference)}:
            return plain(definitions[reference.rpartition("/")[2]], field)
        case {"anyOf": list(choices)}:
            plain_choices = [plain(choice, field) for choice in choices]
            if all("properties" in choice and "required" in choice for choice in plain_choices):
                return _one_of(plain_choices)
            return {"anyOf": plain_choices}
        case {"enum": list(values)}:
            return {"type": "string", "enum": values}
        case {"type": "array", "items": dict(items)}:
            return {"type": "array", "items": plain(items)}
        case {"type": "object", "properties": dict(properties)}:
            fields = {name: plain(inner, name) for name, inner in properties.items()}
            return _record(fields, schema.get("required", []))
        case {"type": "object", "additionalProperties": dict(values)}:
            value = plain(values)
            known = dict.fromkeys(names.get(field, ()), value)
            return {"type": "object", "properties": known, "additionalProperties": value}
        case _:
            return {"type": schema["type"]}


def _record(fields: Mapping[str, Schema], required: list[str]) -> Schema:
    return {
        "type": "object",
        "properties": {name: inner for name, inner in fields.items() if _listed(inner)},
        "patternProperties": {
            f"^{re.escape(name)}$": inner for name, inner in fields.items() if not _listed(inner)
        },
        "required": required,
        "additionalProperties": False,
    }


def _one_of(choices: list[Schema]) -> Schema:
    """A record of one of several kinds, with the fields of all of them, of which each kind allows its own."""
    fields: dict[str, Schema] = {}
    for choice in choices:
        for name, inner in choice["properties"].items():
            known = fields.get(name, {})
            values = [*known.get("enum", ()), *inner.get("enum", ())]
            fields[name] = {**known, **inner, **({"enum": [*dict.fromkeys(values)]} if values else {})}
    return {"type": "object", "properties": fields, "allOf": [{"anyOf": choices}]}


def _listed(schema: Schema) -> bool:
    """Whether a viewer can list a field of this schema."""
    kind = schema.get("type")
    if kind == "array":
        return schema["items"].get("type") in (*SCALARS, "object")
    return kind in (*SCALARS, "object")
