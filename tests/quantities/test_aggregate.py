"""Several people and loads: each design is evaluated with all of them."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.baseline import Baseline
from evodesign.evaluation.evaluate import Evaluator, case_outcome
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_kind, objective_value

pytestmark = pytest.mark.slow

TALL = 'stature_m = 1.9\nmass_kg = 85.0\nsex = "male"\n'
SHORT = 'name = "short"\nstature_m = 1.6\nmass_kg = 60.0\nsex = "female"\n'
LIGHT = "size_m = [0.5, 0.5, 0.025]\nmass_kg = 5.0\n"
HEAVY = 'name = "box"\nsize_m = [0.5, 0.5, 0.025]\nmass_kg = 15.0\n'


def written(place: Path, repository: Path, people: list[str], loads: list[str]) -> Path:
    """The point-grasp problem with other people and loads, at one height and without seeds."""
    text = (repository / "problems" / "point_grasp.toml").read_text()
    before, after = text.split("[human]\n")[0], text.split("[task]\n")[1]
    tables = [f"[[human]]\n{person}" for person in people] + [f"[[payload]]\n{load}" for load in loads]
    text = before + "\n".join(tables) + "\n[task]\n" + after
    for old, new in (
        ("robots/", f"{repository}/problems/robots/"),
        ('start = "../populations/icub.toml"\n', ""),
        ("heights_m = [0.8, 1.0, 1.2]", "heights_m = [1.0]"),
    ):
        assert old in text
        text = text.replace(old, new)
    path = place / "problem.toml"
    path.write_text(text + "\n[solver]\ncompile = false\nstart_portfolio = false\n")
    return path


def built(place: Path, repository: Path, people: list[str], loads: list[str]) -> DesignProblem:
    return build_problem(read_source(written(place, repository, people, loads)))


def solved(problem: DesignProblem) -> DesignResult:
    return Evaluator(problem).solve(problem.space.unscaled(problem.scene.robot.tree))


@pytest.fixture(scope="module")
def everyone(tmp_path_factory: pytest.TempPathFactory, repository: Path) -> DesignResult:
    """The unscaled robot with two people and two loads."""
    place = tmp_path_factory.mktemp("everyone")
    return solved(built(place, repository, [TALL, SHORT], [LIGHT, HEAVY]))


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory, repository: Path) -> list[DesignResult]:
    """The same robot with each of them alone, in the same order."""
    pairs = [(person, load) for person in (TALL, SHORT) for load in (LIGHT, HEAVY)]
    return [
        solved(built(tmp_path_factory.mktemp("alone"), repository, [person], [load]))
        for person, load in pairs
    ]


@pytest.mark.parametrize("name", ["robot_torque", "human_torque"])
def test_an_objective_over_all_cases_is_made_of_what_each_gives_alone(
    name: str, everyone: DesignResult, alone: list[DesignResult]
) -> None:
    values = [objective_value(name, result) for result in alone]
    assert None not in values
    single = np.sort(np.array(values, float))
    assert objective_value(f"worst_{name}", everyone) == pytest.approx(single[-1], rel=1e-4)
    assert objective_value(name, everyone) == pytest.approx(single.sum() / 4.0, rel=1e-4)
    # between the second and the third of four, at a share of 2/3 * 3 - 1.98 of the way
    assert objective_value(f"q66_{name}", everyone) == pytest.approx(
        0.02 * single[1] + 0.98 * single[2], rel=1e-4
    )


def test_one_more_person_never_improves_the_worst_case(
    tmp_path: Path, repository: Path, everyone: DesignResult
) -> None:
    fewer = solved(built(tmp_path, repository, [TALL], [LIGHT, HEAVY]))
    for name in ("worst_robot_torque", "worst_human_torque"):
        before, after = objective_value(name, fewer), objective_value(name, everyone)
        assert before is not None
        assert after is not None
        assert after >= before * (1.0 - 1e-6)


def test_the_reach_is_that_of_the_load_that_is_hardest_to_hold(
    everyone: DesignResult, alone: list[DesignResult]
) -> None:
    reaches = [result.reach for result in alone]
    assert everyone.reach.highest == min(reach.highest for reach in reaches if reach.highest is not None)
    assert everyone.reach.lowest == max(reach.lowest for reach in reaches if reach.lowest is not None)


def test_people_and_loads_are_named_where_there_are_several(
    tmp_path: Path, repository: Path, everyone: DesignResult, alone: list[DesignResult]
) -> None:
    problem = built(tmp_path, repository, [TALL, SHORT], [LIGHT, HEAVY])
    found = Evaluator(problem).assessment(everyone.values, everyone)
    names = [outcome.case.pair for outcome in found.cases]
    assert names == [(h, p) for h in ("male 1.9 m 85 kg", "short") for p in ("5 kg", "box")]
    single = case_outcome(alone[0].cases[0])
    assert b"_name" not in msgspec.json.encode(single)


@pytest.mark.parametrize(
    "name", ["q0_robot_torque", "q100_robot_torque", "q50_mass", "q_robot_torque", "best_mass"]
)
def test_other_ways_over_cases_are_no_objectives(name: str) -> None:
    assert objective_kind(name) is None


@pytest.mark.parametrize(
    ("people", "loads", "found"),
    [
        ([SHORT, SHORT], [LIGHT], "human[1].name: wanted a name of its own, found 'short' twice"),
        ([TALL], [LIGHT, LIGHT], "payload[1].name: wanted a name of its own, found '5 kg' twice"),
        ([TALL, SHORT.replace("1.6", "3.6")], [LIGHT], "human[1].stature_m: wanted a number from"),
        ([TALL, SHORT.replace("sex", "sexe")], [LIGHT], "human[1].sexe: wanted one of the keys"),
        ([TALL], [LIGHT, HEAVY.replace("15.0", "-1.0")], "payload[1].mass_kg: wanted"),
        ([TALL], [LIGHT, HEAVY + "center_of_mass_m = [0.0, 0.0, 1.0]\n"], "payload[1].center_of_mass_m[2]"),
        ([], [LIGHT], "wanted a [human] for 'human_torque'"),
    ],
)
def test_one_of_several_people_or_loads_is_refused_by_its_place(
    tmp_path: Path, repository: Path, people: list[str], loads: list[str], found: str
) -> None:
    with pytest.raises(InputError) as refused:
        built(tmp_path, repository, people, loads)
    assert found in str(refused.value)


def test_the_joint_problem_is_for_one_person_and_one_load(tmp_path: Path, repository: Path) -> None:
    with pytest.raises(InputError, match="one person and one load in the joint problem, found 2 pairs"):
        Baseline(built(tmp_path, repository, [TALL, SHORT], [LIGHT]))
