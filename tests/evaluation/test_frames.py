"""How deep one solve lies below the evaluation of a design: few calls to read, and to step through."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Any

import msgspec
import pytest
import tomli_w

from evodesign.evaluation.evaluate import Evaluator
from evodesign.nlp.ipopt import Ipopt
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source

MOST = 14

NEAR = (
    ("elbow_1", "wrist_1"),
    ("shoulder_1", "upper_arm"),
    ("shoulder_3", "forearm"),
    ("", "upper_arm"),
    ("", "forearm"),
)
"""Bodies of an arm that come near each other, or near the chest."""


@pytest.mark.slow
def test_a_solve_of_the_default_problem_passes_at_most_fourteen_frames(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Actuators are sized, and bodies parted that a first solve has in each other."""
    source = read_source(repository / "problems" / "icub_lifting.toml")
    tables = tomllib.loads(source.text)
    tables["task"]["heights_m"] = [1.2]
    tables["solver"] = {"start_portfolio": False, "compile": False}
    problem = build_problem(msgspec.structs.replace(source, text=tomli_w.dumps(tables)))
    near = [(f"{side}_{one}" if one else "chest", f"{side}_{other}") for side in "lr" for one, other in NEAR]
    evaluator = Evaluator(problem, Precomputed(meetings={("robot", ""): near}))
    genome = problem.space.genome(problem.space.unscaled(problem.scene.robot.tree))
    evaluator.assess(genome)  # once more deep: it works out what actuators usually hold
    paths, solve = set[tuple[str, ...]](), Ipopt.solve

    def seen(*given: Any) -> Any:
        frame, names = sys._getframe(0), [Ipopt.solve.__name__]
        while names[-1] != Evaluator.assess.__name__:
            assert frame.f_back is not None
            frame = frame.f_back
            names.append(frame.f_code.co_name)
        paths.add(tuple(reversed(names)))
        return solve(*given)

    monkeypatch.setattr(Ipopt, "solve", seen)
    evaluator.assess(genome)
    deepest = max(paths, key=len)
    assert any("parted" in path for path in paths), "some rows were switched on"
    assert len(deepest) <= MOST, deepest
