"""What `lift` prints of a lift under disturbances."""

from __future__ import annotations

import numpy as np
import pytest

from evodesign.cli.output import console
from evodesign.cli.tables.simulation import lift_tables
from evodesign.motion.solution import AgentEffort, LiftSolution
from evodesign.records import Status
from evodesign.tasks import Lift


def test_each_disturbance_has_the_peak_torques_of_both_agents(capsys: pytest.CaptureFixture[str]) -> None:
    power = np.array([0.0, 7.0, 0.0])
    efforts = {
        "robot": AgentEffort(
            np.array([1.0, 2.0, 1.0]), 1.4, power, 3.0, {"heavier": np.array([1.1, 6.3, 1.2])}
        ),
        "human": AgentEffort(
            np.array([4.0, 5.0, 4.0]), 4.4, power, 2.0, {"heavier": np.array([8.7, 5.1, 4.1])}
        ),
    }
    solution = LiftSolution(Lift(0.8, 1.2, 1.5), Status.SOLVED, "solved", efforts=efforts)
    for table in lift_tables("a lift", {("", ""): solution}):
        console().print(table)
    shown = capsys.readouterr().out
    assert "heavier" in shown
    for agent, peak, disturbed in (("robot", "2", "6.3"), ("human", "5", "8.7")):
        (row,) = [line for line in shown.splitlines() if agent in line]
        cells = [cell.strip() for cell in row.strip("│").split("│")]
        assert cells[2] == peak
        assert cells[-1] == disturbed


def test_a_lift_without_torques_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    solution = LiftSolution(Lift(0.8, 1.2, 1.5), Status.ITERATION_LIMIT, "no posture found at 0.8 m")
    for table in lift_tables("a lift", {("", ""): solution}):
        console().print(table)
    shown = capsys.readouterr().out
    assert "iteration limit" in shown
    assert "no posture found at 0.8 m" in shown
