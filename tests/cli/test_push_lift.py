"""`evodesign push` on the lifts of a problem, which it solves anew."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from evodesign.cli.push import pushed_in
from evodesign.errors import InputError
from evodesign.evaluation.progress import SILENT
from evodesign.motion.solution import LiftSolution
from evodesign.records import Case, CaseDetail, Status
from evodesign.simulation.pushed_plan import PushedDesign
from tests.motion.conftest import lifted, solution
from tests.motion.lifted import LIFT, Lifted

__all__ = ["lifted", "solution"]


def test_lifts_are_pushed_and_a_sentence_says_which_were_not_found(
    lifted: Lifted, solution: LiftSolution, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, failed = (
        lifted.setting.scene,
        replace(solution, status=Status.INFEASIBLE, reason="too far", course=None),
    )

    def asked(found: LiftSolution) -> PushedDesign:
        opened = SimpleNamespace(
            cases=(CaseDetail(case=Case(task=LIFT), instants=()),),
            rebuilt=SimpleNamespace(problem=SimpleNamespace(scenes=[scene])),
            scene_set=lambda: SimpleNamespace(robot=scene.robot.tree),
            lifts=lambda lift, jobs, progress: {scene.pair: found} if (lift, jobs) == (LIFT, 1) else {},
        )
        return pushed_in(opened, ((), None, None), 1, SILENT)

    (plan,) = asked(solution).plans
    assert (plan.name, plan.course) == (str(LIFT), solution.course)
    with pytest.raises(InputError, match="a hold or a lift that was found"):
        asked(failed)
    assert f"no lift {LIFT}: too far" in " ".join(capsys.readouterr().err.split())
