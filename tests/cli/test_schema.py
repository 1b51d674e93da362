"""The JSON Schema refuses the problems that the reader refuses, as far as a schema can, and no others."""

from __future__ import annotations

import json
import re
import sys
import tomllib
import types
from collections import Counter
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from jsonschema import Draft202012Validator

from evodesign.cli.main import app
from evodesign.errors import InputError
from evodesign.problem.build import build_problem
from evodesign.problem.file import ProblemFile
from evodesign.problem.schema import SCHEMA_FILE, keys, problem_schema, tables
from evodesign.problem.source import decode_toml, read_source, source_of
from evodesign.quantities.design_result import CaseQuantity
from evodesign.quantities.meanings import MEANINGS
from evodesign.quantities.objectives import objective_kinds
from tests.cli.test_bad_input import PROBLEM
from tests.cli.test_bad_input import test_spoiled_files_are_explained as spoiled
from tests.fuzz.mutations import ANY
from tests.fuzz.toml_mutations import TOML

REPOSITORY = Path(__file__).parents[2]
GOOD = sorted((*(REPOSITORY / "problems").glob("*.toml"), *REPOSITORY.glob("tests/golden/*/problem.toml")))
BEYOND = (
    "a finite number",
    "valid TOML",
    "TOML of at most",
    "at most ",
    "a key of at most",
    "tables nested",
    "Number out",
)
"""How the reader begins what it wants of a text that is too large, no TOML, or of numbers beyond JSON."""


@pytest.fixture(scope="module")
def validator() -> Draft202012Validator:
    Draft202012Validator.check_schema(problem_schema())
    return Draft202012Validator(problem_schema())


def places(validator: Draft202012Validator, tables: Any) -> list[str]:
    """Where the schema finds a fault."""
    return [error.json_path for error in validator.iter_errors(tables)]


def fault(text: str) -> InputError | None:
    """What the reader says of a text."""
    try:
        decode_toml(text, "x.toml", ProblemFile)
    except InputError as error:
        return error
    return None


def beyond_a_schema(error: InputError) -> bool:
    """Whether a text is too large, or no TOML, or has a number that JSON cannot tell from another."""
    whole = error.wanted == "a whole number" and re.fullmatch(r"[\d.e+]+", error.found) is not None
    return whole or error.wanted.startswith(BEYOND)


@pytest.mark.parametrize("file", GOOD, ids=lambda file: file.stem)
def test_every_problem_of_the_project_is_valid(file: Path, validator: Draft202012Validator) -> None:
    assert places(validator, tomllib.loads(file.read_text(encoding="utf-8"))) == []


def test_spoilt_problems_are_refused_by_the_schema_where_the_reader_refuses_them(
    validator: Draft202012Validator,
) -> None:
    """But names of quantities and searches, which the schema knows and the decoder leaves to the builder."""
    texts = [file.read_text(encoding="utf-8") for file in GOOD]
    ends = Counter[str]()
    for number in range(500):
        chance = np.random.default_rng([27, number])
        kinds = TOML if chance.random() < 0.8 else ANY
        mutation = kinds[int(chance.integers(len(kinds)))]
        text = mutation(texts[number % len(texts)], chance).decode("utf-8", "replace")
        error = fault(text)
        if error is None:
            named = ("$.objectives.", "$.constraints", "$.search.algorithm")
            found = places(validator, tomllib.loads(text))
            assert [place for place in found if not place.startswith(named)] == [], number
            ends["read"] += 1
        elif not beyond_a_schema(error):
            assert places(validator, tomllib.loads(text)), f"{number}: {error}"
            ends["refused"] += 1
    assert min(ends["read"], ends["refused"]) > 80, ends


def test_files_that_the_command_line_refuses_for_a_key_type_or_range_are_refused(
    validator: Draft202012Validator,
) -> None:
    (mark,) = (each for each in spoiled.pytestmark if each.name == "parametrize")  # type: ignore[attr-defined]
    text = (REPOSITORY / "problems" / PROBLEM).read_text(encoding="utf-8")
    spoilt = [text.replace(old, new, 1) for file, old, new, _ in mark.args[1] if file == PROBLEM]
    refused = {error.key: each for each in spoilt if (error := fault(each)) and not beyond_a_schema(error)}
    assert {"payload.mas_kg", "payload.mass_kg", "task.heights_m[1]", "human.sex", "name"} <= set(refused)
    assert [key for key, each in refused.items() if not places(validator, tomllib.loads(each))] == []


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('"reach_height"', '"reach_hight"', "$.objectives.maximise[0]"),
        ('"surrogate"', '"surogate"', "$.search.algorithm"),
        ("[task]", "[constraints]\nmass = { upper = 9.0 }\n[task]", "$.constraints"),
        ('"robots/icub_shapes.urdf"', '"FILL IN"', "$.robot.urdf"),
    ],
)
def test_names_that_the_builder_refuses_are_refused(
    old: str, new: str, place: str, validator: Draft202012Validator
) -> None:
    text = "\n" + (REPOSITORY / "problems" / PROBLEM).read_text(encoding="utf-8")
    assert old in text
    found = validator.iter_errors(tomllib.loads(text.replace(old, new, 1)))
    assert any(
        error.json_path.startswith(place) or place in str([e.json_path for e in error.context or ()])
        for error in found
    )


@pytest.mark.parametrize("name", ["q90_robot_torque", "worst_human_torque", "own:force", "worst_own:force"])
def test_quantities_over_cases_and_of_ones_own_may_be_named(
    name: str, validator: Draft202012Validator
) -> None:
    tables = tomllib.loads((REPOSITORY / "problems" / PROBLEM).read_text(encoding="utf-8"))
    tables["objectives"]["minimise"] = [name]
    tables["constraints"] = {f"{name}_n_m": {"upper": 30.0}}
    assert places(validator, tables) == []


SHOWN = [
    (str(page.relative_to(REPOSITORY / "docs")), block)
    for page in sorted((REPOSITORY / "docs").rglob("*.md"))
    if page.name != "trust.md"  # whose table is no problem's
    for block in re.findall(
        r"^```toml\n(.*?)^```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
]


def with_tables(block: str) -> dict[str, Any]:
    """The tables of point_grasp.toml with those of a page in their place; people are others."""
    whole = tomllib.loads((REPOSITORY / "problems" / PROBLEM).read_text(encoding="utf-8"))
    for name, table in tomllib.loads(block).items():
        old = whole.get(name)
        added = isinstance(old, dict) and isinstance(table, dict) and name != "human"
        whole[name] = {**old, **table} if added else table
    return whole


@pytest.mark.parametrize(("page", "block"), SHOWN, ids=[page for page, _ in SHOWN])
def test_tables_that_pages_show_are_valid(page: str, block: str, validator: Draft202012Validator) -> None:
    assert places(validator, with_tables(block)) == [], page


RECIPES = [(page, block) for page, block in SHOWN if page.startswith("recipes/")]


@pytest.mark.parametrize(("page", "block"), RECIPES, ids=[page for page, _ in RECIPES])
def test_problems_of_recipes_are_built(page: str, block: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the copy that recipes begin with, whose walls have taken the place of densities in hardware.md."""
    tables = with_tables(block)
    del tables["search"]["reference"], tables["search"]["start"]
    if page == "recipes/hardware.md":
        tables["design"]["density"] = [
            each for each in tables["design"]["density"] if "arm" not in each["name"]
        ]
    module = types.ModuleType("my_objectives")
    monkeypatch.setitem(sys.modules, "my_objectives", module)
    monkeypatch.setenv("EVODESIGN_MODULES", "my_objectives")
    module.foot_force = CaseQuantity("N", lambda scene, postures: 0.0)  # type: ignore[attr-defined]
    assert build_problem(source_of(tables, REPOSITORY / "problems")).objectives


def test_every_key_says_what_it_does_and_every_text_has_a_key() -> None:
    for table in tables():
        found = list(keys(table))
        said = re.findall(r"^ {8}(\w+): ", (table.__doc__ or "").partition("Attributes:")[2], re.MULTILINE)
        assert [key.name for key in found] == said
        assert all(len(key.text) > 3 and key.since in ("", "0.3") for key in found)


def test_places_of_lists_of_fixed_length_are_alike() -> None:
    """The schema says once what each is, for Taplo."""
    text = msgspec.json.encode(msgspec.json.schema(ProblemFile)).decode()
    lists: list[Any] = []
    json.loads(text, object_hook=lambda found: lists.append(found.get("prefixItems", [])) or found)
    fixed = [places for places in lists if places]
    assert len(fixed) > 10
    assert [places for places in fixed if any(place != places[0] for place in places)] == []


def test_every_quantity_has_a_meaning() -> None:
    assert list(MEANINGS) == [name for name in objective_kinds() if not name.startswith("worst_")]


def test_units_follow_from_keys() -> None:
    units = {key.name: key.unit for table in tables() for key in keys(table)}
    told = {
        "mass_kg": "kg", "hand_moment_n_m": "N m", "knee_flexion_deg": "deg", "foot_yaw_rad": "rad",
        "density_kg_per_m3": "kg/m^3", "hours": "h", "lifts_per_hour": "1/h", "evaluation_memory_gb": "GB",
        "torque_constant_n_m_per_a": "N m/A", "rotor_inertia_kg_cm2": "kg cm^2", "from_m": "m", "push_n": "N",
        "friction": "", "name": "", "sections": "", "air_c": "deg C", "least_growth_percent": "%",
    }  # fmt: skip
    assert {name: units.get(name, "") for name in told} == told


def test_a_copied_problem_names_the_schema_beside_it_and_is_the_same_problem(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    app(["problems", "point-grasp", "--to", str(tmp_path / "own")], standalone_mode=False)
    first, *_, last = map(Path, capsys.readouterr().out.split())
    assert first.read_text(encoding="utf-8").startswith(f"#:schema ./{SCHEMA_FILE}\n")
    assert last == tmp_path / "own" / SCHEMA_FILE
    app(["schema"], standalone_mode=False)
    assert last.read_text(encoding="utf-8") == capsys.readouterr().out
    assert json.loads(last.read_text(encoding="utf-8")) == problem_schema()
    copy, shipped = (build_problem(read_source(each)) for each in (first, "point-grasp"))
    assert copy.space == shipped.space
