"""Derivatives of standing torques and masses by the design, against pinocchio's own of neighbours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evodesign.mechanics.floating_base import FloatingBody
from evodesign.mechanics.robot_gradient import OF_MASSES, RobotGradient
from evodesign.mechanics.stance_case import RaisedHand, StanceCase
from evodesign.mechanics.stance_torques import stance_torques
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from tests.mechanics.test_stance_case import ONE_LEG, SQUAT

LOADED = replace(SQUAT, loads=(("l_hand_frame", (8.0, -3.0, -40.0)), ("r_hand_frame", (-5.0, 2.0, -55.0))))
RAISED = replace(
    ONE_LEG,
    loads=(("l_hand_frame", (4.0, 6.0, -20.0)),),
    raised=RaisedHand("l_hand_frame", 0.8, ("l_shoulder_pitch",), ((-3.0, 3.0),)),
)
STEP = 1e-5
"""As a share of a value."""


@pytest.fixture(scope="module")
def designs(repository: Path) -> DesignProblem:
    """Lengths, sections, places and tilts of joints, and mounted actuators of any size."""
    return build_problem(read_source(repository / "problems" / "icub_geometry.toml"))


@pytest.mark.parametrize(
    "case", [SQUAT, ONE_LEG, LOADED, RAISED], ids=["squat", "one leg", "loaded", "raised"]
)
def test_standing_torques_move_as_those_of_neighbouring_designs(
    designs: DesignProblem, case: StanceCase
) -> None:
    space, agent = designs.space, designs.scene.robot
    family = space.family(designs.scene.designed_tree)
    gradient = RobotGradient(family, agent, [case]).stances[0]
    rng = np.random.default_rng(7)
    values = np.array(space.given(space.values(tuple(0.3 + 0.4 * rng.random(len(space.parameters)))), {}))

    def torques(moved: np.ndarray) -> tuple[np.ndarray, tuple[float, ...]]:
        tree = family.resized(moved.tolist())
        found = stance_torques(FloatingBody.of_tree(tree, agent.joints, np.eye(3)), case)
        assert not found.reason
        return np.array([found.torques[name] for name in agent.joints]), found.offsets

    _, offsets = torques(values)
    weights = rng.normal(size=len(agent.joints))
    found = gradient.along(values, offsets, dict(zip(agent.joints, weights.tolist(), strict=True)))
    for place, value in enumerate(values):
        step = STEP * (abs(value) or 1.0) * np.eye(len(values))[place]
        difference = weights @ (torques(values + step)[0] - torques(values - step)[0]) / (2.0 * step[place])
        assert found[place] == pytest.approx(difference, rel=1e-6, abs=1e-6), space.parameters[place].name


@pytest.mark.parametrize("name", OF_MASSES)
def test_masses_move_as_those_of_neighbouring_designs(designs: DesignProblem, name: str) -> None:
    space, agent = designs.space, designs.scene.robot
    family = space.family(designs.scene.designed_tree)
    values = np.array(space.given(space.values((0.4,) * len(space.parameters)), {}))
    found = RobotGradient(family, agent, ()).of_masses(name, values)
    for place, value in enumerate(values):
        step = STEP * (abs(value) or 1.0) * np.eye(len(values))[place]
        below, above = (
            float(OF_MASSES[name](family.resized((values + sign * step).tolist()), agent.foot_frames))
            for sign in (-1.0, 1.0)
        )
        assert found[place] == pytest.approx((above - below) / (2.0 * step[place]), rel=1e-6, abs=1e-8)
