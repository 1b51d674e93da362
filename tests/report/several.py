"""A problem of two people and two loads, and runs of it in random postures, without solving anything."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import (
    Assessment,
    CaseDetail,
    CaseOutcome,
    Detail,
    Evaluation,
    ProblemSource,
    ReachOutcome,
    Status,
)
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from tests.report.scenes import random_detail, random_values

PEOPLE = {"short <b>": Person(1.6, 58.0, Sex.FEMALE), "tall": Person(1.9, 90.0, Sex.MALE)}
LOADS = {"5 kg": 5.0, "[crate]": 15.0}
HEIGHTS = (0.8, 1.0)
CASES = [(human, payload, height) for human in PEOPLE for payload in LOADS for height in HEIGHTS]


def problem_of_several(problem: DesignProblem) -> DesignProblem:
    """The point-grasp problem with other people and loads."""
    people = "".join(
        f'[[human]]\nname = "{name}"\nstature_m = {one.stature}\nmass_kg = {one.mass}\nsex = "{one.sex}"\n'
        for name, one in PEOPLE.items()
    )
    loads = "".join(
        f'[[payload]]\nname = "{name}"\nsize_m = [0.{4 + number}, 0.5, 0.025]\nmass_kg = {mass}\n'
        for number, (name, mass) in enumerate(LOADS.items())
    )
    text = problem.source.text
    before, after = text.split("[human]\n")[0], text.split("[task]\n")[1]
    assert "heights_m = [0.8, 1.0, 1.2]" in after
    task = "[task]\n" + after.replace("heights_m = [0.8, 1.0, 1.2]", f"heights_m = {[*HEIGHTS]}")
    return build_problem(ProblemSource("several.toml", before + people + loads + task, problem.source.files))


def outcome(detail: CaseDetail) -> CaseOutcome:
    """A solved case with the torques of its posture."""
    norms = {
        name: float(np.linalg.norm([*agent.torques_n_m.values()])) for name, agent in detail.agents.items()
    }
    return CaseOutcome(
        case=detail.case,
        status=Status.SOLVED,
        reason="solved",
        robot_torque_norm=norms["robot"],
        human_torque_norm=norms["human"],
        iterations=7,
        residual=1e-9,
    )


def write_several(problem: DesignProblem, place: Path, designs: int = 2, cases: int = len(CASES)) -> RunLog:
    """A run of random designs in random postures, all of them on the front."""
    with RunWriter(place, header_of(problem, problem.settings("random", 4, 1), budget=4)) as log:
        for number in range(designs):
            values = random_values(problem, number)
            heights = random_detail(problem, number, HEIGHTS).cases[:cases]
            assessment = Assessment(
                design=dict(problem.space.named(values)),
                objectives={"robot_torque": 1.0 + number, "human_torque": 9.0 - number, "reach_height": 1.25},
                violation=0.0,
                status=Status.SOLVED,
                reason="solved",
                reach=ReachOutcome(lowest_m=0.1, highest_m=1.25, status=Status.SOLVED, reason=""),
                cases=tuple(map(outcome, heights)),
            )
            evaluation = Evaluation(
                number=number,
                generation=0,
                genome=problem.space.genome(values),
                assessment=assessment,
                seconds=0.1,
                worker="here",
            )
            log.write(Detail(evaluation=number, cases=heights))
            log.write(evaluation)
    return read_run(place)
