"""`check` says of every link what it is made of and how it grows."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from evodesign.body.placement import Placement
from evodesign.body.shape import Sphere
from evodesign.cli.tables.problem import model_tables
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.model_json import model_json
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree
from tests.fuzz.input_cases import PROBLEM, TEXTS
from tests.problem.test_loads import TABLES, source_with


@pytest.fixture(scope="module")
def small() -> DesignProblem:
    """A robot with composite arms, legs with meshes, and a claw without a shape."""
    return build_problem(ProblemSource(path=PROBLEM, text=TEXTS[PROBLEM], files=TEXTS))


def test_every_link_has_its_kind_solids_and_mass(small: DesignProblem) -> None:
    links = {link["link"]: link for link in model_json(small)["links"]}
    assert list(links) == [link.name for link in small.scene.robot.tree.links]
    kinds = {name: link["kind"] for name, link in links.items()}
    assert kinds == {
        "root_link": "box",
        "claw": "inertia of the file",
        **{f"{side}_arm": "composite" for side in "lr"},
        **{f"{side}_leg": "box" for side in "lr"},
        **{f"{side}_{frame}": "frame" for side in "lr" for frame in ("sole", "palm")},
    }
    arm = links["l_arm"]
    assert arm["solids"] == ["cylinder 0.04, 0.4", "sphere 0.05"]
    assert arm["shape"] == "cylinder 0.04, 0.4 + sphere 0.05"
    assert arm["longer_solids"] == [0]
    assert arm["axis"] == pytest.approx([0.0, 0.0, -1.0])
    assert (arm["dimension_m"], arm["about_centre"]) == (0.4, False)
    assert arm["mass_kg"] == pytest.approx(2.0)
    assert (links["claw"]["axis"], links["claw"]["density_kg_per_m3"]) == (None, None)


def stature(person: Tree) -> float:
    """From the sole to the top of the head's sphere, standing with all joints at zero."""
    frames = link_frames(person, Placement(), {})
    (look,) = person.link_by_name["Head"].looks
    assert isinstance(look.shape, Sphere)
    top = frames["Head"].apply(look.link_from_look.translation)[2] + look.shape.radius
    return float(top - frames["LeftSole"].translation[2])


def test_everyone_of_a_population_is_listed(problem: DesignProblem) -> None:
    person = 'stature_m = 1.82\nmass_kg = 72.7\nsex = "male"'
    crowd = 'population = { sex = "both", percentiles = [5, 95] }'
    source = problem.source
    several = build_problem(ProblemSource(source.path, source.text.replace(person, crowd), source.files))
    robot, *people = model_json(several)["agents"]
    assert "who" not in robot
    assert [one["who"] for one in people] == ["female P5", "female P95", "male P5", "male P95"]
    assert [one["mass_kg"] for one in people] == pytest.approx([50.7, 119.2, 60.9, 131.8])
    assert [one["sex"] for one in people] == ["female", "female", "male", "male"]
    for one in people:
        tree = next(each.human.tree for each in several.scenes if each.human.label == one["who"])
        assert one["stature_m"] == pytest.approx(stature(tree))
    for width in (80, 110):
        out = StringIO()
        Console(file=out, width=width).print(model_tables(several)[0])
        assert "│ human │ male P95" in out.getvalue()
        assert max(map(len, out.getvalue().splitlines())) <= width
    assert "who" not in model_json(problem)["agents"][1]


def test_every_load_is_listed(problem: DesignProblem) -> None:
    source = problem.source
    one = "[payload]\nsize_m = [0.5, 0.5, 0.025]\nmass_kg = 5.0\n"
    assert one in source.text
    box = '[[payload]]\nname = "[box]"\nsize_m = [0.4, 0.3, 0.2]\nmass_kg = 12\n'
    two = one.replace("[payload]", "[[payload]]") + box
    several = build_problem(ProblemSource(source.path, source.text.replace(one, two), source.files))
    told = model_json(several)
    assert "payload" not in told
    assert told["payloads"] == [
        {"payload_name": "5 kg", "size_m": [0.5, 0.5, 0.025], "mass_kg": 5.0},
        {"payload_name": "[box]", "size_m": [0.4, 0.3, 0.2], "mass_kg": 12.0},
    ]
    out = StringIO()
    Console(file=out, width=110).print(model_tables(several)[1])
    assert "│ 5 kg, 0.5 x 0.5 x 0.025 m" in out.getvalue()
    assert "│ [box]: 12 kg, 0.4 x 0.3 x 0.2 m" in out.getvalue()
    assert "payloads" not in model_json(problem)


def test_a_density_parameter_does_not_grow(small: DesignProblem) -> None:
    length, density = model_json(small)["parameters"]
    assert (length["unit"], density["unit"]) == ("1", "kg/m^3")
    assert all(link["axis"] is not None for link in length["links"])
    assert all(link["axis"] is None for link in density["links"])


@pytest.mark.parametrize("width", [80, 110])
def test_tables_fit_the_terminal_and_cut_nothing_off(small: DesignProblem, width: int) -> None:
    out = StringIO()
    for table in model_tables(small):
        Console(file=out, width=width).print(table)
    text = out.getvalue()
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in text.splitlines() if "│" in line]
    at = next(i for i, row in enumerate(rows) if row[0] == "l_arm")
    assert rows[at][1:3] == ["cylinder 0.04, 0.4", "-z"]
    assert rows[at + 1] == ["", "sphere 0.05", "-", "", ""]
    assert ["root_link", "box 0.2, 0.3, 0.4", "+-z"] in [row[:3] for row in rows]
    assert "without mass: l_sole, r_sole, l_palm, r_palm" in text


def test_disturbances_are_told_in_words(problem: DesignProblem) -> None:
    out = StringIO()
    Console(file=out, width=110).print(model_tables(build_problem(source_with(problem, TABLES)))[1])
    assert "heavier: load +20%" in out.getvalue()
    assert "N on the robot" in out.getvalue()
