"""Gradients that the report shows, against differences of ordinary evaluations."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.progress import SILENT
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.records import Evaluation
from evodesign.report.page.gather import gradients_of
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog

STEP = 1e-3


@pytest.mark.slow
def test_gradients_of_a_logged_design_are_slopes_of_its_objectives(
    native: DesignProblem, known: Precomputed, tmp_path: Path
) -> None:
    evaluator, space = Evaluator(native, known), native.space
    values = space.unscaled(native.scene.robot.tree)
    genome = space.genome(values)
    table = native.search
    header = header_of(native, native.settings("nsga2", table.population, 1, table.asynchronous), 1)
    logged = Evaluation(
        number=7,
        generation=0,
        genome=genome,
        assessment=evaluator.assess(genome).assessment,
        seconds=0.1,
        worker="here",
    )
    run = RunLog(tmp_path, header, (logged,), (), (), (), complete=True, notes=())
    gradients = gradients_of(run, [7], 1, SILENT)
    assert set(gradients) == {7}
    place = [parameter.name for parameter in space.parameters].index("length.forearm")
    sides = []
    for sign in (-1.0, 1.0):
        moved = list(values)
        moved[place] += sign * STEP
        sides.append(evaluator.assessment(moved, evaluator.solve(moved)).objectives)
    for objective in ("robot_torque", "reach_height"):
        slope = (sides[1][objective] - sides[0][objective]) / (2.0 * STEP)
        assert gradients[7][objective]["length.forearm"] == pytest.approx(slope, rel=1e-3)
