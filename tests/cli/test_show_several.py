"""`show` of a design for several people and loads: a row for each case, and in which one is borne most."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evodesign.cli.output import rounded
from evodesign.cli.show import show
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.problem.build import DesignProblem
from evodesign.runlog.run import RunLog
from evodesign.tree.words import in_words
from tests.cli.test_show_and_export import cells
from tests.report.several import CASES, HEIGHTS, LOADS, PEOPLE, problem_of_several, write_several

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def several(problem: DesignProblem) -> DesignProblem:
    return problem_of_several(problem)


@pytest.fixture(scope="module")
def run(several: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    return write_several(several, tmp_path_factory.mktemp("several") / "run")


def test_card_has_a_row_for_each_case_and_sums_them_up(
    run: RunLog, capsys: pytest.CaptureFixture[str]
) -> None:
    show(run.directory, 1)
    rows = cells(capsys.readouterr().out)
    outcomes = run.evaluations[1].assessment.cases
    for (human, payload, height), outcome in zip(CASES, outcomes, strict=True):
        norms = [rounded(outcome.robot_torque_norm), rounded(outcome.human_torque_norm)]
        assert [row[3:5] for row in rows if row[:3] == [human, payload, f"{height:g} m"]] == [norms]
    table = pd.DataFrame(
        [
            (*case, one.robot_torque_norm, one.human_torque_norm)
            for case, one in zip(CASES, outcomes, strict=True)
        ],
        columns=["human", "payload", "height", "robot", "person"],
    )
    groups = {
        "all": table,
        **{human: table[table.human == human] for human in PEOPLE},
        **{payload: table[table.payload == payload] for payload in LOADS},
        **{f"{height:g} m": table[table.height == height] for height in HEIGHTS},
    }
    for name, group in groups.items():
        numbers = (group.robot.mean(), group.robot.max(), group.person.mean(), group.person.max())
        expected = [name, f"{len(group)} of {len(group)}", *map(rounded, numbers)]
        assert expected in rows


def test_card_names_the_case_of_largest_torque_and_contact_force(
    run: RunLog, capsys: pytest.CaptureFixture[str]
) -> None:
    show(run.directory, 1)
    rows = cells(capsys.readouterr().out)
    names = [f"{human}, {payload}, {height:g} m" for human, payload, height in CASES]
    for agent in (ROBOT, HUMAN):
        postures = [detail.agents[agent] for detail in run.details[1].cases]
        torques = pd.DataFrame([posture.torques_n_m for posture in postures], index=names)
        sizes = torques.abs()
        for joint in sizes.max().sort_values(ascending=False).index[:6]:
            case = sizes[joint].idxmax()
            numbers = [rounded(sizes[joint].mean()), rounded(torques[joint][case])]
            assert [agent, in_words(joint), *numbers, case] in rows
        forces = [float(np.linalg.norm(posture.wrenches["left_hand"][:3])) for posture in postures]
        numbers = [rounded(float(np.mean(forces))), rounded(max(forces))]
        assert [agent, "left hand", *numbers, names[int(np.argmax(forces))]] in rows


def test_figures_of_show_are_written(several: DesignProblem, tmp_path: Path) -> None:
    few = write_several(several, tmp_path / "run", designs=1, cases=3)
    show(few.directory, 0, json=True, plot=tmp_path / "figures")
    names = ("torques", "torques_by_joint", "postures", "postures_side", "postures_front")
    written = {path.name for path in (tmp_path / "figures").iterdir()}
    assert written == {f"{name}.{kind}" for name in names for kind in ("svg", "png")}
    svg = (tmp_path / "figures" / "torques_by_joint.svg").read_text()
    assert "with all people and loads" in svg
