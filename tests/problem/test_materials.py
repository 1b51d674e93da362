"""Densities from a catalogue: what a problem file may say, and what becomes of it."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from evodesign.body.material import CATALOGUE
from evodesign.errors import InputError
from evodesign.evaluation.baseline import Baseline
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.designs import designs_text, read_designs, start_genomes
from evodesign.problem.model_json import model_json
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource, design_of, materials_of
from evodesign.searches.base import JOINT_STARTS
from evodesign.searches.registry import make_search
from tests.fuzz.input_cases import POPULATION, PROBLEM, TEXTS

BOUNDS = "lower_kg_per_m3 = 500.0\nupper_kg_per_m3 = 4000.0\n"
OWN = """
[[material]]
name = "shell"
density_kg_per_m3 = 800.0
source = "assumed: 0.3 of aluminium_6061"
"""
CHOSEN = 'materials = ["steel_4340", "shell", "aluminium_6061"]\n'


def source_of(density: str, extra: str = OWN, designs: str = "") -> ProblemSource:
    """The small problem with other densities, and other designs to begin with."""
    text = TEXTS[PROBLEM].replace(BOUNDS, density) + extra
    return ProblemSource(path=PROBLEM, text=text, files={**TEXTS, POPULATION: 'name = "some"' + designs})


LONG = '\n[[design]]\nname = "long"\nlength = { arm = 1.5 }\n'
IN_STEEL = LONG + "density_kg_per_m3 = { leg = 7850.0 }\n"


@pytest.fixture(scope="module")
def small() -> DesignProblem:
    return build_problem(source_of(CHOSEN, designs=IN_STEEL))


def test_choices_are_the_materials_densities_the_lightest_first(small: DesignProblem) -> None:
    length, density = small.space.records
    assert (length.choices, length.materials) == ((), ())
    assert density.choices == (800.0, 2700.0, 7850.0)
    assert density.materials == ("shell", "aluminium_6061", "steel_4340")
    assert (density.lower, density.upper) == (800.0, 7850.0)


def test_genomes_are_middles_and_stand_for_catalogue_densities_alone(small: DesignProblem) -> None:
    settings = small.settings("random", 64, 1)
    assert settings.choices == (0, 3)
    for genome in make_search(settings).ask():
        values = small.space.values(genome)
        design = design_of(small.space.records, genome)
        assert values[1] in (800.0, 2700.0, 7850.0)
        assert tuple(design.values()) == values
        assert small.space.genome(values)[1] == genome[1]
        assert materials_of(small.space.records, design) == {
            "density.leg": {800.0: "shell", 2700.0: "aluminium_6061", 7850.0: "steel_4340"}[values[1]]
        }
    ((arm, leg),) = small.start
    assert (arm, leg) == (pytest.approx(0.75), 5.0 / 6.0)


def test_a_problem_without_materials_is_remembered_as_before() -> None:
    bounded = build_problem(ProblemSource(path=PROBLEM, text=TEXTS[PROBLEM], files=TEXTS))
    settings = msgspec.json.decode(msgspec.json.encode(bounded.settings("nsga2", 8, 1)))
    assert "choices" not in settings
    for record in bounded.space.records:
        assert set(msgspec.json.decode(msgspec.json.encode(record))) == {"name", "lower", "upper", "unit"}
    shown = model_json(bounded)
    assert "materials" not in shown
    assert all("materials" not in parameter for parameter in shown["parameters"])


def test_check_shows_the_materials_with_their_sources(small: DesignProblem) -> None:
    shown = model_json(small)
    assert [material["name"] for material in shown["materials"]] == ["shell", "aluminium_6061", "steel_4340"]
    assert shown["materials"][0]["source"] == "assumed: 0.3 of aluminium_6061"
    assert shown["parameters"][1]["materials"] == ["shell", "aluminium_6061", "steel_4340"]


@pytest.mark.parametrize(
    ("density", "extra", "words"),
    [
        ("", "", ["design.density[0].lower_kg_per_m3", "or materials", "nothing"]),
        ("lower_kg_per_m3 = 5.0\n", "", ["design.density[0].upper_kg_per_m3", "or materials", "nothing"]),
        (
            "lower_kg_per_m3 = 5.0\nupper_kg_per_m3 = 4.0\n",
            "",
            ["density[0].lower_kg_per_m3: wanted less than upper_kg_per_m3 (4), found 5"],
        ),
        (BOUNDS + CHOSEN, OWN, ["design.density[0].materials", "either materials or bounds", "both"]),
        (CHOSEN, "", ["materials[1]", "'shell'", "a material of the catalogue"]),
        ('materials = ["aluminum_6061", "abs"]\n', "", ["materials[0]", "did you mean 'aluminium_6061'?"]),
        ('materials = ["aluminum", "abs"]\n', "", ["'aluminium_6061' or 'aluminium_7075'?"]),
        ('materials = ["abs", "peek", "abs"]\n', "", ["materials[2]", "each material once", "'abs' twice"]),
        ('materials = ["abs"]\n', "", ["materials", "at least two materials", "found 1"]),
        ("materials = []\n", "", ["materials", "at least two materials", "found 0"]),
        (CHOSEN, OWN + OWN, ["material[1].name", "a new name", "earlier [[material]]"]),
        (CHOSEN, OWN.replace("shell", "abs"), ["material[0].name", "a new name", "in the catalogue"]),
        (CHOSEN, OWN.replace("800.0", "2700.0"), ["of different densities", "both of 2700"]),
        (CHOSEN, OWN.replace("800.0", "-800.0"), ["material[0].density_kg_per_m3", "> 0"]),
        (CHOSEN, OWN.replace("source", "sauce"), ["material[0].sauce", "did you mean 'source'?"]),
    ],
)
def test_contradictory_and_unknown_materials_are_refused(density: str, extra: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        build_problem(source_of(density, extra, IN_STEEL))
    for word in (PROBLEM, *words):
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("designs", "words"),
    [
        (LONG, ["design 'long'", "material of density.leg", "the nearest material is 'shell' with 800"]),
        (
            LONG + "density_kg_per_m3 = { leg = 2600.0 }\n",
            ["design[0].density_kg_per_m3.leg", "2600 kg/m^3", "the nearest material is 'aluminium_6061'"],
        ),
        (LONG + 'material = { leg = "shel" }\n', ["design[0].material.leg", "did you mean 'shell'?"]),
        (LONG + 'material = { arm = "shell" }\n', ["design[0].material.arm", "that has materials"]),
        (IN_STEEL + 'material = { leg = "shell" }\n', ["either a material or a density", "both"]),
    ],
)
def test_designs_of_no_material_are_refused_by_name(designs: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        build_problem(source_of(CHOSEN, designs=designs))
    for word in (POPULATION, *words):
        assert word in str(caught.value)


def test_a_design_names_its_material(small: DesignProblem) -> None:
    tree = small.scene.robot.tree
    named = read_designs(
        'name = "some"' + LONG + 'material = { leg = "steel_4340" }\n', "here", small.space, tree
    )
    assert named == {"long": (1.5, 7850.0)}
    written = designs_text("again", named, small.space, "a remark")
    assert read_designs(written, "there", small.space, tree) == named
    assert start_genomes(named, small.space, "here") == small.start


def test_the_baseline_of_a_catalogue_problem_is_refused(small: DesignProblem) -> None:
    with pytest.raises(InputError, match=r"bounds of density\.leg instead of materials"):
        small.settings(JOINT_STARTS, 4, 1)
    with pytest.raises(InputError, match=r"bounds of density\.leg instead of materials"):
        Baseline(small)


def test_the_catalogue_problem_offers_six_materials_for_each_density(repository: Path) -> None:
    problem = build_problem(read_source(repository / "problems" / "icub_materials.toml"))
    assert problem.space.counts == (0,) * 8 + (6,) * 8
    known = {material.density for material in CATALOGUE.values()} | {570.0, 810.0}
    assert all(set(parameter.choices) <= known for parameter in problem.space.parameters)
