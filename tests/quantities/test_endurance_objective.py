"""How long people can hold the loads, as an objective or a bound: its value, and who is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.human.endurance import endurance
from evodesign.mechanics.agent import HUMAN
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.constraints import constraint_key
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml, read_source
from evodesign.problem.unanswered_quantities import refuse_unanswered_quantity
from evodesign.quantities.objectives import objective_value


def test_it_is_the_least_time_of_all_cases(problem: DesignProblem, evaluator: Evaluator) -> None:
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    strengths = problem.scene.human.strengths
    times = [endurance(case.postures[HUMAN].torques, strengths).seconds for case in result.cases]
    assert objective_value("endurance_s", result) == min(times)


def test_it_is_nothing_where_nothing_tires(problem: DesignProblem, evaluator: Evaluator) -> None:
    result = evaluator.solve(problem.space.unscaled(problem.scene.robot.tree))
    weak = tuple(scene.with_agents(replace(scene.human, strengths={})) for scene in result.scenes)
    assert objective_value("endurance_s", replace(result, scenes=weak)) is None


def test_its_key_is_its_name_and_it_can_be_bounded(repository: Path) -> None:
    assert constraint_key("endurance_s") == "endurance_s"
    path = repository / "problems" / "point_grasp.toml"
    text = path.read_text(encoding="utf-8") + "\n[constraints]\nendurance_s = { lower = 120.0 }\n"
    (constraint,) = build_problem(msgspec.structs.replace(read_source(path), text=text)).constraints
    assert (constraint.name, constraint.unit, constraint.lower) == ("endurance_s", "s", 120.0)


def test_a_lift_has_no_holding_time(repository: Path) -> None:
    path = repository / "problems" / "icub_lift.toml"
    text = path.read_text(encoding="utf-8") + "\n[constraints]\nendurance_s = { lower = 120.0 }\n"
    with pytest.raises(InputError, match=r"constraints\.endurance_s: wanted loads held still"):
        build_problem(msgspec.structs.replace(read_source(path), text=text))


def test_people_without_strengths_are_refused(problem: DesignProblem) -> None:
    nobody, source = replace(problem.scene.human, strengths={}), problem.source
    tables = decode_toml(source.text, source.path, ProblemFile)
    with pytest.raises(InputError, match="wanted people of known strength"):
        refuse_unanswered_quantity("objectives.maximise[0]", "endurance_s", tables, source, [nobody])
