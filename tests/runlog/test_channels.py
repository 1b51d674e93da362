from __future__ import annotations

from typing import Any

import jsonschema
import msgspec
import pytest

from evodesign.runlog.channels import RECORDS, described
from tests.runlog.toys import toy_evaluations, toy_generation, toy_header

HEADER = toy_header()
VIEWER_SCALARS = {"boolean", "integer", "number", "string"}


def viewer_fields(schema: dict[str, Any], path: str) -> dict[str, str]:
    """Fields that a viewer lists, read as Lichtblick reads a schema; it drops a channel where this raises.

    Source: the rules of packages/mcap-support/src/parseJsonSchema.ts in Lichtblick.
    """
    assert schema["type"] == "object", path
    fields = {}
    for name, inner in schema["properties"].items():
        place = f"{path}.{name}"
        kind = inner["type"]
        while kind == "array":
            inner, place = inner["items"], f"{place}[:]"
            kind = inner["type"]
            assert kind != "array", place
        if kind == "object":
            fields |= viewer_fields(inner, place)
        else:
            assert kind in VIEWER_SCALARS, place
            fields[place] = kind
    return fields


@pytest.mark.parametrize("topic", RECORDS)
def test_a_viewer_can_list_the_fields_of_every_channel(topic: str) -> None:
    assert viewer_fields(msgspec.json.decode(described(HEADER)[topic]), topic)


def test_a_plot_panel_is_offered_the_objectives_and_parameters_by_name() -> None:
    schemas = {topic: msgspec.json.decode(schema) for topic, schema in described(HEADER).items()}
    generation = viewer_fields(schemas["/generation"], "/generation")
    assert generation["/generation.best.robot_torque"] == "number"
    assert generation["/generation.feasible_share"] == "number"
    evaluation = viewer_fields(schemas["/evaluation"], "/evaluation")
    assert evaluation["/evaluation.assessment.design.arm.0"] == "number"
    assert evaluation["/evaluation.assessment.cases[:].case.task.height_m"] == "number"


@pytest.mark.parametrize("topic", RECORDS)
def test_a_schema_is_itself_valid(topic: str) -> None:
    jsonschema.Draft202012Validator.check_schema(msgspec.json.decode(described(HEADER)[topic]))


def test_a_value_that_does_not_exist_may_be_null_but_not_a_text() -> None:
    validator = jsonschema.Draft202012Validator(msgspec.json.decode(described(HEADER)["/generation"]))
    generation = msgspec.to_builtins(toy_generation(0, 4))
    assert generation["hypervolume"] is None
    validator.validate(generation)
    assert not validator.is_valid(generation | {"hypervolume": "large"})
    assert not validator.is_valid(generation | {"reference": {"robot_torque": "large"}})


def test_an_unknown_status_is_not_accepted() -> None:
    validator = jsonschema.Draft202012Validator(msgspec.json.decode(described(HEADER)["/evaluation"]))
    evaluation = msgspec.json.decode(msgspec.json.encode(toy_evaluations(HEADER, 1)[0]))
    validator.validate(evaluation)
    evaluation["assessment"]["status"] = "so so"
    assert not validator.is_valid(evaluation)
