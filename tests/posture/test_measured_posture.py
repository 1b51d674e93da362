"""The measured posture as a term: its cost computed again with pinocchio and numpy, and its starts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest

from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.human.measured_posture import FEATURES, MARK, PostureRow, drawn_person, posture_rows
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.floating_base import BodyState
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import SolverCache
from evodesign.posture.assemble import CaseSymbols, Embodied, PostureMotion, assemble, free_hands_beside
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.formulations.person import PersonProblem
from evodesign.posture.formulations.reach import HIGHEST, ReachProblem
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import AgentPosture, CaseSolution
from evodesign.posture.seeking.measured_starts import mean_posture
from evodesign.posture.solution_derivative import PostureDerivative
from evodesign.posture.symmetry import Form, half, symmetric_forms, whole
from evodesign.posture.terms.measured_posture import MEASURED_POSTURE, any_person
from evodesign.posture.terms.registry import TERMS
from evodesign.posture.warm_start import instants_of, layout_of
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import Hold, ProblemSource, Status
from evodesign.tree.urdf_write import urdf_text
from tests.problem.test_person_keys import PERSON, refused

OLD = f'{PERSON}\nposture = "least_torque"'
NEW = f'{PERSON}\nposture = "measured"'
STATURE = 1.82
OTHERS = ("jHip_rotx", "jHip_rotz", "jAnkle_rotx", "jAnkle_rotz", "jElbow_roty")


def asked(problem: DesignProblem, text: str) -> ProblemSource:
    """The point-grasp problem with another person."""
    assert OLD in problem.source.text
    return ProblemSource("p.toml", problem.source.text.replace(OLD, text), problem.source.files)


@pytest.fixture(scope="module")
def scene(problem: DesignProblem) -> Scene:
    return build_problem(asked(problem, NEW)).scene


@pytest.fixture(scope="module", params=["whole", "half"])
def form(request: pytest.FixtureRequest, scene: Scene) -> Form:
    return half(scene.human) if request.param == "half" else whole(scene.human)


def seen(state: BodyState, side: str) -> dict[str, float]:
    """Features of a posture from pinocchio's frames alone: leans of links, and angles between them."""

    def lean(link: str) -> float:
        turn, _ = state.pose(link)
        return math.atan2(turn[0, 2], turn[2, 2])

    def turned(upper: str, lower: str) -> float:
        """About the transverse axis, of the lower link against the upper one."""
        turn = state.pose(f"{name}{upper}")[0].T @ state.pose(f"{name}{lower}")[0]
        return math.atan2(turn[0, 2], turn[2, 2])

    def at(link: str) -> np.ndarray:
        return np.array(state.pose(link)[1])

    name = side.capitalize()
    heights = zero_heights(human_tree(Person(STATURE, 72.7, Sex.MALE)))
    mark = heights["hips"] + MARK * STATURE
    links = ["Pelvis", "L5", "L3", "T12", "T8"]
    ends = [heights["hips"], *(heights[link] for link in links[1:]), heights["shoulders"]]
    low = [max(0.0, min(b, mark) - a) for a, b in pairwise(ends)]
    up = [max(0.0, b - max(a, mark)) for a, b in pairwise(ends)]
    arm = at(f"{name}ForeArm") - at(f"{name}UpperArm")
    fore = state.pose(f"{name}ForeArm")[0] @ np.array([0.0, 1.0 if side == "left" else -1.0, 0.0])
    along = arm / np.linalg.norm(arm)
    palm, ankle = at(f"{name}Palm"), at(f"{name}Foot")
    return {
        "trunk_low": float(np.dot(low, [lean(link) for link in links]) / sum(low)),
        "trunk_up": float(np.dot(up, [lean(link) for link in links]) / sum(up)),
        "knee": turned("UpperLeg", "LowerLeg"),
        "shank": -turned("LowerLeg", "Foot"),
        "arm": math.atan2(arm[0], -arm[2]),
        "elbow": math.acos(np.clip(along @ fore, -1.0, 1.0)),
        "ahead": (palm[0] - ankle[0]) / STATURE,
        "sideways": (1.0 if side == "left" else -1.0) * along[1],
    }


def zero_heights(tree: object) -> dict[str, float]:
    """Heights of the spine's links in the T-pose, from the figures of joints."""
    height = {"Pelvis": 0.0}
    for joint in tree.joints:  # type: ignore[attr-defined]
        height[joint.child] = height[joint.parent] + joint.parent_from_child.translation[2]
    return {**height, "hips": height["LeftUpperLeg"], "shoulders": height["LeftUpperArm"]}


def at_height(rows: list[PostureRow], quantity: str, field: str, eta: float) -> float:
    own = sorted((row.eta, getattr(row, field)) for row in rows if row.quantity == quantity)
    return float(np.interp(eta, *zip(*own, strict=True)))


def expected_cost(features: Mapping[str, float], task: str, eta: float, drawn: np.ndarray) -> float:
    """(y - m)^T P (y - m), precision and the drawn person's way from m linear between knots on both sides."""
    own = [row for row in posture_rows() if row.task in (task, "both") and not math.isnan(row.eta)]
    unit = {name: 1.0 if name in ("ahead", "sideways") else math.radians(1.0) for name in FEATURES}
    away = np.array([features[n] - unit[n] * at_height(own, n, "mean", eta) for n in FEATURES])
    knots = sorted({row.eta for row in own})
    share = np.interp(eta, knots, range(len(knots)))
    below = min(int(share), len(knots) - 2)
    scales, moved = [], []
    for knot in knots[below : below + 2]:
        here = {row.quantity: row for row in own if row.eta == knot}
        deviation = np.array([unit[name] * here[name].deviation for name in FEATURES])
        correlation = np.eye(len(FEATURES))
        for pair in (("arm", "elbow"), ("arm", "ahead"), ("elbow", "ahead")):
            i, j = (FEATURES.index(name) for name in pair)
            row = here.get(" ".join(pair))
            correlation[i, j] = correlation[j, i] = 0.0 if row is None else row.mean
        scales.append(correlation * np.outer(deviation, deviation))
        moved.append(deviation * (np.linalg.cholesky(correlation) @ drawn))
    away = away - moved[0] - (share - below) * (moved[1] - moved[0])
    costs = [float(away @ np.linalg.solve(covariance, away)) for covariance in scales]
    return costs[0] + (share - below) * (costs[1] - costs[0])


def flat_posture(form: Form, rng: np.random.Generator) -> AgentPosture:
    """A posture in the plane of symmetry with arms that hang, without feet that turn: leans say all of it."""
    joints = dict.fromkeys(form.agent.joints, 0.0)
    flexion = rng.uniform(-0.2, 0.6)
    (rhythm,) = [each for each in form.agent.rhythms if each.name == "lumbar_flexion"]
    joints |= {name: share * flexion for name, share in zip(rhythm.joints, rhythm.shares, strict=True)}
    joints["jT9T8_roty"] = rng.uniform(-0.1, 0.2)
    bends = {part: rng.uniform(0.1, 0.8) for part in ("Hip_roty", "Knee_roty", "Ankle_roty")}
    for name, left in (("Left", 1.0), ("Right", -1.0)):
        joints |= {f"j{name}{part}": angle for part, angle in bends.items()}
        joints[f"j{name}Shoulder_rotx"] = -left * 1.3
        joints[f"j{name}Shoulder_rotz"] = -left * 0.4
        joints[f"j{name}Elbow_rotz"] = -left * bends["Knee_roty"]
        joints[f"j{name}Elbow_roty"] = 0.1
        joints[f"j{name}Hip_rotx"] = left * 0.05
    joints["jLeftAnkle_rotz"] = 0.02
    joints["jRightAnkle_rotz"] = -0.02
    none = dict.fromkeys(form.agent.joints, 0.0)
    wrenches = {contact.name: np.zeros(6) for contact in form.agent.contacts}
    base, angles = np.array([-0.5, 0.0, 0.9]), np.array([0.0, rng.uniform(-0.2, 0.4), 0.0])
    return AgentPosture(base, angles, joints, none, wrenches)


@pytest.mark.parametrize("height", [0.1, 0.45, 0.9, 1.58, 2.2])
@pytest.mark.parametrize("task", ["hold", "lift"])
@pytest.mark.parametrize("sample", [0, 5])
def test_the_cost_is_what_numpy_makes_of_pinocchios_frames(
    scene: Scene, form: Form, height: float, task: str, sample: int
) -> None:
    motions = {}
    symbolic, given = any_person(scene)
    if task == "lift":
        count = len(form.coordinates)
        parts = {"base_position": ca.DM.zeros(3), "base_angles": ca.DM.zeros(3), "joints": ca.DM.zeros(count)}
        motions = {HUMAN: PostureMotion(parts, parts)}
    parties = (Embodied(form, form.agent.tree), *free_hands_beside(form, scene))
    made = assemble(parties, TERMS.values(), CaseSymbols(symbolic, (height,), motions))
    cost = MEASURED_POSTURE.posture_cost(made.undisturbed.bodies[HUMAN])
    symbols = ca.vertcat(*[variable.symbol for variable in made.variables])
    function = ca.Function("cost", [symbols, *given.values()], [cost])
    posture = flat_posture(form, np.random.default_rng(int(10.0 * height)))
    known = form.parts(posture)
    packed = [
        np.ravel(known.get(v.key.part, np.zeros(v.symbol.numel())))[: v.symbol.numel()] / v.scale
        for v in made.variables
    ]
    model = AgentModel.of(form.agent, form.agent.tree)
    state = model.at(posture)
    eta = (height + scene.payload.grasp_point(form.agent, form.hands[0])[2]) / STATURE
    drawn = np.array(drawn_person(sample))
    expected = np.mean([expected_cost(seen(state, side), task, eta, drawn) for side in ("left", "right")])
    for name in OTHERS:
        deviation = math.radians(30.0 if name == "jElbow_roty" else 10.0)
        for side in ("jLeft", "jRight"):
            expected += (posture.joints[name.replace("j", side, 1)] / deviation) ** 2 / 2.0
    expected += (posture.joints["jT9T8_roty"] / math.radians(10.0)) ** 2
    assert float(function(np.concatenate(packed), drawn)) == pytest.approx(30.0 * expected, rel=1e-6)


@pytest.mark.parametrize("eta", [0.15, 0.3, 0.44, 0.6, 0.8, 1.0])
def test_a_start_at_the_mean_has_the_means_features_with_feet_on_the_ground(scene: Scene, eta: float) -> None:
    form = half(scene.human)
    given = form.agent.measured
    assert given is not None
    posture = mean_posture(form, given, -0.25, eta)
    state = AgentModel.of(form.agent, form.agent.tree).at(posture)
    mean = given.hold.mean(eta)
    assert state.pose("LeftSole")[1][2] == pytest.approx(0.0, abs=1e-9)
    assert -0.25 - state.pose("LeftFoot")[1][0] == pytest.approx(mean["ahead"] * STATURE)
    for side in ("left", "right"):
        found = seen(state, side)
        for name in ("trunk_low", "trunk_up", "knee", "shank", "arm", "elbow"):
            assert found[name] == pytest.approx(mean[name], abs=1e-6), name


def test_a_start_of_the_robot_alone_begins_beside_the_mean_person(
    problem: DesignProblem, scene: Scene
) -> None:
    """In a T-pose the upper arm has no direction forward, and a solve would end where it begins."""
    setting, solvers = Setting(scene, problem.space, problem.weights, problem.options), SolverCache()
    postures = JointPostures("symmetric", symmetric_forms(scene), setting, solvers)
    design = problem.space.unscaled(scene.robot.tree)
    robot = ReachProblem(setting, symmetric=True, solvers=solvers).extreme_posture(design, HIGHEST)
    assert {name.split(".")[0] for name in robot[0]} == {ROBOT}
    checker = Checker(scene, *(AgentModel.of(agent, agent.tree) for agent in scene.agents))
    hold = Hold(height_m=0.9)
    trial = postures.solve(design, hold, postures.starts(hold, robot), checker)
    assert [attempt.status for attempt in trial.attempts] == [Status.SOLVED]


def test_the_person_stands_as_measured_people_do(problem: DesignProblem, scene: Scene) -> None:
    """Bent below the hips, upright above; each of three starts leads there."""
    person = PersonProblem(half(scene.human), scene, 1.0, problem.options, SolverCache())
    leans = {}
    for height in (0.5, 1.1):
        raw = person.best_of_many(height, 0.0)
        assert raw is not None
        (instant,) = instants_of(layout_of(person.program, HUMAN), (half(scene.human),), scene, raw.values)
        state = AgentModel.of(scene.human, scene.human.tree).at(instant.postures[HUMAN])
        leans[height] = math.degrees(seen(state, "left")["trunk_up"])
    assert 45.0 < leans[0.5] < 70.0
    assert -5.0 < leans[1.1] < 10.0


def test_least_torque_remains_what_it_was(problem: DesignProblem) -> None:
    """No measured posture, and a spine as `joint_ranges` says."""
    human = build_problem(asked(problem, OLD)).scene.human
    assert (human.measured, human.rhythms, human.coupled_joints) == (None, (), ())


def test_a_generated_person_of_whom_nothing_is_said_stands_as_measured(problem: DesignProblem) -> None:
    said, unsaid = (build_problem(asked(problem, text)).scene.human for text in (NEW, PERSON))
    assert unsaid.measured is not None
    assert unsaid == said


def test_a_person_from_a_urdf_has_a_measured_posture_if_it_has_the_body(problem: DesignProblem) -> None:
    """With the same programs as the generated one; another one is refused."""
    frames = (
        'urdf = "person.urdf"\nhands = { left = "LeftPalm", right = "RightPalm" }\n'
        'soles = { left = "LeftSole", right = "RightSole", size_m = [0.27664, 0.1001] }\n'
        'posture = "measured"\ntrunk = ["Pelvis", "T8"]'
    )
    text = urdf_text(human_tree(Person(STATURE, 72.7, Sex.MALE)))
    files = {**problem.source.files, "person.urdf": text}
    source = ProblemSource("p.toml", asked(problem, frames).text, files)
    person = build_problem(replace_files(source, files)).scene.human
    assert person.measured is not None
    assert person.measured.stature == pytest.approx(STATURE, abs=1e-6)
    assert [each.name for each in person.rhythms] == ["lumbar_flexion", "lumbar_bending"]
    files["person.urdf"] = text.replace("LeftLowerLeg", "LeftShin")
    assert refused(replace_files(source, files)) == (
        "p.toml: human.posture: wanted 'least_torque', or a person with the generated one's body, such "
        "as its link 'LeftLowerLeg', found 'measured' of 'human'"
    )
    least = build_problem(
        replace_files(
            ProblemSource("p.toml", source.text.replace('posture = "measured"\n', ""), files), files
        )
    )
    assert least.scene.human.measured is None


def replace_files(source: ProblemSource, files: Mapping[str, str]) -> ProblemSource:
    return ProblemSource(source.path, source.text, dict(files))


@pytest.mark.parametrize("ranges", ["separate", "coupled"])
def test_lumbar_joints_that_do_not_bend_as_one_are_refused(problem: DesignProblem, ranges: str) -> None:
    assert refused(asked(problem, f'{NEW}\njoint_ranges = "{ranges}"')) == (
        "p.toml: human.joint_ranges: wanted 'rhythm', which a measured posture has, or posture = "
        f"\"least_torque\", found '{ranges}'"
    )


@pytest.mark.parametrize("height", [0.5, 0.9, 1.3])
def test_slopes_of_a_posture_beside_a_measured_person_are_differences(
    problem: DesignProblem, scene: Scene, height: float
) -> None:
    """Cost and the person's torques, along one direction of the design; large costs make none inexact."""
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    postures = PostureProblem(setting, Symmetry.ON)
    middle = np.array(problem.space.values((0.6,) * len(problem.space.parameters)))
    way = np.random.default_rng(4).uniform(-1.0, 1.0, len(middle)) * middle

    def solved(step: float) -> tuple[CaseSolution, tuple[float, ...]]:
        design = tuple((middle + step * way).tolist())
        robot = AgentModel.of(scene.robot, problem.space.resized(scene.robot.tree, design))
        checker = Checker(scene, robot, AgentModel.of(scene.human, scene.human.tree))
        found = postures.solve(design, Hold(height_m=height), checker)
        assert found.solved
        return found, design

    here, design = solved(0.0)
    found = postures.derivative(design, here)
    assert isinstance(found, PostureDerivative)
    step = 1e-4
    (ahead, _), (behind, _) = solved(step), solved(-step)
    assert ahead.attempt is not None
    assert behind.attempt is not None
    slope = (ahead.attempt.cost - behind.attempt.cost) / (2.0 * step)
    assert found.cost_slope @ way == pytest.approx(slope, rel=1e-3, abs=1e-4)
    for joint in ("jL5S1_roty", "jLeftKnee_roty"):
        torques = [each.instants[0].postures[HUMAN].torques[joint] for each in (ahead, behind)]
        exact = found.along_torques(0, 0, {HUMAN: {joint: 1.0}}) @ way
        assert exact == pytest.approx((torques[0] - torques[1]) / (2.0 * step), rel=1e-3, abs=1e-3)
