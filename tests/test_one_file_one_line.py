"""A new objective, search or kind of task is one file and one line of a registry (terms: tests/posture)."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec
import pytest

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.mechanics.agent import ROBOT, SIDES
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.quantities.design_result import CaseQuantity
from evodesign.quantities.objectives import QUANTITIES
from evodesign.records import Genome, SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.registry import SEARCHES, make_search


def foot_force(scene: Scene, postures: Mapping[str, AgentPosture]) -> float:
    """The robot's larger foot force [N]."""
    return max(float(postures[ROBOT].wrenches[f"{side}_foot"][2]) for side in SIDES)


@pytest.mark.slow
def test_an_objective(problem: DesignProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(QUANTITIES, "foot_force", CaseQuantity("N", foot_force))
    text = problem.source.text.replace('"human_torque"', '"foot_force", "worst_foot_force", "q50_foot_force"')
    asked = build_problem(msgspec.structs.replace(problem.source, text=text))
    evaluator = Evaluator(asked)
    values = asked.space.unscaled(asked.scene.robot.tree)
    result = evaluator.solve(values)
    found = evaluator.assessment(values, result).objectives
    forces = [foot_force(asked.scene, solution.postures) for solution in result.cases]
    assert found["foot_force"] == pytest.approx(sum(forces) / len(forces))
    assert found["worst_foot_force"] == max(forces)
    gradient = Sensitivities(asked).at(values, result).sensitivities()["foot_force"].gradient
    assert gradient is not None
    heavier = {name: slope for name, slope in gradient.items() if name.startswith("density.")}
    assert min(heavier.values()) > 0.0, "a denser link presses on the ground"


class Corners:
    """A search that asks for the corners of the unit cube, again and again."""

    def __init__(self, settings: SearchSettings) -> None:
        self._settings, self._asked = settings, 0

    def ask(self) -> Sequence[Genome]:
        numbers = range(self._asked, self._asked + self._settings.population)
        self._asked += self._settings.population
        return [tuple(float(n >> axis & 1) for axis in range(self._settings.dimension)) for n in numbers]

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        pass


def test_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SEARCHES, "corners", f"{__name__}:Corners")
    monkeypatch.setitem(sys.modules, __name__, sys.modules[Corners.__module__])
    settings = SearchSettings(algorithm="corners", dimension=2, objectives=1, population=4, seed=1)
    assert make_search(settings).ask() == [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]


STUB = '''
"""Holding the load at two heights, one after the other."""

from typing import ClassVar

from evodesign.tasks.base import TaskRecord


class TwoHolds(TaskRecord, frozen=True, tag="two_holds"):
    PARAMETERS: ClassVar[tuple[str, ...]] = ("low", "high")

    low_m: float
    high_m: float
    seconds: float = 2.0

    def __str__(self) -> str:
        return f"{self.low_m:g} and {self.high_m:g} m"

    @property
    def given(self):
        return {"low": self.low_m, "high": self.high_m}

    @classmethod
    def load_heights(cls, given):
        return given["low"], given["high"]

    @property
    def times(self):
        return 0.0, self.seconds
'''

SCRIPT = """
import sys
from dataclasses import replace
from pathlib import Path

import msgspec
from evodesign.nlp.optimality import NotDifferentiable
from evodesign.problem.build import build_problem
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.problem.source import read_source
from evodesign.records import Assessed
from evodesign.tasks import Hold
from evodesign.tasks.two_holds import TwoHolds

problem = build_problem(read_source(Path(sys.argv[1])))
problem = replace(problem, options=replace(problem.options, compiled=False))
values = problem.space.unscaled(problem.scene.robot.tree)
costs = {}
for tasks in ((TwoHolds(low_m=0.9, high_m=1.1),), (Hold(height_m=0.9), Hold(height_m=1.1))):
    asked = replace(problem, tasks=tasks)
    evaluator = Evaluator(asked)
    result = evaluator.solve(values)
    assert all(solution.solved for solution in result.cases), [s.reason for s in result.cases]
    costs[len(tasks)] = sum(solution.attempt.cost for solution in result.cases)
    if len(tasks) == 1:
        (solution,) = result.cases
        assert [instant.time for instant in solution.instants] == [0.0, 2.0]
        assert "instant 1, robot.torque" in solution.residuals
        assessed = evaluator.assess_values(values)
        again = msgspec.json.decode(msgspec.json.encode(assessed), type=Assessed)
        assert again == assessed
        assert again.cases[0].case.task == tasks[0]
        assert [instant.time_s for instant in again.cases[0].instants] == [0.0, 2.0]
        derivative = Sensitivities(asked).at(values, result)
        assert not isinstance(derivative.cases[0], NotDifferentiable), derivative.cases[0]
        assert all(found.gradient for found in derivative.sensitivities().values())
print(*(costs[count] for count in (1, 2)))
"""


@pytest.mark.slow
def test_a_kind_of_task(repository: Path, tmp_path: Path) -> None:
    """In a copy of the package, for the registry is a type: two holds cost together what they cost alone."""
    shutil.copytree(repository / "evodesign", tmp_path / "evodesign")
    (tmp_path / "evodesign" / "tasks" / "two_holds.py").write_text(STUB)
    registry = tmp_path / "evodesign" / "tasks" / "__init__.py"
    line = "Task = Hold | Lift\n"
    assert line in registry.read_text()
    added = "from evodesign.tasks.two_holds import TwoHolds\n\nTask = Hold | Lift | TwoHolds\n"
    registry.write_text(registry.read_text().replace(line, added))
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(repository / "problems" / "point_grasp.toml")],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
    )
    assert done.returncode == 0, done.stderr
    together, apart = map(float, done.stdout.split())
    assert together == pytest.approx(apart, rel=0.02)
