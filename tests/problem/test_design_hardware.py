"""Actuators and walls of a problem file: what it may say, and what becomes of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.gradients import assessed_gradients
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.hardware.actuators import PowerLaw, actuator_law
from evodesign.hardware.heat import Duty
from evodesign.mechanics.agent import ROBOT
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.designs import designs_text, read_designs
from evodesign.problem.model_json import model_json
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.hardware_quantities import FATIGUE, cost
from evodesign.quantities.motion_quantities import motion_power_by_speed, motion_power_by_torque, power
from evodesign.quantities.objectives import objective_kinds
from evodesign.records import Constraint, Hold, Objective, ProblemSource, Sense, design_of
from evodesign.tree.equip import actuators_of, rated_torques
from tests.fuzz.input_cases import PROBLEM, TEXTS

SHOULDER = '\n[[design.actuator]]\nname = "shoulder"\njoints = ["l_shoulder", "r_shoulder"]\n'
SPIN = '\n[[design.actuator]]\nname = "spin"\njoints = ["spin"]\n'
SIZES = "rated_torque_n_m = [2.0, 32.0]\n"
MODELS = 'models = ["X6-60", "own", "X4-10"]\n'
OWN = """
[[actuator]]
model = "own"
mass_kg = 0.4
peak_torque_n_m = 30.0
rated_torque_n_m = 12.0
source = "assumed"
"""
SQUAT = """
[[load_case]]
name = "squat"
joints_deg = { l_shoulder = 60.0 }
balance = [["spin"]]
"""
DUTY = """
[duty]
lifts_per_hour = 60
hold_s = 20.0
shift_h = 8.0
winding_limit_c = 120.0
thermal_time_constant_s = 120.0
"""
WARM = "\n[constraints]\nwinding_temperature_c = { upper = 100.0 }\n"
TIRED = "\n[constraints]\nfatigue_safety_factor = { lower = 2.0 }\n"
LIVING = DUTY + "life_shifts = 2500\n"
FRICTION = "\n[hardware]\ngear_friction = true\n"
WALL = '\n[[design.wall]]\nname = "arms"\nlinks = ["l_arm", "r_arm"]\n'
THIN = "thickness_m = [0.001, 0.004]\n"
IN_ALUMINIUM = 'material = "aluminium_6061"\n'


def small(more: str) -> DesignProblem:
    return build_problem(ProblemSource(path=PROBLEM, text=TEXTS[PROBLEM] + more, files=TEXTS))


def test_a_rated_torque_has_a_logarithmic_scale() -> None:
    problem = small(SHOULDER + SIZES)
    record = problem.space.records[-1]
    assert (record.name, record.unit, record.logarithmic) == ("actuator.shoulder", "N m", True)
    genome = (0.5,) * len(problem.space.parameters)
    assert problem.space.values(genome)[-1] == pytest.approx(8.0)
    assert problem.space.genome(problem.space.values(genome)) == pytest.approx(genome)
    assert problem.space.unscaled(problem.scene.robot.tree)[-1] == pytest.approx(8.0)
    ends = [design_of(problem.space.records, (u,) * len(genome))[record.name] for u in (0.0, 1.0)]
    assert ends == [2.0, 32.0]
    step = 1e-6
    slope = (record.value_at(0.3 + step) - record.value_at(0.3 - step)) / (2 * step)
    assert record.slope_at(record.value_at(0.3)) == pytest.approx(slope)
    assert model_json(problem)["parameters"][-1]["joints"] == ["l_shoulder", "r_shoulder"]


def test_a_margin_that_is_a_number_has_no_coordinate_in_a_genome() -> None:
    problem, bounded = (small(SHOULDER + f"margin = {margin}\n") for margin in ("1.5", "[1.0, 4.0]"))
    space, tree = problem.space, problem.scene.robot.tree
    assert space.records == bounded.space.records[:-1]
    assert problem.settings().dimension == len(space.records) == len(space.counts)
    genome = tuple(0.1 * (1 + place) for place in range(len(space.records)))
    values = space.values(genome)
    assert values == (*bounded.space.values((*genome, 0.7))[:-1], 1.5)
    assert space.genome(values) == pytest.approx(genome)
    assert space.unscaled(tree)[-1] == 1.5
    assert set(space.named(values)) == {each.name for each in space.records}
    assert space.values_of(space.named(values)) == values
    text = designs_text("one", {"a": values}, space, "")
    assert read_designs(text, "designs.toml", space, tree)["a"] == pytest.approx(values)
    with pytest.raises(InputError, match="one of the problem's margin parameters"):
        read_designs(text + "margin = { shoulder = 2.0 }\n", "designs.toml", space, tree)


@pytest.mark.parametrize("way", ["rated_torque_n_m = [2.0, 32.0]\n", "margin = [1.0, 4.0]\n"])
def test_an_actuator_of_any_size_follows_the_law_of_its_gear(way: str) -> None:
    (parameter,) = (p for p in small(SHOULDER + way + 'gear = "strain_wave"\n').space.parameters if p.joints)
    (usual,) = (p for p in small(SHOULDER + way).space.parameters if p.joints)
    for each, gear in ((parameter, "strain_wave"), (usual, "planetary")):
        actuator, law = each.actuator(20.0), actuator_law(gear)
        assert (actuator.mass, actuator.motor_constant) == (law.at(20.0).mass, law.motor_constant(20.0))
        assert each.law == law


def test_models_are_choices_the_weakest_first_with_their_own_figures() -> None:
    problem = small(SHOULDER + MODELS + OWN)
    record, tree = problem.space.records[-1], problem.scene.robot.tree
    assert record.choices == (4.0, 12.0, 20.0)
    assert record.materials == ("X4-10", "own", "X6-60")
    assert problem.space.counts[-1] == 3
    values = (*problem.space.unscaled(tree)[:-1], 12.0)
    chosen = actuators_of(problem.space.resized(tree, values))["l_shoulder"]
    assert (chosen.model, chosen.mass, chosen.peak) == ("own", 0.4, 30.0)
    assert chosen.motor_constant == actuator_law().motor_constant(12.0)


PRICED = OWN.replace("[[actuator]]", "[[actuator]]\nprice_eur = 120.0") + OWN.replace(
    "[[actuator]]", "[[actuator]]\nprice_eur = 300.0"
).replace('"own"', '"stronger"').replace("12.0", "20.0")
COST = "\n[constraints]\ncost_eur = { upper = 700.0 }\n"


def test_prices_of_models_add_up_to_the_cost_of_a_design() -> None:
    problem = small(SHOULDER + 'models = ["own", "stronger"]\n' + PRICED + COST)
    tree = problem.scene.robot.tree
    values = problem.space.unscaled(tree)[:-1]
    for rated, price in ((12.0, 240.0), (20.0, 600.0)):
        assert cost(problem.space.resized(tree, (*values, rated))) == price
    assert (problem.constraints[-1].name, problem.constraints[-1].unit) == ("cost", "EUR")
    assert cost(tree) is None


def test_the_programs_know_each_models_figures() -> None:
    casadi = pytest.importorskip("casadi")
    (parameter,) = (p for p in small(SHOULDER + MODELS + OWN).space.parameters if p.joints)
    symbol = casadi.SX.sym("rated")
    actuator = parameter.actuator(symbol)
    names = ("mass", "peak", "motor_constant", "inertia", "stiffness", "speed")
    figures = casadi.Function("f", [symbol], [casadi.vertcat(*(getattr(actuator, n) for n in names))])
    for model in parameter.models:
        wanted = [getattr(model, name) for name in names]
        assert np.array(figures(model.rated)).ravel() == pytest.approx(wanted, rel=1e-12)


def test_a_wall_makes_links_hollow_and_its_thickness_may_be_chosen() -> None:
    fixed = small(
        WALL + "thickness_m = 0.002\n" + IN_ALUMINIUM + "\n[hardware]\nnon_structural_share = 0.0\n"
    )
    assert all(parameter.kind is not ParameterKind.WALL for parameter in fixed.space.parameters)
    chosen = small(WALL + THIN + IN_ALUMINIUM + "\n[hardware]\nnon_structural_share = 0.0\n")
    tree = chosen.scene.robot.tree
    place = [p.kind for p in chosen.space.parameters].index(ParameterKind.WALL)
    assert chosen.space.records[place].unit == "m"
    values = list(chosen.space.unscaled(tree))
    values[place] = 0.002
    masses = [
        float(problem.space.resized(tree, given).link_by_name["l_arm"].mass)
        for problem, given in ((fixed, fixed.space.unscaled(tree)), (chosen, values))
    ]
    assert masses[0] == pytest.approx(masses[1], rel=1e-12)
    values[place] = 0.001
    thinner = float(chosen.space.resized(tree, values).link_by_name["l_arm"].mass)
    assert 0.4 < thinner / masses[0] < 0.55


def test_designs_name_torques_walls_and_models() -> None:
    problem = small(SHOULDER + SIZES + SPIN + MODELS + OWN + WALL + THIN + IN_ALUMINIUM)
    text = (
        'name = "x"\n[[design]]\nname = "one"\nrated_torque_n_m = { shoulder = 5.0 }\n'
        'model = { spin = "own" }\nwall_m = { arms = 0.003 }\n'
    )
    tree = problem.scene.robot.tree
    (values,) = read_designs(text, "designs.toml", problem.space, tree).values()
    named = problem.space.named(values)
    assert (named["actuator.shoulder"], named["actuator.spin"], named["wall.arms"]) == (5.0, 12.0, 0.003)
    again = designs_text("x", {"one": values}, problem.space, "written")
    assert read_designs(again, "designs.toml", problem.space, tree)["one"] == values


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (SHOULDER, ["design.actuator[0]", "one of rated_torque_n_m, models, margin", "none"]),
        (SHOULDER + SIZES + MODELS, ["design.actuator[0]", "rated_torque_n_m and models"]),
        (SHOULDER + "rated_torque_n_m = [5.0, 5.0]\n", ["a rising pair", "[5, 5]"]),
        (SHOULDER + 'models = ["X6-60", "X4-11"]\n', ["models[1]", "'X4-11'; did you mean 'X4-10'?"]),
        (SHOULDER + 'models = ["X6-60"]\n', ["at least two models"]),
        (SHOULDER + 'models = ["X6-60", "X6-60"]\n', ["each model once"]),
        (
            SHOULDER + MODELS + OWN.replace("12.0", "31.0"),
            ["rated_torque_n_m", "at most the peak torque, 30"],
        ),
        (SHOULDER + MODELS + OWN.replace('"own"', '"RS04"'), ["actuator[0].model", "in the catalogue"]),
        (SHOULDER + SIZES + SPIN.replace('["spin"]', '["l_shoulder"]') + SIZES, ["a joint in one actuator"]),
        (SHOULDER.replace("l_shoulder", "l_sholder") + SIZES, ["joints[0]", "did you mean 'l_shoulder'?"]),
        (SHOULDER + "margin = [0.5, 2.0]\n", ["design.actuator[0].margin", "of at least 1", "0.5"]),
        (SHOULDER + "margin = 0.9\n", ["design.actuator[0].margin", "of at least 1, found 0.9"]),
        (
            SHOULDER + "margin = 1.5\n[[task.lift]]\nfrom_m = 0.8\nto_m = 1.0\n",
            ["design.actuator[0].margin", "rated_torque_n_m or models, as a load is lifted", "a margin"],
        ),
        (SHOULDER + "margin = nan\n", ["design.actuator[0].margin", "nan"]),
        (SHOULDER + "margin = inf\n", ["design.actuator[0].margin", "inf"]),
        (SHOULDER + "margin = [nan, 2.0]\n", ["design.actuator[0].margin", "nan"]),
        (SHOULDER + "margin = [2.0, 2.0]\n", ["design.actuator[0].margin", "a rising pair"]),
        (
            SHOULDER + SIZES + 'gear = "cycloidal"\n',
            ["design.actuator[0].gear", "a gear with a law: planetary, strain_wave", "'cycloidal'"],
        ),
        (SHOULDER + SIZES + 'gear = "worm"\n', ["design.actuator[0].gear", "'worm'"]),
        (SHOULDER + MODELS + 'gear = "planetary"\n' + OWN, ["gear", "no gear beside models"]),
        (
            SHOULDER + MODELS + OWN.replace("[[actuator]]", "[[actuator]]\nratcheting_torque_n_m = 9.0"),
            ["actuator[0]", "that rise", "12, 30, 9"],
        ),
        (SHOULDER + SIZES + SQUAT.replace("spin", "spine"), ["load_case[0]", "did you mean 'spin'?"]),
        (SHOULDER + SIZES + SQUAT.replace("60.0", "600.0"), ["joints_deg.l_shoulder", "600"]),
        (
            SHOULDER + SIZES + SQUAT + "dropped_from_m = 0.1\n",
            ["load_case[0].dropped_from_m", "a [[design.wall]]"],
        ),
        (SHOULDER + SIZES + SQUAT + SQUAT, ["load_case[1].name", "'squat' twice"]),
        (SHOULDER + SIZES + SQUAT + 'feet = "left"\n', ["load_case[0].balance", "2 groups"]),
        (WALL + "thickness_m = 0.3\n" + IN_ALUMINIUM, ["wall of link l_arm", "less than half"]),
        (WALL + "thickness_m = -0.1\n" + IN_ALUMINIUM, ["thickness_m", "a positive number"]),
        (WALL + "thickness_m = [0.2, 0.1]\n" + IN_ALUMINIUM, ["a rising pair"]),
        (
            WALL + "thickness_m = [0.0005, 0.002]\n" + IN_ALUMINIUM,
            ["design.wall[0].thickness_m", "at least 0.001 m", "aluminium_6061", "sinbo", "0.0005 m"],
        ),
        (
            WALL + "thickness_m = 0.002\n" + IN_ALUMINIUM + "\n[hardware]\nleast_wall_m = 0.003\n",
            ["design.wall[0].thickness_m", "at least 0.003 m, hardware.least_wall_m", "0.002 m"],
        ),
        (WALL + THIN, ["design.wall[0].material", "or a [[design.density]] of 'l_arm'"]),
        (WALL + THIN + 'material = "aluminum_6061"\n', ["did you mean 'aluminium_6061'?"]),
        (WALL + THIN + 'material = "aluminum"\n', ["did you mean 'aluminium_6061' or 'aluminium_7075'?"]),
        (WALL + THIN + 'material = "wood"\n', ["abs, nylon_66", "stainless_304", "found 'wood'"]),
        (
            WALL + THIN + IN_ALUMINIUM + WALL.replace("arms", "more") + THIN,
            ["a link in one parameter of a kind"],
        ),
        (
            "\n[constraints]\nholding_power_w = { upper = 5.0 }\n",
            ["a [[design.actuator]] for 'holding_power'"],
        ),
        (COST, ["constraints.cost_eur", "a [[design.actuator]] for 'cost'"]),
        (SHOULDER + SIZES + COST, ["models with a price_eur in design.actuator[0]", "which has no prices"]),
        (SHOULDER + MODELS + OWN + COST, ["a price_eur of every model", "none of 'X6-60'"]),
        (DUTY, ["duty", "a [[design.actuator]] that gets warm"]),
        (SHOULDER + SIZES + DUTY.replace("= 20.0", "= 61.0"), ["duty.hold_s", "at most 60 s"]),
        (SHOULDER + SIZES + WARM, ["constraints.winding_temperature_c", "a [duty] for"]),
        (
            SHOULDER + SIZES + WALL + THIN + IN_ALUMINIUM + DUTY + TIRED,
            [FATIGUE, "a [duty] with life_shifts"],
        ),
        (
            SHOULDER + SIZES + WALL + THIN + 'material = "aluminium_7075"\n' + LIVING + TIRED,
            ["design.wall[0].material", "one of aluminium_6061, as", "'aluminium_7075'"],
        ),
        (SHOULDER + SIZES + DUTY.replace("c = 120", "c = 20"), ["duty.winding_limit_c", "60"]),
        (
            SHOULDER + SIZES + 'gear = "strain_wave"\n' + FRICTION,
            [
                "hardware.gear_friction",
                "gears whose friction the catalogue knows: planetary",
                "'strain_wave'",
            ],
        ),
        (
            SHOULDER + 'models = ["RH-17", "X4-10"]\n' + FRICTION,
            ["design.actuator[0].models", "'RH-17', without a friction_torque_n_m"],
        ),
    ],
)
def test_contradictions_are_refused_in_a_sentence(more: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        small(more)
    for word in (PROBLEM, *words):
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)


ARMS = tuple(
    f"{side}_{name}" for name in ("shoulder_pitch", "shoulder_roll", "shoulder_yaw") for side in "lr"
)
ELBOWS = ("l_elbow", "r_elbow")


EASILY = PowerLaw(0.005, 1.0, 1.0, 4)
"""Friction of 0.2 N m at 40, which is less than an elbow bears."""
EASY = Duty(holds_per_hour=30.0, hold=40.0, shift=4.0, air=25.0, limit=120.0, time_constant=90.0)


@pytest.fixture(scope="module")
def driven(problem: DesignProblem) -> DesignProblem:
    """The point-grasp problem at one height, with actuators for shoulders and elbows."""
    actuators = (
        DesignParameter(ParameterKind.ACTUATOR, "shoulder", (), 0.5, 100.0, joints=ARMS, duty=EASY),
        DesignParameter(
            ParameterKind.ACTUATOR, "elbow", (), 0.5, 100.0, joints=ELBOWS, duty=EASY, friction=EASILY
        ),
    )
    robot = replace(problem.scene.robot, torque_limits=dict.fromkeys(problem.scene.robot.joints, 500.0))
    return replace(
        problem,
        scenes=tuple(scene.with_agents(robot) for scene in problem.scenes),
        space=DesignSpace((*problem.space.parameters[:2], *actuators)),
        tasks=(Hold(height_m=1.2),),
        objectives=tuple(
            Objective(name=name, sense=Sense.MINIMISE, unit=objective_kinds()[name].unit)
            for name in ("holding_power", "mass", "robot_torque", "peak_torque", "winding_temperature")
        ),
        constraints=(Constraint(name="torque_margin", unit="1", lower=1.0, upper=None),),
        options=replace(problem.options, tolerance=1e-11),
    )


@pytest.fixture(scope="module")
def inner(driven: DesignProblem) -> Evaluator:
    return Evaluator(driven)


def solved(inner: Evaluator, shoulder: float, elbow: float) -> DesignResult:
    return inner.solve((1.0, 1.1, shoulder, elbow))


@pytest.fixture(scope="module")
def strong(inner: Evaluator) -> DesignResult:
    return solved(inner, 40.0, 40.0)


def test_holding_power_and_margin_are_those_of_the_torques_by_hand(strong: DesignResult) -> None:
    kinds, law = objective_kinds(), actuator_law()
    torques = strong.cases[0].postures[ROBOT].torques
    constant = law.motor_constant(40.0)
    friction = 0.005 * 40.0  # which holds so much of an elbow's torque
    motors = [torques[joint] for joint in ARMS] + [abs(torques[joint]) - friction for joint in ELBOWS]
    assert min(motors[-2:]) > 0.0
    power = sum((torque / constant) ** 2 for torque in motors)
    assert kinds["holding_power"].value(strong) == pytest.approx(power, rel=1e-12)
    largest = max(abs(torques[joint]) for joint in (*ARMS, *ELBOWS))
    assert kinds["torque_margin"].value(strong) == pytest.approx(40.0 / largest, rel=1e-12)
    ball = law.mass(law.peak(40.0))
    assert kinds["actuator_mass"].value(strong) == pytest.approx(8 * ball, rel=1e-12)


def test_in_a_lift_motors_work_against_friction(driven: DesignProblem, strong: DesignResult) -> None:
    """Power of a posture that moves: by hand, and its slopes by differences."""
    robot, held = replace(driven.scene.robot, tree=strong.tree), strong.cases[0].postures[ROBOT]
    speeds = {joint: 0.3 * math.cos(place) for place, joint in enumerate(held.joints)}
    posture = replace(held, speeds=speeds)
    friction = 0.005 * 40.0
    wanted = 0.0
    for joint, speed in speeds.items():
        against = friction * speed / math.hypot(speed, 0.02) if joint in ELBOWS else 0.0
        motor = held.torques[joint] + against
        constant = actuator_law().motor_constant(40.0) if joint in (*ARMS, *ELBOWS) else math.inf
        wanted += max(motor * speed, 0.0) + (motor / constant) ** 2
    assert power(robot, posture) == pytest.approx(wanted, rel=1e-12)
    by_torque, by_speed = motion_power_by_torque(robot, posture), motion_power_by_speed(robot, posture)
    step = 1e-5
    for joint in (*ELBOWS, "l_shoulder_pitch", "r_knee"):
        for field, slopes in (("torques", by_torque), ("speeds", by_speed)):
            at = getattr(posture, field)
            ends = [
                power(robot, replace(posture, **{field: {**at, joint: at[joint] + side * step}}))
                for side in (-1.0, 1.0)
            ]
            assert slopes[joint] == pytest.approx((ends[1] - ends[0]) / (2.0 * step), rel=1e-6, abs=1e-6)


def test_a_posture_keeps_within_what_its_actuators_can_hold(strong: DesignResult, inner: Evaluator) -> None:
    """Elbows of little torque: the posture changes until they carry no more than their rating."""
    before = strong.cases[0].postures[ROBOT].torques
    limit = 0.7 * max(abs(before[joint]) for joint in ELBOWS)
    weak = solved(inner, 40.0, limit)
    assert weak.cases[0].solved
    after = weak.cases[0].postures[ROBOT].torques
    assert max(abs(after[joint]) for joint in ELBOWS) <= limit + 1e-5
    assert weak.cases[0].residuals["robot.torque_limits"] <= 1e-5
    assert objective_kinds()["torque_margin"].value(weak) >= 1.0 - 1e-5


def test_actuators_that_are_too_weak_leave_no_posture(inner: Evaluator) -> None:
    hopeless = solved(inner, 0.5, 0.5)
    assert hopeless.reach.highest is None or not hopeless.cases[0].solved


def test_a_duty_is_every_actuators_and_a_bound_on_windings_may_be_asked_for() -> None:
    problem = small(SHOULDER + SIZES + DUTY + WARM)
    assert [each.name for each in problem.constraints] == ["winding_temperature"]
    duty = problem.space.actuators(problem.space.values((0.5,) * len(problem.space.parameters)))[
        "l_shoulder"
    ].duty
    assert duty == Duty(60.0, 20.0, 8.0, 25.0, 120.0, 120.0)


HOT = Duty(holds_per_hour=1.0, hold=3600.0, shift=8.0, air=50.0, limit=120.0, time_constant=120.0)
"""For ever, in air in which windings bear sqrt(70 / 95) of their rated torque."""


def test_a_posture_keeps_within_what_windings_bear_in_the_duty(
    driven: DesignProblem, strong: DesignResult
) -> None:
    """The limit of elbows in the test above, by rated torques that are so much larger."""
    share = math.sqrt(70.0 / 95.0)
    parameters = [replace(each, duty=HOT if each.joints else None) for each in driven.space.parameters]
    warm = replace(driven, space=DesignSpace(tuple(parameters)))
    limit = 0.7 * max(abs(strong.cases[0].postures[ROBOT].torques[joint]) for joint in ELBOWS)
    result = solved(Evaluator(warm), 40.0, limit / share)
    assert result.cases[0].solved
    torques = result.cases[0].postures[ROBOT].torques
    assert max(abs(torques[joint]) for joint in ELBOWS) <= limit + 1e-5
    assert [rated_torques(result.tree)[joint] for joint in ELBOWS] == pytest.approx([limit, limit], rel=1e-9)
    warmest = max(
        HOT.temperature((abs(torques[joint]) - 0.005 * limit / share) * share / limit) for joint in ELBOWS
    )
    shoulders = max(HOT.temperature(abs(torques[joint]) / 40.0) for joint in ARMS)
    found = objective_kinds()["winding_temperature"].value(result)
    assert found == pytest.approx(max(warmest, shoulders), rel=1e-9)
    assert found <= 120.0


def test_gradients_by_actuators_are_those_of_differences(
    driven: DesignProblem, inner: Evaluator, strong: DesignResult
) -> None:
    values = strong.values
    gradients = assessed_gradients(driven, Sensitivities(driven, inner=inner.inner), values, strong).values
    kinds = objective_kinds()
    for position in (1, 2, 3):
        parameter = driven.space.records[position]
        step = 1e-3 * values[position]
        results = []
        for count in (-2, -1, 1, 2):
            moved = list(values)
            moved[position] += count * step
            results.append(inner.solve(moved))
        for name in (*(each.name for each in driven.objectives), "torque_margin"):
            found = [kinds[name].value(result) for result in results]
            slope = (8 * (found[2] - found[1]) - (found[3] - found[0])) / (12 * step)
            wanted = slope * parameter.slope_at(values[position])
            scale = abs(kinds[name].value(strong) or 0.0)
            error = abs(gradients[name][parameter.name] - wanted)
            assert error <= 1e-5 * max(scale, abs(wanted)), (name, parameter.name)


def test_without_hardware_a_genome_means_what_it_meant(problem: DesignProblem) -> None:
    for record in problem.space.records:
        assert record.value_at(0.25) == pytest.approx(0.75 * record.lower + 0.25 * record.upper)
        assert record.slope_at(1.0) == record.upper - record.lower
        assert math.isclose(record.share_of(record.value_at(0.25)), 0.25)
