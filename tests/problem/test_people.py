"""People of a problem file: populations, strengths, and the effort that follows from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.human.strength import joint_strengths
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value
from evodesign.records import ProblemSource, Status
from evodesign.tree.urdf_write import urdf_text

PERSON = 'stature_m = 1.82\nmass_kg = 72.7\nsex = "male"'
FROM_FILE = """urdf = "person.urdf"
hands = { left = "LeftPalm", right = "RightPalm" }
soles = { left = "LeftSole", right = "RightSole", size_m = [0.27, 0.10] }
trunk = ["Pelvis", "T8"]
"""


def changed(
    source: ProblemSource, *pairs: tuple[str, str], files: Mapping[str, str] | None = None
) -> ProblemSource:
    text = source.text
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return ProblemSource(source.path, text, {**source.files, **(files or {})})


def population(percentiles: str, sex: str = "both") -> str:
    return f'population = {{ sex = "{sex}", percentiles = {percentiles} }}'


def mass(tree_mass: DesignProblem, number: int) -> float:
    links = tree_mass.scenes[number].human.tree.links
    return sum(link.inertia.mass for link in links)


def test_a_population_is_one_person_per_sex_and_percentile(problem: DesignProblem) -> None:
    built = build_problem(changed(problem.source, (PERSON, population("[5, 50, 95]"))))
    labels = [scene.human.label for scene in built.scenes]
    assert labels == ["female P5", "female P50", "female P95", "male P5", "male P50", "male P95"]
    assert [mass(built, number) for number in range(6)] == pytest.approx(
        [50.7, 73.5, 119.2, 60.9, 86.6, 131.8]
    )
    assert built.scenes[3].human.strengths == joint_strengths(Person(1.622, 60.9, Sex.MALE))


def test_a_population_of_one_is_that_person_alone(problem: DesignProblem) -> None:
    built = build_problem(changed(problem.source, (PERSON, population("[50]", "female"))))
    (scene,) = built.scenes
    assert scene.human.label == ""
    assert mass(built, 0) == pytest.approx(73.5)


def test_a_population_stands_beside_single_people_under_its_name(problem: DesignProblem) -> None:
    lists = f'[[human]]\nname = "porter"\n{PERSON}\n\n[[human]]\nname = "team"\n{population("[25]")}'
    built = build_problem(changed(problem.source, (f"[human]\n{PERSON}", lists)))
    assert [scene.human.label for scene in built.scenes] == ["porter", "team female P25", "team male P25"]


def test_a_population_that_is_also_a_person_is_refused(problem: DesignProblem) -> None:
    both = changed(problem.source, (PERSON, f"{population('[50]')}\n{PERSON}"))
    with pytest.raises(InputError) as caught:
        build_problem(both)
    assert str(caught.value).endswith("human.stature_m: wanted either this key or population, found both")


def test_effort_needs_people_of_known_strength(problem: DesignProblem) -> None:
    files = {"person.urdf": urdf_text(human_tree(Person(1.75, 75.0, Sex.FEMALE)))}
    pairs = ((PERSON, FROM_FILE), ('"human_torque"', '"human_effort"'))
    with pytest.raises(InputError) as caught:
        build_problem(changed(problem.source, *pairs, files=files))
    assert str(caught.value).endswith(
        "objectives.minimise[1]: wanted people of known strength (stature_m, mass_kg and sex, or "
        "strengths_n_m), found 'human_effort' with a person 'human' of unknown strength"
    )
    given = "strengths_n_m = { jLeftKnee_roty = [200.0, 100.0] }\n"
    built = build_problem(changed(problem.source, (PERSON, FROM_FILE + given), pairs[1], files=files))
    (knee,) = built.scene.human.strengths.values()
    assert (knee.negative.moment, knee.positive.moment) == (200.0, 100.0)


def test_strengths_in_the_file_go_before_published_ones(problem: DesignProblem) -> None:
    given = f"{PERSON}\nstrengths_n_m = {{ jRightKnee_roty = [99.0, 98.0] }}"
    strengths = build_problem(changed(problem.source, (PERSON, given))).scene.human.strengths
    assert (strengths["jRightKnee_roty"].negative.movement, strengths["jRightKnee_roty"].negative.moment) == (
        "extension",
        99.0,
    )
    assert strengths["jLeftKnee_roty"] == problem.scene.human.strengths["jLeftKnee_roty"]


@pytest.fixture(scope="module")
def result(problem: DesignProblem, evaluator: Evaluator) -> DesignResult:
    return evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))


def efforts(result: DesignResult) -> list[float]:
    """The largest share of a strength at each height, by a loop over the joints."""
    found = []
    for height in result.cases:
        largest = 0.0
        for joint, torque in height.postures[HUMAN].torques.items():
            both = result.scene_of(height.case).human.strengths.get(joint)
            way = both and (both.negative if torque < 0.0 else both.positive)
            if way:
                largest = max(largest, abs(torque) / way.moment)
        found.append(largest)
    return found


def test_effort_is_the_largest_share_of_a_strength_meant_over_the_cases(result: DesignResult) -> None:
    expected = efforts(result)
    assert 0.0 < min(expected) < max(expected) < 1.0
    assert objective_value("human_effort", result) == pytest.approx(sum(expected) / 3.0)
    assert objective_value("worst_human_effort", result) == pytest.approx(max(expected))
    assert objective_value("q50_human_effort", result) == pytest.approx(sorted(expected)[1])


def test_the_sequels_cost_is_that_of_the_worst_pair(result: DesignResult) -> None:
    """Written again as a loop: the robot's torques over 160, two people of whom one has a single height."""
    people = ("first", "second", "first")
    cases = tuple(
        replace(solution, case=msgspec.structs.replace(solution.case, person=person))
        for solution, person in zip(result.cases, people, strict=True)
    )
    sums = dict.fromkeys(people, 0.0)
    for solution, person in zip(result.cases, people, strict=True):
        robot, human = ([*solution.postures[agent].torques.values()] for agent in (ROBOT, HUMAN))
        sums[person] += math.sqrt(sum((torque / 160.0) ** 2 for torque in robot)) + math.hypot(*human)
    assert sums["first"] > sums["second"] > 0.0
    of_two = replace(result, cases=cases)
    assert objective_value("paper2023_cost", of_two) == pytest.approx(sums["first"])
    assert objective_value("paper2023_cost", result) == pytest.approx(sum(sums.values()))
    lost = replace(cases[0], status=Status.INFEASIBLE, instants=())
    assert objective_value("paper2023_cost", replace(of_two, cases=(lost, *cases[1:]))) is None


def test_the_cost_of_2025_is_the_persons_squared_torques_and_a_millionth_of_the_robots(
    result: DesignResult,
) -> None:
    torques = {
        agent: sum(t * t for each in result.cases for t in each.postures[agent].torques.values())
        for agent in (ROBOT, HUMAN)
    }
    assert objective_value("paper2025_cost", result) == pytest.approx(torques[HUMAN] + 1e-6 * torques[ROBOT])
    lost = (replace(result.cases[0], status=Status.INFEASIBLE, instants=()), *result.cases[1:])
    assert objective_value("paper2025_cost", replace(result, cases=lost)) is None


def test_a_person_twice_as_strong_has_half_the_effort(result: DesignResult) -> None:
    strong = {
        name: replace(
            both,
            negative=both.negative and replace(both.negative, moment=2.0 * both.negative.moment),
            positive=both.positive and replace(both.positive, moment=2.0 * both.positive.moment),
        )
        for name, both in result.scenes[0].human.strengths.items()
    }
    scene = result.scenes[0].with_agents(replace(result.scenes[0].human, strengths=strong))
    once, twice = (objective_value("human_effort", of) for of in (result, replace(result, scenes=(scene,))))
    assert twice == pytest.approx(once / 2.0)
