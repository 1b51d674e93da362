"""What a load adds to a person's torques: by hand, by pinocchio, in solved postures; its derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import HUMAN, SIDES
from evodesign.posture.check import AgentModel
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem
from evodesign.quantities.person_quantities import added_by_load, load_torque, load_torque_by_posture
from tests.problem.standing_people import PERSON, POSTURES, least_torques, standing

NOTHING = dict.fromkeys(SIDES, (0.0,) * 6)


@pytest.mark.parametrize("name", POSTURES)
def test_it_is_the_torques_with_the_load_less_those_with_empty_hands(name: str) -> None:
    """Both by hand: weights, places and the least torques over all foot wrenches."""
    posture = standing(name)
    loaded, _ = least_torques(posture, weight=True)
    empty, _ = least_torques(standing(name, NOTHING), weight=True)
    found = added_by_load(PERSON, posture).torques
    assert found.tolist() == pytest.approx(list(loaded - empty), abs=1e-8)
    norm = float(np.linalg.norm(loaded - empty))
    assert load_torque(PERSON, posture) == pytest.approx(norm, abs=1e-8)
    assert norm > 20.0


def by_pinocchio(posture: AgentPosture, *, loaded: bool) -> np.ndarray:
    state = AgentModel.of(PERSON, PERSON.tree).at(posture)
    rows = np.array(state.bias)
    for side in SIDES if loaded else ():
        rows -= state.jacobian_in_world(PERSON.frame(f"{side}_hand")).T @ posture.wrenches[f"{side}_hand"]
    feet = np.hstack([state.jacobian_in_frame(PERSON.frame(f"{side}_foot")).T for side in SIDES])
    some = np.linalg.pinv(feet[:6]) @ rows[:6]
    free = null_space(feet[:6])
    torques = rows[6:] - feet[6:] @ some
    moved = feet[6:] @ free
    return np.asarray(torques - moved @ (np.linalg.pinv(moved) @ torques))


@pytest.mark.parametrize("name", POSTURES)
def test_pinocchio_finds_the_same(name: str) -> None:
    posture = standing(name)
    expected = by_pinocchio(posture, loaded=True) - by_pinocchio(posture, loaded=False)
    assert added_by_load(PERSON, posture).torques.tolist() == pytest.approx(list(expected), abs=1e-7)


def test_empty_hands_add_nothing() -> None:
    posture = standing("stooped", NOTHING)
    assert load_torque(PERSON, posture) == 0.0
    slopes = load_torque_by_posture(PERSON, posture)
    assert np.abs(slopes.base_angles).max() == 0.0


@pytest.mark.parametrize("name", POSTURES)
def test_its_derivatives_are_those_of_differences(name: str) -> None:
    posture, generator = standing(name), np.random.default_rng(3)
    slopes = load_torque_by_posture(PERSON, posture)
    for _ in range(5):
        step = AgentPosture(
            np.zeros(3),
            generator.standard_normal(3),
            {joint: generator.standard_normal() for joint in posture.joints},
            {},
            {f"{side}_hand": 10.0 * generator.standard_normal(6) for side in SIDES},
        )
        ends = [load_torque(PERSON, moved(posture, step, size)) for size in (1e-5, -1e-5)]
        assert (ends[0] - ends[1]) / 2e-5 == pytest.approx(slopes.along(step), rel=1e-7)


def moved(posture: AgentPosture, step: AgentPosture, size: float) -> AgentPosture:
    return replace(
        posture,
        base_angles=posture.base_angles + size * step.base_angles,
        joints={name: at + size * step.joints[name] for name, at in posture.joints.items()},
        wrenches={
            name: at + size * step.wrenches.get(name, np.zeros(6)) for name, at in posture.wrenches.items()
        },
    )


def test_solved_torques_less_it_are_those_of_the_person_with_empty_hands(
    problem: DesignProblem, evaluator: Evaluator
) -> None:
    """No limit of a foot's contact holds these postures: their foot wrenches are those of least torques."""
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    person = problem.scene.human
    model = AgentModel.of(person, person.tree)
    for solution in result.cases:
        posture = solution.postures[HUMAN]
        state = model.at(posture)
        feet = np.hstack([state.jacobian_in_frame(person.frame(f"{side}_foot")).T for side in SIDES])
        some, free = np.linalg.pinv(feet[:6]) @ state.bias[:6], null_space(feet[:6])
        empty, by_free = state.bias[6:] - feet[6:] @ some, feet[6:] @ free
        empty = empty - by_free @ (np.linalg.pinv(by_free) @ empty)
        added = np.array([posture.torques[name] for name in person.joints]) - empty
        assert added_by_load(person, posture).torques.tolist() == pytest.approx(list(added), abs=1e-3)
