"""From the evaluation of a genome to the solve of a program it is few calls: a newcomer can follow one."""

from __future__ import annotations

import traceback
from pathlib import Path
from typing import Any

import pytest

import evodesign
from evodesign.evaluation.evaluate import Evaluator
from evodesign.nlp.solver import Solver
from evodesign.problem.build import DesignProblem

PACKAGE = str(Path(evodesign.__file__).parent)

MOST = 14


def test_a_solve_is_few_calls_below_its_genome(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    stacks: list[list[str]] = []
    plain = Solver.solve

    def watched(solver: Solver, *arguments: Any) -> Any:
        frames = traceback.extract_stack()[:-1]
        stacks.append([frame.name for frame in frames if frame.filename.startswith(PACKAGE)])
        return plain(solver, *arguments)

    monkeypatch.setattr(Solver, "solve", watched)
    Evaluator(problem).assess((0.5,) * len(problem.space.parameters))
    assert stacks
    deepest = max(stacks, key=len)
    assert len(deepest) + 1 <= MOST, " > ".join(deepest)
