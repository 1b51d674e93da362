"""What a problem file may say about who carries how much, and how that changes the objectives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.api.problem import Problem
from evodesign.errors import InputError
from evodesign.evaluation.baseline import refuse_unsuited
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.polish import aim_of, polish
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.posture.allocation import EffortWeights
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.designs import designs_text, read_designs
from evodesign.problem.model_json import model_json
from evodesign.records import Parameter

RIGID = 'grasp = "rigid"\nhand_moment_n_m = 7.0'
SHARE = "\n[[design.allocation]]\nname = 'robot_share'\nlower = 0.1\nupper = 0.9\n"
RATIO = "\n[[design.allocation]]\nname = 'effort_ratio'\nlower = -1.0\nupper = 2.0\n"


def changed(
    problem: DesignProblem, grasp: str = RIGID, task: str = "", allocations: str = ""
) -> DesignProblem:
    """The point-grasp problem with 10 kg, another grasp, more in its task, and allocation parameters."""
    text = problem.source.text.replace('grasp = "point"', grasp).replace("mass_kg = 5.0", "mass_kg = 10.0")
    text = text.replace("heights_m = [0.8, 1.0, 1.2]", f"heights_m = [0.8]\n{task}") + allocations
    built = build_problem(msgspec.structs.replace(problem.source, text=text))
    return replace(built, options=problem.options)


@pytest.fixture(scope="module")
def shared(problem: DesignProblem) -> DesignProblem:
    return changed(problem, allocations=SHARE + RATIO)


@pytest.mark.parametrize(
    ("grasp", "task", "allocations", "words"),
    [
        (RIGID, "robot_share = 0.5", SHARE, "task.robot_share: wanted either a fixed value or an allocation"),
        (RIGID, "robot_share = 1.2", "", "task.robot_share: wanted a number <= 1.0, found 1.2"),
        (RIGID, "robot_share = -0.1", "", "task.robot_share: wanted a number >= 0.0, found -0.1"),
        (
            RIGID,
            "",
            SHARE.replace("0.9", "1.1"),
            "allocation[0].upper: wanted a number from 0 to 1, found 1.1",
        ),
        (
            RIGID,
            "",
            SHARE.replace("0.9", "0.1"),
            "allocation[0].lower: wanted less than upper (0.1), found 0.1",
        ),
        (
            RIGID,
            "",
            SHARE + SHARE,
            "design.allocation[1].name: wanted a unique name, found 'robot_share' twice",
        ),
        (RIGID, "", SHARE.replace("bot_s", "bots"), "did you mean 'robot_share'?"),
        (RIGID, "effort_weights = { robot = 2.0 }", RATIO, "task.effort_weights: wanted either a fixed"),
        (
            RIGID,
            "",
            RATIO.replace("2.0", "9.0"),
            "allocation[0].upper: wanted a number from -6 to 6, found 9",
        ),
        (
            'grasp = "point"',
            "robot_share = 0.6",
            "",
            "robot's share that point grasps leave here, 0.5, found",
        ),
        (
            'grasp = "point"',
            "",
            SHARE,
            "design.allocation[0].lower: wanted the robot's share that point grasps",
        ),
        (
            RIGID.replace("7", "1"),
            "robot_share = 0.9",
            "",
            "share from 0.418451 to 0.581549, which rigid gra",
        ),
        (
            RIGID.replace("7", "1"),
            "",
            SHARE,
            "design.allocation[0].lower: wanted a share from 0.418451 to 0.58",
        ),
        (RIGID.replace("rigid", "point"), "", "", "payload.hand_moment_n_m: wanted grasp = 'rigid' with it"),
        (RIGID.replace("7", "-7"), "", "", "payload.hand_moment_n_m: wanted a number >= 0.0, found -7.0"),
        (
            'grasp = "point"\nrobot_grasps_m = { left = [0.25, 0.2, 0.0], right = [0.25, -0.2, 0.0] }',
            "robot_share = 0.5",
            "",
            "wanted point grasps that balance the load at all",
        ),
    ],
)
def test_contradictory_shares_are_refused_in_a_sentence(
    grasp: str, task: str, allocations: str, words: str, problem: DesignProblem
) -> None:
    with pytest.raises(InputError) as raised:
        changed(problem, grasp, task, allocations)
    assert words in str(raised.value)


def test_a_rigid_hand_passes_what_wrists_bear_unless_the_file_says_otherwise(problem: DesignProblem) -> None:
    said = {
        line: changed(problem, line).scene.payload.hand_moment
        for line in (
            'grasp = "rigid"',
            RIGID.replace("7.0", "inf"),
            RIGID.replace("7.0", "3"),
            'grasp = "point"',
        )
    }
    assert [*said.values()] == [7.0, math.inf, 3.0, math.inf]


@pytest.mark.parametrize("number", ["-inf", "nan"])
def test_only_no_bound_may_be_infinite(number: str, problem: DesignProblem) -> None:
    with pytest.raises(InputError, match=r"payload\.hand_moment_n_m: wanted a finite number"):
        changed(problem, RIGID.replace("7.0", number))
    with pytest.raises(InputError, match=r"payload\.grasp_cone_deg: wanted a finite number, found inf"):
        changed(problem, f"{RIGID}\ngrasp_cone_deg = inf")


def test_the_share_that_statics_leaves_may_be_said(problem: DesignProblem) -> None:
    said = changed(problem, 'grasp = "point"', "robot_share = 0.5")
    assert said.scene.robot_share is None
    offset = 'grasp = "point"\ncenter_of_mass_m = [-0.1, 0.0, 0.0]'
    assert changed(problem, offset, "robot_share = 0.7").scene.robot_share is None
    assert changed(problem, task="robot_share = 0.7").scene.robot_share == 0.7


def test_weights_are_the_files_or_equal(problem: DesignProblem) -> None:
    assert changed(problem).weights == EffortWeights(1.0, 1.0)
    assert changed(problem, task="effort_weights = { human = 3.0 }").weights == EffortWeights(1.0, 3.0)


def test_allocations_are_parameters_without_links(shared: DesignProblem) -> None:
    assert shared.space.records[-2:] == (
        Parameter(name="allocation.robot_share", lower=0.1, upper=0.9, unit="1"),
        Parameter(name="allocation.effort_ratio", lower=-1.0, upper=2.0, unit="1"),
    )
    tree = shared.scene.robot.tree
    unscaled = shared.space.unscaled(tree)
    assert unscaled[-2:] == (0.5, 0.0)
    assert shared.space.resized(tree, (*unscaled[:-2], 0.9, 1.0)) == shared.space.resized(tree, unscaled)
    assert [p["links"] for p in model_json(shared)["parameters"][-2:]] == [[], []]


def test_population_files_hold_allocations(shared: DesignProblem) -> None:
    tree = shared.scene.robot.tree
    values = (*shared.space.unscaled(tree)[:-2], 0.25, -0.75)
    text = designs_text("some", {"one": values}, shared.space, "a remark")
    assert '"robot_share" = 0.25' in text
    assert read_designs(text, "some.toml", shared.space, tree)["one"] == values
    with pytest.raises(InputError, match=r"allocation\.robot_share: wanted a number from 0 to 1, found 1.5"):
        read_designs(text.replace("0.25", "1.5"), "some.toml", shared.space, tree)
    with pytest.raises(
        InputError, match=r"allocation: wanted one of the problem's allocation parameters, found 'hape'"
    ):
        read_designs(text.replace('"robot_share"', '"hape"'), "some.toml", shared.space, tree)


def test_notebooks_take_allocations_of_any_sign(shared: DesignProblem) -> None:
    text = shared.source.text + "\n[solver]\nstart_portfolio = false\ncompile = false\n"
    opened = Problem(msgspec.structs.replace(shared.source, text=text))
    found = opened.evaluate({"allocation.effort_ratio": -0.5, "allocation.robot_share": 0.3})
    assert found.parameters["allocation.effort_ratio"] == -0.5
    with pytest.raises(InputError, match=r"allocation\.robot_share: wanted a number from 0 to 1, found -0.3"):
        opened.evaluate({"allocation.robot_share": -0.3})


def gradients(problem: DesignProblem, values: tuple[float, ...]) -> Mapping[str, Mapping[str, float]]:
    result = Evaluator(problem).solve(values)
    found = Sensitivities(problem).at(values, result).sensitivities()
    return {name: moves.gradient or {} for name, moves in found.items()}


def test_objectives_move_with_allocations_as_differences_say(shared: DesignProblem) -> None:
    """Central differences of evaluations, which begin at the same starts."""
    exact = replace(shared, options=replace(shared.options, tolerance=1e-11))
    evaluator = Evaluator(exact)
    values = (*exact.space.unscaled(exact.scene.robot.tree)[:-2], 0.35, 0.3)
    found = gradients(exact, values)
    names = [parameter.name for parameter in exact.space.parameters]
    for name in ("allocation.robot_share", "allocation.effort_ratio", "length.forearm"):
        step = np.where(np.array(names) == name, 1e-4, 0.0)
        both = [
            evaluator.assess_values(tuple(np.array(values) + sign * step)).assessment.objectives
            for sign in (1.0, -1.0)
        ]
        for objective in ("robot_torque", "human_torque", "reach_height"):
            slope = (both[0][objective] - both[1][objective]) / 2e-4
            assert found[objective][name] == pytest.approx(slope, rel=1e-4, abs=1e-4), (objective, name)
    assert abs(found["robot_torque"]["allocation.robot_share"]) > 1.0
    assert found["reach_height"]["allocation.effort_ratio"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_polishing_moves_allocations(shared: DesignProblem) -> None:
    begun = (*shared.space.unscaled(shared.scene.robot.tree)[:-2], 0.45, 0.1)
    aim = aim_of(shared, {"robot_torque": 1.0}, "")
    done = polish(Evaluator(shared), shared.space.genome(begun), aim, 4, lambda step: None)
    assert done.after.objectives["robot_torque"] < 0.7 * done.before.objectives["robot_torque"]
    assert done.after.design["allocation.robot_share"] < 0.45


def test_the_baseline_refuses_to_choose_its_own_weights(shared: DesignProblem) -> None:
    with pytest.raises(InputError, match=r"design\.allocation: wanted no effort_ratio in the joint problem"):
        refuse_unsuited(shared)


def test_reach_with_rigid_grasps_has_a_gradient(problem: DesignProblem) -> None:
    """Moments of the person's hands cost nothing there, and a little regularisation decides between them."""
    rigid = changed(problem, allocations=SHARE)
    rigid = replace(rigid, options=replace(rigid.options, tolerance=1e-11))
    values = np.array((*rigid.space.unscaled(rigid.scene.robot.tree)[:-1], 0.3))
    found = gradients(rigid, tuple(values.tolist()))["reach_height"]
    evaluator = Evaluator(rigid)
    place = [parameter.name for parameter in rigid.space.parameters].index("length.forearm")
    step = 1e-4 * np.eye(len(values))[place]
    both = [
        evaluator.assess_values(tuple(v)).assessment.objectives["reach_height"]
        for v in (values + step, values - step)
    ]
    assert found["length.forearm"] == pytest.approx((both[0] - both[1]) / 2e-4, rel=1e-4)
    assert found["length.forearm"] > 0.1
