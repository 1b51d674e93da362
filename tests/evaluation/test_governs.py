"""What governs walls and actuators, of random postures that nobody solved for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.governs import governing, sentences
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from tests.report.scenes import random_detail

LINKS = 30
BOUND = "mass_kg = { upper = 65.0 }"


def bill(repository: Path, *changes: tuple[str, str]) -> tuple[DesignProblem, dict[str, Any]]:
    """Of the unscaled robot of the problem of hardware."""
    source = read_source(repository / "problems" / "icub_hardware.toml")
    for before, after in changes:
        assert before in source.text
        source = msgspec.structs.replace(source, text=source.text.replace(before, after))
    problem = build_problem(source)
    space, robot = problem.space, problem.scene.robot
    tree = space.resized(robot.tree, space.given(space.unscaled(robot.tree), {}))
    return problem, bill_of_materials(problem, tree, random_detail(problem, 3).cases)


def test_load_cases_count_and_every_group_of_joints_is_named(repository: Path) -> None:
    problem, found = bill(repository)
    alone = {case.name for case in problem.stances}
    assert {row["safety_case"] for row in found["links"].values()} & alone
    walls, actuators = found["governs"]
    assert walls.startswith("walls: nothing but the problem file (2 mm) governs; the least safety factor is ")
    beams = {link: row for link, row in found["links"].items() if row["safety_factor"]}
    weakest = min(beams, key=lambda link: beams[link]["safety_factor"])
    row = beams[weakest]
    assert f"({row['safety_mode']} of {weakest}, {row['safety_case']})" in walls
    assert 0.0 < sum(row["deflection_share"] for row in beams.values()) < 1.0
    named = [group for part in actuators.split("; ") for group in part.partition("governs ")[2].split(", ")]
    assert sorted(named) == sorted({row["actuator"] for row in found["joints"].values()})


def test_without_postures_and_load_cases_nothing_that_was_solved_governs_actuators(repository: Path) -> None:
    problem, found = bill(repository)
    sizes = {joint: row | {"asked_by": None, "share": 0.0} for joint, row in found["joints"].items()}
    joint = next(iter(sizes))
    sizes = {name: row for name, row in sizes.items() if row["actuator"] == sizes[joint]["actuator"]}
    for rated, by in ((10.0, "nothing that was solved"), (2.5, "the smallest size")):
        rows = {name: row | {"rated_torque_n_m": rated} for name, row in sizes.items()}
        said = list(sentences(problem, {"links": {}, "joints": rows}))
        assert said == [f"actuators: {by} governs {sizes[joint]['actuator']}"]


def test_stiffness_governs_links_with_a_share_where_the_hands_reach_their_bound(repository: Path) -> None:
    problem, found = bill(repository, (BOUND, BOUND + "\nworst_hand_deflection_mm = { upper = 0.5 }"))
    shares = {link: row["deflection_share"] for link, row in found["links"].items()}
    for largest, by in ((0.5, "stiffness"), (0.4, "problem file")):
        governed = governing(problem, found["links"], {"1 m": 0.1, "1.2 m": largest})
        assert {governed[link] for link, share in shares.items() if share} == {by}
        assert {governed[link] for link, share in shares.items() if not share} <= {"problem file"}


@pytest.mark.parametrize(
    ("change", "by", "words"),
    [
        (("share = 0.3", "share = 0.3\nleast_wall_m = 0.002"), "least wall", "can be made (2 mm) governs;"),
        ((BOUND, BOUND + "\nleast_safety_factor = { lower = 1e9 }"), "wall buckling", "wall buckling (2 mm)"),
    ],
)
def test_what_reaches_its_bound_governs(
    repository: Path, change: tuple[str, str], by: str, words: str
) -> None:
    _, found = bill(repository, change)
    rows = found["links"].values()
    assert sum(row["governed_by"] == by for row in rows) > LINKS / 3
    assert words in found["governs"][0]
