"""Where optima are sought: joints at three shares of the way to mid-range, each robot with each person."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.nlp.program import Program, Variable
from evodesign.posture.assemble import Slot
from evodesign.posture.seeking.starts import universal_starts


def program() -> Program:
    """Two joints each, and a height; the first joint of the robot begins at its lower end at the earliest."""
    ranges = {ROBOT: ([1.0, -1.0], [3.0, 1.0]), HUMAN: ([0.0, -2.0], [2.0, 0.0])}
    joints = [
        replace(Variable.column(f"{name}.joints", low, high, low, 1.0), key=Slot(0, 0, name, "joints"))
        for name, (low, high) in ranges.items()
    ]
    height = Variable.column("height", [0.0], [2.0], [1.2], 1.0)
    return Program("both", (*joints, height), (), ca.SX(0.0), {})


def test_joints_are_shares_of_the_way_to_mid_range_within_their_ranges() -> None:
    starts = universal_starts(program())
    pairs = [(*start["robot.joints"].tolist(), *start["human.joints"].tolist()) for start in starts]
    robots = [(1.0, 0.0), (1.0, 0.0), (2.0, 0.0)]
    people = [(0.1, -0.1), (0.5, -0.5), (1.0, -1.0)]
    assert pairs == [pytest.approx((*robot, *person)) for robot in robots for person in people]
    assert all(start["height"].tolist() == [1.2] for start in starts)


def test_people_who_are_known_better_stand_beside_each_robot() -> None:
    people = [{"human.joints": np.array([0.3, -0.3])}, {"human.joints": np.array([0.4, -0.4])}]
    starts = universal_starts(program(), people)
    assert [start["human.joints"][0] for start in starts] == [0.3, 0.4] * 3
