"""How high and low a person can hold a load, against the posture problem of the person alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.precompute import precompute_setting, refuse_heights
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.nlp.solver import SolverCache
from evodesign.posture.formulations.person import PersonProblem
from evodesign.posture.formulations.reach import person_reach
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.pieces import compute_piece, with_piece
from evodesign.posture.precompute.plan import Piece, Subject, stages
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED, PersonReach
from evodesign.posture.symmetry import symmetric_forms
from evodesign.problem.build import DesignProblem
from evodesign.quantities.objectives import objective_value
from evodesign.records import Hold, Objective, Sense

ALONE = ("", "")
"""The names of one person and one load."""


@pytest.fixture(scope="module")
def reach(problem: DesignProblem) -> PersonReach:
    found = person_reach(problem.scene, "human", problem.options, symmetric=True)
    assert found is not None
    return found


def holds(problem: DesignProblem, height: float) -> bool:
    """Whether the person's own posture problem has a solution, from many starts."""
    form, scene = symmetric_forms(problem.scene)[1], problem.scene
    person = PersonProblem(form, scene, 1.0, problem.options, SolverCache())
    return person.best_of_many(height, 0.0) is not None


@pytest.mark.slow
def test_the_person_holds_the_load_up_to_there_and_no_further(
    problem: DesignProblem, reach: PersonReach
) -> None:
    assert holds(problem, reach.highest - 0.005)
    assert not holds(problem, reach.highest + 0.02)


def test_a_shorter_person_reaches_less_high(problem: DesignProblem, reach: PersonReach) -> None:
    """Proportions are those of stature, so the highest load is, but for the box's thickness."""
    tree = human_tree(Person(1.6, 60.0, Sex.MALE))
    scene = problem.scene.with_agents(replace(problem.scene.human, tree=tree))
    shorter = person_reach(scene, "human", problem.options, symmetric=True)
    assert shorter is not None
    assert shorter.highest / reach.highest == pytest.approx(1.6 / 1.82, abs=0.03)


def test_a_kept_reach_is_the_one_that_was_worked_out(problem: DesignProblem, reach: PersonReach) -> None:
    setting, piece = precompute_setting(problem), Piece(Subject.PERSON_REACH, ALONE)
    known = with_piece(NOTHING_PRECOMPUTED, piece, compute_piece(setting, piece, NOTHING_PRECOMPUTED))
    assert known is not None
    assert known.person_reaches == {ALONE: reach}
    other = replace(setting, space=replace(setting.space, parameters=setting.space.parameters[:1]))
    assert key_of(other, piece) == key_of(setting, piece), "it does not depend on the robot's hardware"
    found = stages(setting, (Hold(height_m=1.0),), portfolios=False, person_reaches=True)
    asked = [piece.subject for stage in found for piece in stage]
    assert Subject.PERSON_REACH in asked


def test_the_shared_reach_ends_where_the_first_can_go_no_higher(
    problem: DesignProblem, reach: PersonReach, evaluator: Evaluator
) -> None:
    low = replace(
        NOTHING_PRECOMPUTED, person_reaches={("tall", ""): reach, ("short", ""): PersonReach(0.1, 1.3)}
    )
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    assert objective_value("shared_reach_height", result) is None, "nobody asked for the people's reach"
    assert result.reach.highest is not None
    assert result.reach.highest > 1.3
    highest = min(each.highest for each in low.person_reaches.values())
    assert objective_value("shared_reach_height", replace(result, people_highest=highest)) == 1.3
    beyond = replace(result, people_highest=2.0)
    assert objective_value("shared_reach_height", beyond) == result.reach.highest


def test_a_height_that_somebody_cannot_hold_is_refused(problem: DesignProblem) -> None:
    known = replace(NOTHING_PRECOMPUTED, person_reaches={ALONE: PersonReach(0.9, 1.9)})
    with pytest.raises(InputError, match=r"task\.heights_m\[0\]: wanted a height that the person can hold"):
        refuse_heights(problem, known)
    refuse_heights(problem, replace(NOTHING_PRECOMPUTED, person_reaches={ALONE: PersonReach(0.8, 1.9)}))


def test_a_person_who_holds_the_load_nowhere_is_refused(problem: DesignProblem) -> None:
    """Left out, the others' reach would pass for everyone's."""
    shared = Objective(name="shared_reach_height", sense=Sense.MAXIMISE, unit="m")
    asking = replace(problem, objectives=(*problem.objectives, shared))
    with pytest.raises(InputError, match="people who can hold every load, found the person, at no height"):
        refuse_heights(asking, NOTHING_PRECOMPUTED)
    refuse_heights(asking, replace(NOTHING_PRECOMPUTED, person_reaches={ALONE: PersonReach(0.1, 1.9)}))
