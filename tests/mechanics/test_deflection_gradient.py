"""Slopes of the hands' deflection against five-point differences of the numbers of `link_beams`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.evaluation.sensitivities import five_point
from evodesign.mechanics.link_beams import hand_deflection
from evodesign.mechanics.robot_gradient import RobotGradient
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source

STEP = 1e-3


@pytest.mark.parametrize("name", ["icub_hardware", "icub_geometry"])
def test_slopes_agree_with_differences(repository: Path, name: str) -> None:
    """Along random directions of design, base, joints and wrenches."""
    problem = build_problem(read_source(repository / "problems" / f"{name}.toml"))
    space, robot, generator = problem.space, problem.scene.robot, np.random.default_rng(2)
    genome = tuple(generator.uniform(0.2, 0.8, len(space.free)).tolist())
    values = np.array(space.given(space.values(genome), {}))
    angles, joints = generator.normal(size=3), generator.normal(size=len(robot.joints))
    wrenches = generator.normal(size=(len(robot.hands), 6))

    def deflection(values: np.ndarray, angles: np.ndarray, joints: np.ndarray, wrenches: np.ndarray) -> float:
        tree = space.resized(problem.scene.designed_tree, values.tolist())
        base = Placement.from_xyz_rpy((0.3, 0.0, 1.0), tuple(angles.tolist()))
        held = {hand.frame: wrench for hand, wrench in zip(robot.hands, wrenches, strict=True)}
        positions = dict(zip(robot.joints, joints.tolist(), strict=True))
        return hand_deflection(tree, base, positions, held, robot.foot_frames).total

    agent = replace(robot, tree=space.resized(problem.scene.designed_tree, values.tolist()))
    gradient = RobotGradient(space.family(problem.scene.designed_tree), agent, ()).deflection(agent)
    found = gradient.at(
        agent.tree,
        values.tolist(),
        angles,
        dict(zip(robot.joints, joints.tolist(), strict=True)),
        {hand.name: wrench for hand, wrench in zip(robot.hands, wrenches, strict=True)},
    )
    given = (values, angles, joints, wrenches)
    slopes = (
        found.values,
        found.base_angles,
        np.array([found.joints[joint] for joint in robot.joints]),
        np.array([found.wrenches[hand.name] for hand in robot.hands]),
    )
    for place, slope in enumerate(slopes):
        along = generator.normal(size=slope.shape) * (np.abs(values) if place == 0 else 1.0)

        def moved(count: int, place: int = place, along: np.ndarray = along) -> float:
            beside = [each + count * STEP * along if k == place else each for k, each in enumerate(given)]
            return deflection(*beside)

        difference = five_point([moved(count) for count in range(-2, 3)], STEP)
        assert float(np.sum(slope * along)) == pytest.approx(difference, rel=1e-6), place
