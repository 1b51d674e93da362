"""Samples of people: a sample is the problem that says `posture_sample`, and evaluated as that problem is."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.factory import evaluator_of, problem_digest
from evodesign.evaluation.precompute import precompute_setting
from evodesign.evaluation.sampled_designs import sampled_beside, sampled_factory
from evodesign.human.measured_posture import MEAN_PERSON, drawn_person
from evodesign.pool.base import Pool
from evodesign.pool.registry import make_pool
from evodesign.posture.formulations.base import program_key
from evodesign.posture.precompute.plan import all_mean_people
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.samples import refuse_unsampled, sampled_source
from evodesign.problem.source import source_of
from evodesign.records import ProblemSource
from tests.measured_people import LIFTING, measured_tables

SAMPLES, DESIGNS = 10, 10


def source(**human: Any) -> ProblemSource:
    return source_of(measured_tables(**human), LIFTING)


def some_designs(problem: DesignProblem, count: int) -> list[tuple[float, ...]]:
    rng = np.random.default_rng(3)
    genomes = rng.uniform(0.3, 0.7, (count, len(problem.space.parameters)))
    return [problem.space.values(tuple(genome)) for genome in genomes.tolist()]


@pytest.fixture(scope="module")
def pool() -> Pool:
    return make_pool("serial", 1)


@pytest.mark.slow
@pytest.mark.parametrize(("grasp", "samples", "designs"), [("rigid", SAMPLES, DESIGNS), ("point", 3, 2)])
def test_samples_of_designs_agree_with_separate_runs(
    grasp: str, samples: int, designs: int, pool: Pool
) -> None:
    """To the last bit: a problem of its own for each sample, with programs of its own."""
    asked = source_of(measured_tables(grasp, spread=samples), LIFTING)
    chosen = some_designs(build_problem(asked), designs)
    together = sampled_factory(asked, [*range(1, samples + 1)], pool)()
    torques = []
    for sample in range(1, samples + 1):
        alone = evaluator_of(
            build_problem(source_of(measured_tables(grasp, posture_sample=sample), LIFTING)), 1
        )
        for values in chosen:
            expected = alone.assess_values(values)
            assert together((sample, values)) == expected
            assert expected.assessment.violation == 0.0
            torques.append(expected.assessment.objectives["worst_human_torque"])
    spread = np.reshape(torques, (samples, designs)).std(axis=0)
    assert (spread > 1.0).all(), "people differ"


def test_the_designs_of_a_problem_meet_all_its_samples(pool: Pool) -> None:
    problem = build_problem(source(spread=2))
    first, second = some_designs(problem, 2)
    found = sampled_beside(problem, [first, second], 1)
    assert [(each.sample, each.design) for each in found] == [(1, 0), (1, 1), (2, 0), (2, 1)]
    assess = sampled_factory(problem.source, [2], pool)()
    assert found[3].assessment == assess((2, second)).assessment


def test_a_sample_is_the_problem_that_says_so() -> None:
    made = sampled_source(source(spread=4), 3)
    (own,) = tomllib.loads(made.text)["human"]
    assert own["posture_sample"] == 3
    assert "spread" not in own
    drawn = build_problem(made).scene.human.measured
    mean = build_problem(source()).scene.human.measured
    assert drawn is not None
    assert mean is not None
    assert (drawn.drawn, mean.drawn) == (drawn_person(3), MEAN_PERSON)
    assert build_problem(source(spread=4)).samples == 4
    assert (build_problem(made).samples, build_problem(source()).samples) == (0, 0)


def test_where_some_people_have_a_spread_the_others_stay_the_mean() -> None:
    several = measured_tables()
    first = several["human"][0]
    several["human"] = [{**first, "name": "a", "spread": 3}, {**first, "name": "b"}]
    drawn = [
        scene.human.measured for scene in build_problem(sampled_source(source_of(several, LIFTING), 2)).scenes
    ]
    assert [each is not None and each.drawn for each in drawn] == [drawn_person(2), MEAN_PERSON]
    del several["human"][0]["spread"]
    drawn = [
        scene.human.measured for scene in build_problem(sampled_source(source_of(several, LIFTING), 2)).scenes
    ]
    assert [each is not None and each.drawn for each in drawn] == [drawn_person(2)] * 2


def test_samples_share_programs_and_starts() -> None:
    mean, drawn = (
        build_problem(source_of(measured_tables("point", **keys), LIFTING))
        for keys in ({}, {"posture_sample": 2})
    )
    assert all_mean_people(precompute_setting(drawn)) == precompute_setting(mean)
    keys = [program_key("joint", scene, scene.human) for scene in (mean.scene, drawn.scene)]
    assert keys[0] == keys[1]


def test_a_spread_changes_no_evaluation() -> None:
    plain, spread, sample = source(), source(spread=10), source(posture_sample=3)
    assert problem_digest(plain) == problem_digest(spread) != problem_digest(sample)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (
            lambda: source(posture="least_torque", spread=10),
            'human[0].spread: wanted posture = "measured", which has a distribution of people, or no such '
            "key, found 10 of one posture",
        ),
        (
            lambda: source(posture="least_torque", posture_sample=1),
            'human[0].posture_sample: wanted posture = "measured", which has a distribution of people, or no '
            "such key, found 1 of one posture",
        ),
        (
            lambda: source(spread=10, posture_sample=1),
            "human[0].spread: wanted either how many people to draw, or spread left out: this one is drawn "
            "already, found both, and posture_sample = 1",
        ),
        (lambda: source(spread=1), "human[0].spread: wanted a whole number >= 2, found 1"),
    ],
)
def test_a_spread_of_what_has_none_is_refused_in_a_sentence(
    make: Callable[[], ProblemSource], sentence: str
) -> None:
    with pytest.raises(InputError) as caught:
        build_problem(make())
    assert str(caught.value) == f"the problem given: {sentence}"


def test_people_who_cannot_be_drawn_and_unequal_numbers_are_refused() -> None:
    with pytest.raises(InputError, match='wanted a person with posture = "measured"'):
        refuse_unsampled(source(posture="least_torque"))
    refuse_unsampled(source())
    several = measured_tables()
    first = several["human"][0]
    several["human"] = [{**first, "name": "a", "spread": 3}, {**first, "name": "b", "spread": 4}]
    with pytest.raises(
        InputError, match=r"human\[1\].spread: wanted the same number for all people, 3, found 4"
    ):
        build_problem(source_of(several, LIFTING))
