"""The channels of a run's log: which record goes by which topic, and how it is described.

Messages are JSON (message encoding `json`), described by JSON Schema (schema encoding `jsonschema`): the
well-known encodings of the MCAP registry, which Foxglove, Lichtblick and PlotJuggler read.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import msgspec

from evodesign.records import Detail, Evaluation, Front, Generation, RunHeader
from evodesign.runlog.schema import Names, schema_of

__all__ = [
    "DETAIL",
    "EVALUATION",
    "FRONT",
    "GENERATION",
    "HEADER_COPY",
    "MESSAGE_ENCODING",
    "RECORDS",
    "RUN",
    "SCHEMA_ENCODING",
    "described",
]

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

AGENTS: Final = ("robot", "human")
"""Names of the agents, as fields of the schema."""

HEADER_COPY: Final = "run.json.zst"
"""Attachment that repeats the header, compressed: without a header a log cannot be interpreted."""

MESSAGE_ENCODING: Final = "json"
SCHEMA_ENCODING: Final = "jsonschema"


def described(header: RunHeader) -> dict[str, bytes]:
    """JSON Schema of each topic's messages, with the run's objectives and parameters as fields."""
    names = _names(header)
    return {topic: msgspec.json.encode(schema_of(record, names)) for topic, record in RECORDS.items()}


def _names(header: RunHeader) -> Names:
    objectives = tuple(objective.name for objective in header.objectives)
    parameters = tuple(parameter.name for parameter in header.parameters)
    return {"design": parameters, "objectives": objectives, "best": objectives, "agents": AGENTS}
