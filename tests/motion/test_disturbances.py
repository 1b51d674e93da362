"""A lift under disturbances: one motion, and wrenches and torques of its own under each."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from evodesign.evaluation.lift_json import lift_json
from evodesign.evaluation.sensitivities import five_point
from evodesign.mechanics.agent import SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.disturbance import Disturbance, Disturbances, OverCases, PushedAt
from evodesign.motion.derivative import LiftDerivative
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_check import LiftChecker
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.lifting import LiftProblem
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.method import MethodName
from evodesign.posture.check import AgentMotion, Checker
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import symmetric_forms
from evodesign.tree.urdf_write import urdf_text
from tests.motion.lifted import LIFT, Lifted

pytestmark = pytest.mark.slow

AWAY = Disturbance("pushed away", push=(20.0, 0.0, 0.0))
HEAVIER = Disturbance("heavier", mass_share=0.3)
ROBOT_BACK = Disturbance("robot pushed", push=(-15.0, 0.0, 0.0), at=PushedAt.ROBOT)
EVERY = (AWAY, HEAVIER, ROBOT_BACK)


def under(lifted: Lifted, *cases: Disturbance, effort: OverCases = OverCases.WORST) -> Lifted:
    """The same with disturbances, by IPOPT: to compile each of their programs would take longer."""
    scene = replace(lifted.setting.scene, disturbances=Disturbances(cases, effort))
    options = replace(lifted.setting.options, compiled=False, method=MethodName.IPOPT)
    setting = replace(lifted.setting, scene=scene, options=options)
    return replace(
        lifted,
        setting=setting,
        lifts=LiftProblem(setting, symmetric=True),
        holds=PostureProblem(setting, Symmetry.ON),
    )


@pytest.fixture(scope="module")
def pushed(lifted: Lifted) -> Lifted:
    return under(lifted, *EVERY)


@pytest.fixture(scope="module")
def found(pushed: Lifted) -> LiftSolution:
    return pushed.solve(LIFT)


def asked(
    lifted: Lifted, who: str, posture: AgentPosture, moving: AgentMotion, push: NDArray[np.float64]
) -> tuple[NDArray[np.float64], dict[str, float]]:
    """Force and moment on the root and torques of the joints, by RNEA on the exported URDF.

    Args:
        push: on the trunk, in the agent's frame [N].
    """
    agent = getattr(lifted.setting.scene, who)
    model = pin.buildModelFromXML(urdf_text(agent.tree), pin.JointModelFreeFlyer())
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    q, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
    q[:3] = posture.base_position
    q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*posture.base_angles)).coeffs()
    velocity, acceleration = moving.velocities(posture.base_angles)
    v[:6], a[:6] = velocity[:6], acceleration[:6]
    for place, name in enumerate(agent.joints, 6):
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q], v[joint.idx_v], a[joint.idx_v] = (
            posture.joints[name],
            velocity[place],
            acceleration[place],
        )
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    outside = [pin.Force.Zero() for _ in range(model.njoints)]

    def applied(name: str, wrench: NDArray[np.float64], *, own_axes: bool) -> None:
        frame = model.frames[model.getFrameId(name, pin.FrameType.BODY)]
        turn = data.oMf[model.getFrameId(name, pin.FrameType.BODY)].rotation.T
        force = pin.Force(wrench) if own_axes else pin.Force(turn @ wrench[:3], turn @ wrench[3:])
        outside[frame.parentJoint] += frame.placement.act(force)

    for side in SIDES:
        applied(agent.frame(f"{side}_hand"), posture.wrenches[f"{side}_hand"], own_axes=False)
        applied(agent.frame(f"{side}_foot"), posture.wrenches[f"{side}_foot"], own_axes=True)
    if push.any():
        applied(agent.pushed_frame, np.r_[push, 0.0, 0.0, 0.0], own_axes=False)
    forces = pin.StdVec_Force()
    for each in outside:
        forces.append(each)
    torques = pin.rnea(model, data, q, v, a, forces)
    return torques[:6], {name: torques[model.joints[model.getJointId(name)].idx_v] for name in agent.joints}


@pytest.mark.parametrize("who", ["robot", "human"])
def test_torques_under_disturbances_are_those_of_inverse_dynamics(
    pushed: Lifted, found: LiftSolution, who: str
) -> None:
    """At every knot of the same motion, with the push on the robot's trunk where there is one."""
    assert found.solved, found.reason
    course, agent = found.course, getattr(pushed.setting.scene, who)
    assert course is not None
    times, differing = found.lift.knot_times, 0.0
    for instant, motion in zip(course.instants(times), course.motions(times), strict=True):
        assert [*instant.disturbed] == [each.name for each in EVERY]
        for disturbance in EVERY:
            posture = instant.disturbed[disturbance.name][who]
            push = np.array(disturbance.push_on(PushedAt(who))) * np.diag(agent.turn)
            root, torques = asked(pushed, who, posture, motion.agents[who], push)
            assert root == pytest.approx(0.0, abs=1e-5)
            assert torques == pytest.approx(posture.torques, abs=1e-5)
            same = instant.postures[who]
            assert posture.joints == same.joints
            differing = max(differing, abs(posture.torque_norm - same.torque_norm))
    assert differing > 0.5


def test_hands_carry_what_a_disturbance_makes_of_the_load(pushed: Lifted, found: LiftSolution) -> None:
    course, scene = found.course, pushed.setting.scene
    assert course is not None
    times = found.lift.knot_times
    for instant, motion in zip(course.instants(times), course.motions(times), strict=True):
        for disturbance in EVERY:
            mass = scene.payload.mass * (1.0 + disturbance.mass_share)
            force = np.array([0.0, 0.0, -mass * (GRAVITY + motion.load_acceleration)])
            force += disturbance.push_on(PushedAt.LOAD)
            for agent in scene.agents:
                wrenches = instant.disturbed[disturbance.name][agent.name].wrenches
                turned = np.diag(agent.turn)
                force -= sum(turned * wrenches[f"{side}_hand"][:3] for side in SIDES)
            assert force == pytest.approx(0.0, abs=1e-5)


def test_a_check_sees_a_wrong_torque_under_a_disturbance(pushed: Lifted, found: LiftSolution) -> None:
    course, scene = found.course, pushed.setting.scene
    assert course is not None
    models = (pushed.robot, pushed.human)
    checker = LiftChecker(scene, *models, Checker(scene, *models))
    assert checker.check(course).wrong == ""
    robot = dict(course.disturbed[HEAVIER.name]["robot"])
    robot["torques"] = robot["torques"] + 0.01
    wrong = {**course.disturbed, HEAVIER.name: {**course.disturbed[HEAVIER.name], "robot": robot}}
    assert "heavier: robot.torque" in checker.check(replace(course, disturbed=wrong)).wrong


def test_json_has_the_torques_under_each_disturbance(found: LiftSolution) -> None:
    (lift,) = lift_json({("", ""): found})["lifts"]
    for name in (each.name for each in EVERY):
        for agent, effort in found.efforts.items():
            assert lift["agents"][agent]["disturbed_torque_norms"][name] == effort.disturbed[name].tolist()


@pytest.mark.parametrize("effort", OverCases)
def test_a_disturbance_of_nothing_changes_nothing(lifted: Lifted, effort: OverCases) -> None:
    """From the motion that is found without it: the same cost, and the same torques in both load cases."""
    hold, mass, programs = lifted.hold(LIFT.from_m).postures, lifted.setting.scene.payload.mass, []
    for each in (lifted, under(lifted, Disturbance("nothing"), effort=effort)):
        blocks = KnotBlocks(symmetric_forms(each.setting.scene), each.setting)
        options = replace(each.setting.options, tolerance=1e-9, near=each is not lifted)
        programs.append(LiftProgram(blocks, LIFT.knots, options))
    without, start = (program.followed(LIFT, hold, 0, lifted.design) for program in programs)
    before, _ = programs[0].solve(LIFT, without, lifted.design, mass)
    motion, symbols = LIFT.knots * (int(blocks.free.sum()) + 1), start.symbols.copy()
    symbols[:motion], symbols[-6:] = before.symbols[:motion], before.symbols[-6:]  # places of the soles
    after, _ = programs[1].solve(LIFT, replace(start, symbols=symbols), lifted.design, mass)
    assert before.word == after.word == "Solve_Succeeded"
    assert after.cost == pytest.approx(before.cost, rel=1e-6)
    course, known = programs[1].course(LIFT, after.symbols), programs[0].course(LIFT, before.symbols)
    for carried in (course.carried, course.disturbed["nothing"]):
        for name in ("robot", "human"):
            assert carried[name]["torques"] == pytest.approx(known.carried[name]["torques"], abs=0.02)


def test_where_the_worst_counts_it_is_less_than_where_the_mean_does(lifted: Lifted) -> None:
    """The mean over the knots of the largest weighted squared torques of any load case."""
    largest, lift = {}, msgspec.structs.replace(LIFT, knots=6)
    for effort in OverCases:
        solution = under(lifted, AWAY, effort=effort).solve(lift)
        assert solution.course is not None
        instants = solution.course.instants(lift.knot_times)
        largest[effort] = np.trapezoid(
            [
                max(
                    sum(agent.torque_norm**2 for agent in load_case.values())
                    for load_case in (instant.postures, *instant.disturbed.values())
                )
                for instant in instants
            ]
        )
    assert largest[OverCases.WORST] < largest[OverCases.MEAN]


def test_disturbed_torques_move_with_the_design_as_solves_of_neighbours_do(lifted: Lifted) -> None:
    """Those of one joint in two load cases, against five-point differences of exact solves."""
    pushed = under(lifted, AWAY, HEAVIER)
    lift, mass = msgspec.structs.replace(LIFT, knots=6), pushed.setting.scene.payload.mass
    blocks = KnotBlocks(symmetric_forms(pushed.setting.scene), pushed.setting)
    program = LiftProgram(blocks, 6, replace(pushed.setting.options, tolerance=1e-10))
    at, hold = np.array(pushed.design), pushed.hold(lift.to_m)
    start = program.followed(lift, hold.postures, lift.knots - 1, pushed.design, hold.disturbed)
    ending, _ = program.solve(lift, start, pushed.design, mass)
    slopes = program.slopes(lift, start, ending, pushed.design, mass)
    assert isinstance(slopes, np.ndarray)

    def instants_of(symbols: NDArray[np.float64]) -> tuple:
        return program.course(lift, symbols).instants(lift.result_times)

    derivative = LiftDerivative(
        instants_of, ending.symbols, slopes, ending.cost, ending.cost_slope[: len(at)]
    )
    near, step = replace(start, symbols=ending.symbols), 1e-4
    direction = np.random.default_rng(5).standard_normal(len(at)) * at
    ends = [program.solve(lift, near, at + k * step * direction, mass)[0] for k in (-2, -1, 1, 2)]
    weights = {"robot": {"l_knee": 1.0}, "human": {}}
    for load_case, name in ((1, AWAY.name), (2, HEAVIER.name)):
        torques = [
            instants_of(each.symbols)[5].disturbed[name]["robot"].torques["l_knee"]
            for each in (*ends[:2], ending, *ends[2:])
        ]
        exact = derivative.along_torques(5, load_case, weights) @ direction
        assert exact == pytest.approx(five_point(torques, step), rel=1e-3)
