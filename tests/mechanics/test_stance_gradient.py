"""Derivatives of standing torques and masses by the design, against pinocchio's own of neighbours."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from evodesign.mechanics.agent import Agent
from evodesign.mechanics.floating_base import FloatingBody
from evodesign.mechanics.robot_gradient import OF_MASSES, RobotGradient
from evodesign.mechanics.stance_case import RaisedHand
from evodesign.mechanics.stance_torques import stance_torques
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.tree.model import Tree
from tests.mechanics.test_stance_case import ONE_LEG, SQUAT

LOADED = replace(SQUAT, loads=(("l_hand_frame", (8.0, -3.0, -40.0)), ("r_hand_frame", (-5.0, 2.0, -55.0))))
RAISED = replace(
    ONE_LEG,
    loads=(("l_hand_frame", (4.0, 6.0, -20.0)),),
    raised=RaisedHand("l_hand_frame", 0.8, ("l_shoulder_pitch",), ((-3.0, 3.0),)),
)
STEP = 1e-5
"""As a share of a value."""


CASES = {"squat": SQUAT, "one leg": ONE_LEG, "loaded": LOADED, "raised": RAISED}


@dataclass(frozen=True)
class Neighbourhood:
    """A design, its derivatives, and for each of its values the step and the robots below and above."""

    names: tuple[str, ...]
    agent: Agent
    values: np.ndarray
    gradient: RobotGradient
    here: Tree
    neighbours: tuple[tuple[float, Tree, Tree], ...]


@pytest.fixture(scope="module")
def near(repository: Path) -> Neighbourhood:
    """Lengths, sections, places and tilts of joints, and mounted actuators of any size."""
    problem = build_problem(read_source(repository / "problems" / "icub_geometry.toml"))
    space, agent = problem.space, problem.scene.robot
    family = space.family(problem.scene.designed_tree)
    shares = 0.3 + 0.4 * np.random.default_rng(7).random(len(space.parameters))
    values = np.array(space.given(space.values(tuple(shares)), {}))
    steps = STEP * np.where(values == 0.0, 1.0, np.abs(values))
    return Neighbourhood(
        tuple(each.name for each in space.parameters),
        agent,
        values,
        RobotGradient(family, agent, tuple(CASES.values())),
        family.resized(values.tolist()),
        tuple(
            (step, *(family.resized((values + sign * step * place).tolist()) for sign in (-1.0, 1.0)))
            for step, place in zip(steps.tolist(), np.eye(len(values)), strict=True)
        ),
    )


@pytest.mark.parametrize("name", CASES)
def test_standing_torques_move_as_those_of_neighbouring_designs(near: Neighbourhood, name: str) -> None:
    def torques(tree: Tree) -> tuple[np.ndarray, tuple[float, ...]]:
        found = stance_torques(FloatingBody.of_tree(tree, near.agent.joints, np.eye(3)), CASES[name])
        assert not found.reason
        return np.array([found.torques[joint] for joint in near.agent.joints]), found.offsets

    gradient = near.gradient.stances[[*CASES].index(name)]
    weights = np.random.default_rng(7).normal(size=len(near.agent.joints))
    named = dict(zip(near.agent.joints, weights.tolist(), strict=True))
    found = gradient.along(near.values, torques(near.here)[1], named)
    for slope, (step, below, above), value in zip(found, near.neighbours, near.names, strict=True):
        difference = weights @ (torques(above)[0] - torques(below)[0]) / (2.0 * step)
        assert slope == pytest.approx(difference, rel=1e-6, abs=1e-6), value


@pytest.mark.parametrize("name", OF_MASSES)
def test_masses_move_as_those_of_neighbouring_designs(near: Neighbourhood, name: str) -> None:
    found = near.gradient.of_masses(name, near.values)
    for slope, (step, *trees) in zip(found, near.neighbours, strict=True):
        below, above = (float(OF_MASSES[name](tree, near.agent.foot_frames)) for tree in trees)
        assert slope == pytest.approx((above - below) / (2.0 * step), rel=1e-6, abs=1e-8)
