"""The tables of docs/people.md, computed again."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.evaluation.evaluate import Evaluator, detail_of
from evodesign.human.endurance import endurance_tables
from evodesign.human.population import population, population_table
from evodesign.human.strength import joint_strengths, strength_tables
from evodesign.mechanics.agent import HUMAN
from evodesign.problem.build import DesignProblem
from evodesign.quantities.ergonomics import ergonomics


@pytest.fixture(scope="module")
def rows(repository: Path) -> list[list[str]]:
    """Cells of every row of every table."""
    text = (repository / "docs" / "people.md").read_text(encoding="utf-8")
    return [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in text.splitlines()
        if line.startswith("|") and not line.startswith("|---")
    ]


def starting(rows: list[list[str]], *first: str) -> list[list[str]]:
    return [row for row in rows if row[0].startswith(first)]


def test_the_population_is_the_table_that_people_are_made_of(rows: list[list[str]]) -> None:
    table = population_table()
    expected = [["percentile", *(f"{percentile:g}" for percentile in table.percentiles)]]
    for who, of in (("women", table.female), ("men", table.male)):
        expected.append([f"{who}, stature [m]", *(f"{value:.3f}" for value in of.stature_m)])
        expected.append([f"{who}, mass [kg]", *(f"{value:.1f}" for value in of.mass_kg)])
    assert starting(rows, "percentile", "women, ", "men, ") == expected


def test_the_strengths_are_those_of_the_median_woman_and_man(rows: list[list[str]]) -> None:
    people = population("both", (50.0,))
    woman, man = (joint_strengths(people[f"{sex} P50"], from_memory=True) for sex in ("female", "male"))
    sources = strength_tables().sources
    expected = []
    for row in strength_tables().rows:
        for sign in ("negative", "positive"):
            way = getattr(row, sign)
            if way is not None:
                moments = [getattr(of[row.joints[0]], sign).moment for of in (woman, man)]
                figures = [f"{moment:.0f}" for moment in moments]
                mark = " (from memory, not used)" if sources[way.source].from_memory else ""
                expected.append([", ".join(row.joints), way.movement, *figures, f"{way.source}{mark}"])
    assert [row for row in rows if row[0].startswith("j")] == [
        ["joints", "movement", "women", "men", "source"],
        *expected,
    ]


def test_every_source_is_described_and_what_is_from_memory_says_so(rows: list[list[str]]) -> None:
    sources = strength_tables().sources
    described = {row[0]: row[2] for row in rows if row[0] in sources}
    assert set(described) == set(sources)
    for name, source in sources.items():
        assert ("memory" in described[name]) == ("memory" in source.checked) == source.from_memory


def test_the_warning_figures_of_the_95th_percentile_are_true(repository: Path) -> None:
    text = (repository / "docs" / "people.md").read_text(encoding="utf-8")
    people = population("both", (95.0,))
    woman, man = people["female P95"], people["male P95"]
    indices = [person.mass / person.stature**2 for person in (man, woman)]
    assert f"index {indices[0]:.0f} for men, {indices[1]:.0f} for women" in " ".join(text.split())
    knee = joint_strengths(man)["jLeftKnee_roty"].negative
    assert knee is not None
    assert f"({knee.moment:.0f} N m of knee extension for men)" in text


def test_the_default_problem_asks_what_the_table_says(
    rows: list[list[str]], problem: DesignProblem, evaluator: Evaluator
) -> None:
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    shown = {row[0]: row[1:] for row in rows if row[0].endswith(" m")}
    assert set(shown) == {str(task) for task in problem.tasks}
    for height in result.cases:
        asked = ergonomics(problem.scene.human, detail_of(height).agents[HUMAN])
        torque, joint, *figures = shown[f"{height.case.task.height_m:g} m"]
        assert asked.strain is not None
        assert joint == f"{asked.strain.joint}, {asked.strain.movement}"
        found = (asked.strain.share, asked.task.horizontal, asked.recommended_weight, asked.lifting_index)
        assert height.postures[HUMAN].torque_norm == pytest.approx(float(torque), rel=0.01)
        assert found == pytest.approx([float(figure) for figure in figures], rel=0.05)


def test_holding_times_are_those_of_the_data(rows: list[list[str]]) -> None:
    tables = endurance_tables()
    curves = [(region.name, region, ", ".join(region.joints)) for region in tables.regions]
    curves.append(("general", tables.general, "all others: the hips"))
    expected = [
        [name, f"{of.seconds:g}", f"{of.exponent:g}", *(f"{of.at(s):.0f}" for s in (0.1, 0.3, 0.5)), joints]
        for name, of, joints in curves
    ]
    named = {name for name, *_ in curves}
    assert [row for row in rows if row[0] in named and len(row) == len(expected[0])] == expected
