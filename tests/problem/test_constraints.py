"""`[constraints]` of a problem file: what it means, and what is wrong with it in one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.evaluation.baseline import refuse_unsuited
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.factory import problem_digest
from evodesign.evaluation.polish import Step, aim_of, polish
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.constraints import constraint_key
from evodesign.problem.model_json import model_json
from evodesign.quantities.motion_quantities import NEED_LIFTS
from evodesign.quantities.objectives import QUANTITIES, objective_kinds, objective_value
from evodesign.records import Constraint, ProblemSource
from evodesign.runlog.header import differences, header_of
from evodesign.searches.base import JOINT_STARTS
from evodesign.tree.urdf_write import urdf_text
from tests.problem.test_people import FROM_FILE, PERSON, changed

LIMITED = "torque_limits_n_m = { '*' = 100.0 }\n"


def bounded(source: ProblemSource, constraints: str) -> ProblemSource:
    return msgspec.structs.replace(source, text=f"{source.text}\n[constraints]\n{constraints}\n")


def test_bounds_are_read_in_the_order_of_the_file(problem: DesignProblem) -> None:
    text = (
        "reach_height_m = { lower = 1.5 }\nmass_kg = { upper = 65 }\n"
        "worst_robot_torque_n_m = { lower = -1.0, upper = 20.0 }"
    )
    assert build_problem(bounded(problem.source, text)).constraints == (
        Constraint(name="reach_height", unit="m", lower=1.5, upper=None),
        Constraint(name="mass", unit="kg", lower=None, upper=65.0),
        Constraint(name="worst_robot_torque", unit="N m", lower=-1.0, upper=20.0),
    )


DRIVEN = """
[duty]
lifts_per_hour = 30
hold_s = 10.0
shift_h = 8.0
winding_limit_c = 120.0
life_shifts = 2500
thermal_time_constant_s = 120.0

[[design.actuator]]
name = "knee"
joints = ["l_knee", "r_knee"]
models = ["weak", "strong"]

[[actuator]]
model = "weak"
mass_kg = 0.5
peak_torque_n_m = 30.0
price_eur = 200.0
source = "assumed"

[[actuator]]
model = "strong"
mass_kg = 1.0
peak_torque_n_m = 150.0
price_eur = 400.0
source = "assumed"

[[design.wall]]
name = "shank"
links = ["l_forearm", "r_forearm"]
thickness_m = 0.002
"""


def test_every_quantity_can_be_bounded(problem: DesignProblem) -> None:
    every = [*objective_kinds(), *(f"q90_{name}" for name in QUANTITIES)]
    names = [name for name in every if not name.endswith(NEED_LIFTS)]
    limited = msgspec.structs.replace(
        problem.source,
        text=problem.source.text.replace("[robot]\n", f"[robot]\n{LIMITED}") + DRIVEN + "\n[push]\n",
    )
    text = "\n".join(f"{constraint_key(name)} = {{ upper = 9.0 }}" for name in names)
    found = build_problem(bounded(limited, text))
    assert [(each.name, each.upper) for each in found.constraints] == [(name, 9.0) for name in names]
    assert found.person_reaches, "the people's own reach is worked out for the height that all reach"
    assert not problem.person_reaches


@pytest.mark.parametrize(
    ("text", "key", "wanted", "found"),
    [
        (
            "mas_kg = { upper = 65.0 }",
            "mas_kg",
            "one of the keys robot_torque_n_m",
            "did you mean 'mass_kg'?",
        ),
        ("mass = { upper = 65.0 }", "mass", " more", "'mass'; did you mean 'mass_kg'?"),
        ("mass_m = { upper = 65.0 }", "mass_m", "one of the keys", "did you mean 'mass_kg'?"),
        ("paper_cost_kg = { upper = 1.0 }", "paper_cost_kg", "one of the keys", "did you mean 'paper_cost'?"),
        (
            "q90_robot_torque = { upper = 1.0 }",
            "q90_robot_torque",
            "",
            "did you mean 'q90_robot_torque_n_m'?",
        ),
        ("mass_kg = {}", "mass_kg", "lower, upper or both", "neither"),
        ("mass_kg = { lower = 2.0, upper = 1.0 }", "mass_kg.lower", "less than upper (1)", "2"),
        ("mass_kg = { lower = 2.0, upper = 2.0 }", "mass_kg.lower", "less than upper (2)", "2"),
        ("mass_kg = { uper = 65.0 }", "mass_kg.uper", "lower, upper", "did you mean 'upper'?"),
        ("com_height_m = { upper = 1.0 }\nmass_kg = { upper = '65' }", "mass_kg.upper", "a number", "'65'"),
        ("mass_kg = 65.0", "mass_kg", "a table", "65.0"),
        ("mass_kg = { upper = inf }", "mass_kg.upper", "a finite number", "inf"),
        ("peak_torque = { upper = 1.0 }", "peak_torque", "a torque limit of every joint", "none of"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(
    problem: DesignProblem, text: str, key: str, wanted: str, found: str
) -> None:
    with pytest.raises(InputError) as caught:
        build_problem(bounded(problem.source, text))
    error = caught.value
    assert (error.source, error.key) == (problem.source.path, f"constraints.{key}")
    assert wanted in error.wanted
    assert found in error.found


def test_bounds_of_effort_need_people_of_known_strength(problem: DesignProblem) -> None:
    files = {"person.urdf": urdf_text(human_tree(Person(1.75, 75.0, Sex.FEMALE)))}
    source = changed(problem.source, (PERSON, FROM_FILE), files=files)
    with pytest.raises(InputError, match=r"constraints\.q90_human_effort: wanted people of known strength"):
        build_problem(bounded(source, "q90_human_effort = { upper = 0.5 }"))


def test_the_joint_problem_refuses_constraints(problem: DesignProblem) -> None:
    light = build_problem(bounded(problem.source, "mass_kg = { upper = 65.0 }"))
    refused = r"constraints\.mass_kg: wanted no \[constraints\] in the joint problem"
    with pytest.raises(InputError, match=refused):
        refuse_unsuited(light)
    with pytest.raises(InputError, match=refused):
        light.settings(JOINT_STARTS, 4, 1)
    refuse_unsuited(problem)


def test_evaluations_of_other_bounds_are_kept_apart(problem: DesignProblem) -> None:
    texts = ("mass_kg = { upper = 65.0 }", "mass_kg = { upper = 66.0 }", "mass_kg = { lower = 65.0 }")
    sources = [problem.source, *(bounded(problem.source, text) for text in texts)]
    assert len({problem_digest(source) for source in sources}) == len(sources)


def test_headers_tell_constraints_and_their_differences(problem: DesignProblem) -> None:
    settings = problem.settings("nsga2", 4, 1)
    plain = header_of(problem, settings, 4)
    assert "constraints" not in msgspec.json.decode(msgspec.json.encode(plain))
    bounds = Constraint(name="mass", unit="kg", lower=None, upper=65.0)
    light = header_of(replace(problem, constraints=(bounds,)), settings, 4)
    assert msgspec.json.decode(msgspec.json.encode(light), type=type(light)).constrained == (bounds,)
    assert differences(plain, light) == ["its constraints differ"]


def test_the_problem_as_it_was_read_lists_its_constraints(problem: DesignProblem) -> None:
    light = build_problem(bounded(problem.source, "mass_kg = { upper = 65.0 }"))
    assert model_json(light)["constraints"] == [{"name": "mass", "unit": "kg", "lower": None, "upper": 65.0}]
    assert "constraints" not in model_json(problem)


def mass_of(problem: DesignProblem, values: Sequence[float]) -> float:
    tree = problem.space.resized(problem.scene.robot.tree, values)
    return sum(float(link.inertia.mass) for link in tree.links)


def with_bounds(evaluator: Evaluator, *constraints: Constraint) -> Evaluator:
    return Evaluator(replace(evaluator.problem, constraints=constraints), evaluator.known)


def test_an_evaluation_has_the_values_and_the_violation(evaluator: Evaluator) -> None:
    problem = evaluator.problem
    values = problem.space.unscaled(problem.scene.robot.tree)
    result = evaluator.solve(values)
    mass, torque = (objective_value(name, result) for name in ("mass", "worst_robot_torque"))
    assert mass is not None
    assert torque is not None
    bounds = (
        Constraint(name="mass", unit="kg", lower=1.5 * mass, upper=None),
        Constraint(name="worst_robot_torque", unit="N m", lower=None, upper=0.8 * torque),
    )
    found = with_bounds(evaluator, *bounds).assessment(values, result)
    assert found.constrained == {"mass": mass, "worst_robot_torque": torque}
    assert found.violation == pytest.approx(0.5 / 1.5 + 0.2 / 0.8)
    plain = evaluator.assessment(values, result)
    assert plain == msgspec.structs.replace(found, violation=0.0, constraints=msgspec.UNSET)


def test_a_missed_height_counts_as_the_whole_bound_of_what_it_hides(evaluator: Evaluator) -> None:
    smallest = (0.0,) * len(evaluator.problem.space.parameters)
    missed = evaluator.assess(smallest).assessment
    assert missed.violation is not None
    assert missed.violation > 0.0
    torque = Constraint(name="robot_torque", unit="N m", lower=None, upper=20.0)
    found = with_bounds(evaluator, torque).assess(smallest).assessment
    assert found.constraints is msgspec.UNSET
    assert found.violation == pytest.approx(missed.violation + 1.0)


def test_a_constrained_quantity_has_a_gradient(evaluator: Evaluator) -> None:
    light = with_bounds(evaluator, Constraint(name="mass", unit="kg", lower=None, upper=65.0))
    space = light.problem.space
    values = space.unscaled(light.problem.scene.robot.tree)
    result = light.solve(values)
    found = Sensitivities(light.problem, light.known).at(values, result).sensitivities()["mass"].gradient
    assert found is not None
    step = 1e-3
    for position, parameter in enumerate(light.problem.space.records):
        ends = []
        for sign in (-1.0, 1.0):
            moved = list(values)
            moved[position] += sign * step
            ends.append(mass_of(light.problem, moved))
        assert found[parameter.name] == pytest.approx((ends[1] - ends[0]) / (2.0 * step), rel=1e-4, abs=1e-9)


@pytest.mark.slow
def test_polishing_stays_within_bounds_that_it_would_leave(evaluator: Evaluator) -> None:
    problem = evaluator.problem
    genome = problem.space.genome(problem.space.unscaled(problem.scene.robot.tree))
    aim = aim_of(problem, {"reach_height": 1.0}, "")
    free = polish(evaluator, genome, aim, 8, lambda step: None)
    mass, heavier = (mass_of(problem, [*of.design.values()]) for of in (free.before, free.after))
    assert heavier > 1.02 * mass
    seen: list[Step] = []
    light = with_bounds(evaluator, Constraint(name="mass", unit="kg", lower=0.9 * mass, upper=1.01 * mass))
    held = polish(light, genome, aim, 8, seen.append)
    assert held.after.violation == 0.0
    assert held.after.constrained["mass"] <= 1.01 * mass
    assert held.after.objectives["reach_height"] > 1.02 * held.before.objectives["reach_height"]
    assert all(step.assessment.violation == 0.0 for step in seen if step.taken)
    assert sum(step.assessment.violation != 0.0 for step in seen) <= 2, "the descent knows the bound"


def test_a_design_beyond_its_bounds_is_not_polished(evaluator: Evaluator) -> None:
    problem = evaluator.problem
    genome = problem.space.genome(problem.space.unscaled(problem.scene.robot.tree))
    light = with_bounds(evaluator, Constraint(name="mass", unit="kg", lower=None, upper=50.0))
    with pytest.raises(InputError, match=r"meets every constraint, found .* kg above 50 kg"):
        polish(light, genome, aim_of(problem, {}, ""), 3, lambda step: None)


def test_without_a_name_near_by_all_that_would_do_are_listed(problem: DesignProblem) -> None:
    with pytest.raises(InputError) as caught:
        build_problem(bounded(problem.source, "zzz = { upper = 1.0 }"))
    assert "mass_kg, actuator_mass_kg" in caught.value.wanted
