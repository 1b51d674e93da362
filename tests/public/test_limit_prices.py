"""Prices of limits are what other numbers in the file save: the default problem, and a G1 from `init`."""

from __future__ import annotations

import tomllib
from functools import partial
from pathlib import Path

import msgspec
import pytest
import tomli_w

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import evaluator_of
from evodesign.guess.problem_text import guessed_problem
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source, source_of
from evodesign.records import CaseDetail
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from tests.posture.resolved import prices, slope, with_number
from tests.robots import HUMANOIDS

pytestmark = pytest.mark.slow

WITHIN = 0.01

QUICK = {"start_portfolio": False, "compile": False}


def check_prices(evaluator: Evaluator) -> None:
    """That all numbers of the file that hold the unscaled robot's last case cost what a change saves."""
    problem = evaluator.problem
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    values = result.program_values
    details: dict[object, CaseDetail] = {detail.case: detail for detail in evaluator.details(result)}
    solution = result.cases[-1]
    assert solution.solved
    active = prices(details[solution.case].limits)
    assert len(active) >= 4
    for number, (price, step) in active.items():
        found = slope(evaluator, partial(with_number, problem, number), step, values, solution)
        assert price == pytest.approx(found, rel=WITHIN), (solution.case.name, number)


@pytest.mark.usefixtures("few_designs_meet")
def test_prices_of_the_default_problem_agree_with_differences(repository: Path) -> None:
    """Of its highest load: with sized actuators, which keep their sizes, a disturbance, and bodies apart."""
    source = read_source(repository / "problems" / "icub_lifting.toml")
    tables = tomllib.loads(source.text)
    tables["task"]["heights_m"] = [max(tables["task"]["heights_m"])]
    tables["solver"] = QUICK
    problem = build_problem(msgspec.structs.replace(source, text=tomli_w.dumps(tables)))
    check_prices(evaluator_of(problem, 2))


@pytest.mark.needs_robots
def test_prices_of_a_g1_agree_with_differences() -> None:
    urdf = HUMANOIDS["g1"]
    tree = read_urdf(urdf.read_text(encoding="utf-8"), str(urdf), InertiaRule.AUTO)
    tables = tomllib.loads(guessed_problem(tree, str(urdf)).text) | {"solver": QUICK}
    del tables["collisions"]  # which pairs come near each other would have to be worked out first
    check_prices(Evaluator(build_problem(source_of(tables))))
