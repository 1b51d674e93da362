"""A lift of the default robot and person, against holds, differences and the laws of mechanics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import msgspec
import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.evaluation.sensitivities import five_point
from evodesign.mechanics.agent import SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.motion.instant import KnotBlocks
from evodesign.motion.lift_check import LiftChecker
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.program import ConstraintBlock
from evodesign.nlp.solver import Solver
from evodesign.posture.check import Checker
from evodesign.posture.formulations.joint import posture_program
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form, symmetric_forms
from evodesign.posture.warm_start import start_from
from evodesign.records import Status
from evodesign.tasks.lift import LoadProfile
from evodesign.tree.frames import link_frames
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.mjcf_write import mjcf_text
from tests.motion.lifted import LIFT, Lifted

pytestmark = pytest.mark.slow


def test_a_lift_is_found_and_obeys_inverse_dynamics(solution: LiftSolution) -> None:
    assert (solution.status, solution.reason) == (Status.SOLVED, "solved")
    assert solution.checked is not None
    assert max(solution.checked.knots.values()) < 1e-5
    peak = max(effort.peak_torque for effort in solution.efforts.values())
    assert max(solution.checked.between[f"{name}.torque"] for name in solution.efforts) < 0.03 * peak


def test_the_work_of_the_joints_is_the_energy_gained(solution: LiftSolution) -> None:
    assert solution.checked is not None
    assert solution.checked.energy > 9.0  # the load's alone is 9.81
    assert solution.checked.energy_error < 1e-3


def test_a_check_sees_a_wrong_torque_and_a_moved_foot(lifted: Lifted, solution: LiftSolution) -> None:
    course, scene = solution.course, lifted.setting.scene
    assert course is not None
    models = (lifted.robot, lifted.human)
    checker = LiftChecker(scene, *models, Checker(scene, *models))
    robot = dict(course.carried["robot"])
    robot["torques"] = robot["torques"] + 0.01
    assert "torque" in checker.check(replace(course, carried={**course.carried, "robot": robot})).wrong
    slid = {part: values.copy() for part, values in course.coefficients["robot"].items()}
    slid["base_position"][:, 0] += np.linspace(0.0, 0.01, LIFT.knots)
    moved = checker.check(replace(course, coefficients={**course.coefficients, "robot": slid}))
    assert moved.knots["robot.slip"] > 1e-3


def test_a_slow_lift_is_a_row_of_holds_in_one_stance(lifted: Lifted) -> None:
    """And the lift in which inertia does not count is the same."""
    lift = msgspec.structs.replace(LIFT, seconds=100.0, knots=5)
    found = lifted.solve(lift)
    assert found.course is not None
    forms, times = symmetric_forms(lifted.setting.scene), lift.knot_times
    heights = found.course.heights(times)
    for number in (0, 2, 4):
        instant = found.course.instants(times)[number]
        program = posture_program(forms, lifted.setting)
        stand = [_standing(form, program.variables, instant.postures[form.agent.name]) for form in forms]
        program = replace(program, constraints=(*program.constraints, *stand))
        mass = lifted.setting.scene.payload.mass
        given = {"design": lifted.design, "height": float(heights[number]), "mass": mass}
        raw = Solver(program, SolverOptions()).solve(given, start_from(program, forms, [instant]))
        assert raw.status is Status.SOLVED
        for form in forms:
            name = form.agent.name
            held = form.whole_joints(raw.values[f"{name}.torques"])
            norm = float(np.linalg.norm(list(held.values())))
            assert instant.postures[name].torque_norm == pytest.approx(norm, rel=2e-3)
    for effort in found.efforts.values():
        assert effort.static_share == pytest.approx(1.0, abs=1e-3)


def test_a_very_slow_lift_is_the_one_without_inertia(lifted: Lifted) -> None:
    """From the same start; torques at every knot, and the cost."""
    quick, slow = (
        msgspec.structs.replace(LIFT, knots=6),
        msgspec.structs.replace(LIFT, knots=6, seconds=100.0),
    )
    program = LiftProgram(_blocks(lifted), 6, replace(lifted.setting.options, tolerance=1e-9))
    start = program.followed(quick, lifted.hold(LIFT.from_m).postures, 0, lifted.design)
    mass = lifted.setting.scene.payload.mass
    standing, _ = program.solve(quick, start, lifted.design, mass, 0.0)
    creeping, _ = program.solve(slow, start, lifted.design, mass)
    moving, _ = program.solve(quick, start, lifted.design, mass)
    assert creeping.cost == pytest.approx(standing.cost, rel=1e-3)
    assert abs(moving.cost / standing.cost - 1.0) > 1e-2
    torques = [
        np.hstack([each["torques"] for each in program.course(lift, ending.symbols).carried.values()])
        for lift, ending in ((quick, standing), (slow, creeping))
    ]
    assert np.abs(torques[0] - torques[1]).max() < 1e-3 * np.abs(torques[0]).max()


def test_twice_the_knots_cost_the_same(lifted: Lifted) -> None:
    mass, costs = lifted.setting.scene.payload.mass, []
    hold = lifted.hold(LIFT.from_m).postures
    for knots in (12, 24):
        lift = msgspec.structs.replace(LIFT, knots=knots)
        program = LiftProgram(_blocks(lifted), knots, replace(lifted.setting.options, tolerance=1e-7))
        ending, _ = program.solve(lift, program.followed(lift, hold, 0, lifted.design), lifted.design, mass)
        assert ending.word == "Solve_Succeeded"
        costs.append(ending.cost)
    assert costs[1] == pytest.approx(costs[0], rel=1e-2)


def test_both_methods_find_the_same_lift(lifted: Lifted) -> None:
    lift, mass, found = msgspec.structs.replace(LIFT, knots=6), lifted.setting.scene.payload.mass, []
    for method in MethodName:
        options = replace(lifted.setting.options, tolerance=1e-9, compiled=method is MethodName.NATIVE)
        program = LiftProgram(_blocks(lifted), lift.knots, replace(options, method=method))
        assert program.method is method
        start = program.followed(lift, lifted.hold(lift.from_m).postures, 0, lifted.design)
        found.append(program.solve(lift, start, lifted.design, mass)[0])
    native, ipopt = found
    assert native.word == ipopt.word == "Solve_Succeeded"
    assert native.cost == pytest.approx(ipopt.cost, rel=1e-6)
    assert native.cost_slope == pytest.approx(ipopt.cost_slope, abs=1e-4 * np.abs(ipopt.cost_slope).max())


def _blocks(lifted: Lifted) -> KnotBlocks:
    return KnotBlocks(symmetric_forms(lifted.setting.scene), lifted.setting)


def _standing(form: Form, variables: Sequence[object], posture: AgentPosture) -> ConstraintBlock:
    """The left sole where it is in a posture."""

    def sole(base: Pose, joints: dict[str, object]) -> ca.SX:
        pose = forward(form.agent.tree, base, joints)[form.agent.frame("left_foot")]
        return ca.vertcat(pose.position[:2], pose.rotation[1, 0])

    named = {v.name: v.value for v in variables}  # type: ignore[attr-defined]
    name = form.agent.name
    joints = {joint: named[f"{name}.joints"][place] for place, joint in enumerate(form.joints)}
    base = Pose(euler_rotation(named[f"{name}.base_angles"]), named[f"{name}.base_position"])
    known = Pose(euler_rotation(ca.DM(posture.base_angles)), ca.DM(posture.base_position))
    here = sole(known, dict(posture.joints))
    return ConstraintBlock(f"{name}.stands", sole(base, joints) - here, 0.0, 0.0)


def test_the_cost_changes_with_the_design_as_its_gradient_says(
    lifted: Lifted, solution: LiftSolution
) -> None:
    lift = msgspec.structs.replace(LIFT, knots=5)
    program = LiftProgram(
        KnotBlocks(symmetric_forms(lifted.setting.scene), lifted.setting),
        lift.knots,
        replace(lifted.setting.options, tolerance=1e-10),
    )
    start = program.followed(lift, lifted.hold(lift.from_m).postures, 0, lifted.design)
    mass, design = lifted.setting.scene.payload.mass, np.array(lifted.design)
    ending, _ = program.solve(lift, start, design, mass)
    near = replace(start, symbols=ending.symbols)

    def cost(values: NDArray[np.float64]) -> float:
        return program.solve(lift, near, values, mass)[0].cost

    for place in (1, 10):  # a length and a density
        step = 1e-4 * design[place] * np.eye(len(design))[place]
        slope = (cost(design + step) - cost(design - step)) / (2.0 * step[place])
        assert ending.cost_slope[place] == pytest.approx(slope, rel=1e-4)


def test_a_load_that_goes_as_it_likes_stays_between_its_ends_and_costs_no_more(
    lifted: Lifted, solution: LiftSolution
) -> None:
    free = lifted.solve(msgspec.structs.replace(LIFT, profile=LoadProfile.FREE))
    assert free.course is not None
    heights = free.course.heights(free.times)
    assert heights[[0, -1]] == pytest.approx([LIFT.from_m, LIFT.to_m])
    assert LIFT.from_m - 1e-6 <= heights.min() <= heights.max() <= LIFT.to_m + 1e-6
    cheapest = min(attempt.cost for attempt in solution.attempts)
    assert min(attempt.cost for attempt in free.attempts) < cheapest


@pytest.mark.parametrize(
    ("key", "value"), [("from_m", -1.0), ("to_m", float("nan")), ("seconds", 0.0), ("knots", 3)]
)
def test_what_is_no_lift_is_refused_by_name(key: str, value: float) -> None:
    with pytest.raises(InputError, match=key):
        msgspec.structs.replace(LIFT, **{key: value})


@pytest.mark.parametrize("who", ["robot", "human"])
def test_mujoco_asks_for_the_same_torques(lifted: Lifted, solution: LiftSolution, who: str) -> None:
    course, agent = solution.course, getattr(lifted.setting.scene, who)
    assert course is not None
    model = mujoco.MjModel.from_xml_string(mjcf_text(agent.tree, GRAVITY, {}))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = mujoco.MjData(model)
    times = LIFT.knot_times[1:-1]
    for instant, motion in zip(course.instants(times), course.motions(times), strict=True):
        posture, moving = instant.postures[who], motion.agents[who]
        root = Placement.from_xyz_rpy(posture.base_position.tolist(), posture.base_angles.tolist())
        velocity, acceleration = moving.velocities(posture.base_angles)
        data.qpos[:3] = posture.base_position
        mujoco.mju_mat2Quat(data.qpos[3:7], np.array(root.rotation).ravel())
        data.qvel[:6] = [*moving.rates[:3], *velocity[3:6]]  # the origin in the world, turning in the link
        data.qacc[:6] = [*moving.changes[:3], *acceleration[3:6]]
        for place, name in enumerate(agent.joints, 6):
            joint = model.joint(name)
            data.qpos[joint.qposadr[0]] = posture.joints[name]
            data.qvel[joint.dofadr[0]], data.qacc[joint.dofadr[0]] = (
                moving.rates[place],
                moving.changes[place],
            )
        mujoco.mj_inverse(model, data)
        outside = np.zeros(model.nv)
        frames = link_frames(agent.tree, root, dict(posture.joints))
        for side in SIDES:
            hand, sole = agent.frame(f"{side}_hand"), agent.frame(f"{side}_foot")
            turn = np.array(frames[sole].rotation)
            foot = posture.wrenches[f"{side}_foot"]
            on_foot, on_hand = (
                np.concatenate([turn @ foot[:3], turn @ foot[3:]]),
                posture.wrenches[f"{side}_hand"],
            )
            for frame, wrench in ((hand, on_hand), (sole, on_foot)):
                point, body = np.array(frames[frame].translation), model.body(frame).id
                mujoco.mj_applyFT(model, data, wrench[:3], wrench[3:], point, body, outside)
        torques = data.qfrc_inverse - outside
        asked = [torques[model.joint(name).dofadr[0]] for name in agent.joints]
        assert asked == pytest.approx([posture.torques[name] for name in agent.joints], abs=1e-5)
        assert torques[:6] == pytest.approx(0.0, abs=1e-5)


def test_a_motion_moves_with_the_design_as_solves_of_neighbours_do(lifted: Lifted) -> None:
    """Mean torques along three directions, against five-point differences of exact solves."""
    lift, mass = msgspec.structs.replace(LIFT, knots=6), lifted.setting.scene.payload.mass
    options = replace(lifted.setting.options, tolerance=1e-10)
    program, at = LiftProgram(_blocks(lifted), 6, options), np.array(lifted.design)
    start = program.followed(lift, lifted.hold(lift.to_m).postures, lift.knots - 1, lifted.design)
    ending, _ = program.solve(lift, start, lifted.design, mass)
    slopes = program.slopes(lift, start, ending, lifted.design, mass)
    assert isinstance(slopes, np.ndarray)
    near = replace(start, symbols=ending.symbols)

    def torques(symbols: NDArray[np.float64]) -> NDArray[np.float64]:
        instants = program.course(lift, symbols).instants(lift.result_times)
        return np.array(
            [np.mean([i.postures[name].torque_norm for i in instants]) for name in ("robot", "human")]
        )

    generator = np.random.default_rng(5)
    for _ in range(3):
        direction, step = generator.standard_normal(len(at)) * at, 1e-4
        ends = [program.solve(lift, near, at + k * step * direction, mass)[0] for k in (-2, -1, 1, 2)]
        differences = five_point([torques(e.symbols) for e in (*ends[:2], ending, *ends[2:])], step)
        along = [torques(ending.symbols + k * 1e-4 * slopes @ direction) for k in (-1, 1)]
        found = (along[1] - along[0]) / 2e-4
        assert found == pytest.approx(differences, rel=1e-4, abs=1e-4 * np.abs(differences).max())
