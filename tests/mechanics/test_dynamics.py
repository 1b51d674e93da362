"""Mass matrix and bias of moving trees: by hand, by energy, by statics, and against pinocchio."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.mechanics.balance import GRAVITY, cut
from evodesign.mechanics.dynamics import ROOT_ROWS, bias, inverse_dynamics, mass_matrix
from evodesign.problem.build import DesignProblem
from evodesign.tree.kinematics import Pose, euler_rotation, forward, vector
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_write import urdf_text
from tests.oracles.published import published_robots
from tests.tree.crane import crane

CASES = 30
RELATIVE = 1e-10
WEIGHT = ca.DM([0.0, 0.0, -GRAVITY])
angles = st.floats(-3.0, 3.0)
speeds = st.floats(-5.0, 5.0)


@dataclass(frozen=True)
class Case:
    """A tree of numbers in random motion; velocity and acceleration as in `dynamics`."""

    tree: Tree
    angles: np.ndarray
    joints: dict[str, float]
    velocity: np.ndarray
    acceleration: np.ndarray

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.joints)

    @property
    def gravity(self) -> ca.DM:
        return euler_rotation(ca.DM(self.angles)).T @ WEIGHT

    def mass(self) -> np.ndarray:
        return np.array(mass_matrix(self.tree, self.names, self.joints))

    def bias(self, velocity: np.ndarray) -> np.ndarray:
        column = bias(self.tree, self.names, self.joints, ca.DM(velocity), self.gravity)
        return np.array(column).ravel()


def moving(tree: Tree, rng: np.random.Generator) -> Case:
    joints = {
        name: rng.uniform(max(tree.joint_by_name[name].lower, -3.0), min(tree.joint_by_name[name].upper, 3.0))
        for name in rng.permutation(tree.actuated).tolist()
    }
    size = ROOT_ROWS + len(joints)
    return Case(tree, rng.uniform(-1.4, 1.4, 3), joints, rng.normal(size=size), rng.normal(size=size))


def robots(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(11)
    for _ in range(CASES):
        values = problem.space.values(tuple(rng.uniform(size=len(problem.space.parameters))))
        yield moving(problem.space.resized(problem.scene.robot.tree, values), rng)


def persons(_: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(12)
    for number in range(CASES):
        person = Person(rng.uniform(1.45, 2.05), rng.uniform(40.0, 140.0), list(Sex)[number % 2])
        yield moving(human_tree(person), rng)


def cranes(_: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(13)
    for _ in range(CASES):
        yield moving(crane(), rng)


def published(problem: DesignProblem) -> Iterator[Case]:
    rng = np.random.default_rng(14)
    for tree in published_robots(problem, rng, CASES):
        yield moving(tree, rng)


ALL = pytest.mark.parametrize("cases", [robots, persons, cranes, published])


def in_pinocchio(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Mass matrix and bias, rows in the case's order."""
    model = pin.buildModelFromXML(urdf_text(case.tree), pin.JointModelFreeFlyer())
    model.gravity.linear = np.array([0.0, 0.0, -GRAVITY])
    q, velocity, order = pin.neutral(model), np.zeros(model.nv), list(range(ROOT_ROWS))
    q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(*case.angles)).coeffs()
    for name, position in case.joints.items():
        joint = model.joints[model.getJointId(name)]
        order.append(joint.idx_v)
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = math.cos(position), math.sin(position)
        else:
            q[joint.idx_q] = position
    velocity[order] = case.velocity
    mass = pin.crba(model, model.createData(), q)[np.ix_(order, order)]
    return mass, pin.nonLinearEffects(model, model.createData(), q, velocity)[order]


@pytest.mark.slow
@ALL
def test_mass_matrix_and_bias_are_pinocchios(cases, problem: DesignProblem) -> None:
    for case in cases(problem):
        mass, forces = in_pinocchio(case)
        unit = np.sqrt(np.outer(np.diag(mass), np.diag(mass)))
        assert np.all(np.abs(case.mass() - mass) <= RELATIVE * unit)
        assert np.allclose(case.bias(case.velocity), forces, rtol=0.0, atol=RELATIVE * np.abs(forces).max())


@ALL
def test_at_rest_the_bias_is_what_statics_finds(cases, problem: DesignProblem) -> None:
    for case in islice(cases(problem), 10):
        base = Pose(euler_rotation(ca.DM(case.angles)), ca.DM([0.3, -0.2, 0.9]))
        balance = cut(case.tree, forward(case.tree, base, case.joints), [])
        held = [balance.torques[name] for name in case.names]
        root = (-base.rotation.T @ balance.force, -base.rotation.T @ balance.moment)
        expected = np.array(ca.vertcat(*root, *held)).ravel()
        found = case.bias(np.zeros_like(case.velocity))
        assert np.allclose(found, expected, rtol=0.0, atol=RELATIVE * np.abs(expected).max())


def test_inverse_dynamics_is_mass_times_acceleration_and_bias(problem: DesignProblem) -> None:
    """The mass matrix comes from composite bodies, inverse dynamics from link to link."""
    for case in [next(robots(problem)), next(persons(problem)), next(cranes(problem))]:
        moved = ca.DM(case.velocity), ca.DM(case.acceleration)
        forces = inverse_dynamics(case.tree, case.names, case.joints, *moved, case.gravity)
        expected = case.mass() @ case.acceleration + case.bias(case.velocity)
        assert np.allclose(np.array(forces).ravel(), expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


def test_welded_joints_leave_the_rows_of_the_others(problem: DesignProblem) -> None:
    case = next(robots(problem))
    kept = case.names[::2]
    rows = [*range(ROOT_ROWS), *(ROOT_ROWS + case.names.index(name) for name in kept)]
    velocity = np.zeros_like(case.velocity)
    velocity[rows] = case.velocity[rows]
    welded = bias(case.tree, kept, case.joints, ca.DM(velocity[rows]), case.gravity)
    assert np.allclose(np.array(welded).ravel(), case.bias(velocity)[rows], rtol=0.0, atol=1e-11)
    mass = np.array(mass_matrix(case.tree, kept, case.joints))
    assert np.array_equal(mass, case.mass()[np.ix_(rows, rows)])


def test_one_graph_serves_every_design(problem: DesignProblem) -> None:
    tree, space = problem.scene.robot.tree, problem.space
    names = problem.scene.robot.joints
    design, q = ca.SX.sym("design", len(space.parameters)), ca.SX.sym("q", len(names))
    nu, gravity = ca.SX.sym("nu", ROOT_ROWS + len(names)), ca.SX.sym("gravity", 3)
    resized = space.resized(tree, ca.vertsplit(design))
    positions = dict(zip(names, ca.vertsplit(q), strict=True))
    outputs = [mass_matrix(resized, names, positions), bias(resized, names, positions, nu, gravity)]
    graph = ca.Function("dynamics", [design, q, nu, gravity], outputs)
    rng = np.random.default_rng(14)
    for _ in range(3):
        values = space.values(tuple(rng.uniform(size=len(space.parameters))))
        numbers, joints = space.resized(tree, values), dict(zip(names, rng.normal(size=25), strict=True))
        velocity = ca.DM(rng.normal(size=31))
        expected = mass_matrix(numbers, names, joints), bias(numbers, names, joints, velocity, WEIGHT)
        for found, wanted in zip(
            graph(values, list(joints.values()), velocity, WEIGHT), expected, strict=True
        ):
            scale = float(ca.norm_inf(wanted))
            assert float(ca.norm_inf(found - wanted)) <= 1e-13 * scale


class Energy:
    """Kinetic and potential energy of a tree from the rates of its poses alone: no line of `dynamics`.

    T = sum m |dc/dt|^2 / 2 + w . I w / 2,    S(w) = dR/dt R^T        V = sum m g c_z
    """

    def __init__(self, tree: Tree, names: tuple[str, ...]) -> None:
        self._tree, self._names = tree, names
        state = [ca.SX.sym("R", 3, 3), ca.SX.sym("p", 3), ca.SX.sym("q", len(names))]
        nu, t = ca.SX.sym("nu", ROOT_ROWS + len(names)), ca.SX.sym("t")
        kinetic, potential = self._of(*self.later(*state, nu, t), t)
        at_once = ca.Function("energy", [*state, nu, t], [kinetic, potential])
        rate = ca.SX.sym("rate", nu.numel())
        total = sum(at_once(*self.later(*state, nu, t), nu + t * rate, 0.0))
        self.kinetic = ca.Function("kinetic", [*state, nu], [at_once(*state, nu, 0.0)[0]])
        self._power = ca.Function("power", [*state, nu, rate, t], [ca.jacobian(total, t)])

    def power(self, *motion: np.ndarray) -> float:
        """Rate of T + V [W] at rotation, position, joints, nu and dnu/dt."""
        return float(self._power(*motion, 0.0))

    @staticmethod
    def later(rotation: ca.SX, position: ca.SX, joints: ca.SX, nu: ca.SX, t: ca.SX) -> tuple[ca.SX, ...]:
        """The configuration after a short time, to first order."""
        turned = rotation @ (ca.SX.eye(3) + t * ca.skew(nu[3:6]))
        return turned, position + t * rotation @ nu[:3], joints + t * nu[6:]

    def _of(self, rotation: ca.SX, position: ca.SX, joints: ca.SX, t: ca.SX) -> tuple[ca.SX, ca.SX]:
        positions = dict(zip(self._names, ca.vertsplit(joints), strict=True))
        poses = forward(self._tree, Pose(rotation, position), positions)
        kinetic = potential = ca.SX(0.0)
        for link in self._tree.links:
            inertia, pose = link.inertia, poses[link.name]
            center = pose.point(vector(inertia.center))
            rates = ca.jacobian(ca.vec(pose.rotation), t)
            turning = ca.inv_skew(ca.reshape(rates, 3, 3) @ pose.rotation.T)
            in_link = pose.rotation.T @ turning
            about = ca.DM([list(row) for row in inertia.about_center])
            kinetic += inertia.mass * ca.sumsqr(ca.jacobian(center, t)) / 2.0
            kinetic += ca.dot(in_link, about @ in_link) / 2.0
            potential += inertia.mass * GRAVITY * center[2]
        return kinetic, potential


@ALL
def test_energy_changes_by_the_power_of_the_forces(cases, problem: DesignProblem) -> None:
    """nu . (M dnu/dt + h) is the rate of T + V and nu . M nu / 2 is T; T and V come from kinematics alone."""
    case = next(cases(problem))
    energy = Energy(case.tree, case.names)
    base = np.array(euler_rotation(ca.DM(case.angles))), np.zeros(3), np.array(list(case.joints.values()))
    rng = np.random.default_rng(15)
    for _ in range(3):
        nu, rate = rng.normal(size=(2, len(case.velocity)))
        kinetic = float(energy.kinetic(*base, nu))
        assert kinetic == pytest.approx(nu @ case.mass() @ nu / 2.0, rel=1e-10)
        power = nu @ (case.mass() @ rate + case.bias(nu))
        assert energy.power(*base, nu, rate) == pytest.approx(power, rel=1e-9)


def pendulum(mass: float, length: float) -> Tree:
    """base -> rod turning about y, with a point mass at its end, on z below the joint."""
    rod = Link("rod", own_inertia=Inertia(mass, (0.0, 0.0, -length)))
    hinge = Joint("hinge", JointKind.REVOLUTE, "base", "rod", Placement(), (0.0, 1.0, 0.0), -4.0, 4.0)
    return Tree("pendulum", (Link("base"), rod), (hinge,))


@given(angles, st.floats(0.1, 50.0), st.floats(0.1, 2.0))
def test_a_pendulum_resists_with_m_l_squared(angle: float, mass: float, length: float) -> None:
    matrix = np.array(mass_matrix(pendulum(mass, length), ["hinge"], {"hinge": angle}))
    assert matrix[6, 6] == pytest.approx(mass * length**2)
    pushed = mass * length * np.array([-math.cos(angle), 0.0, math.sin(angle)])
    assert matrix[:3, 6] == pytest.approx(pushed, abs=1e-9)


@given(angles, speeds)
def test_a_governors_weight_is_flung_outwards(angle: float, turning: float) -> None:
    """m l^2 ddphi - m l^2 w^2 sin phi cos phi + m g l sin phi = tau."""
    mass, length = 3.0, 0.4
    nu = ca.DM([0.0, 0.0, 0.0, 0.0, 0.0, turning, 0.0])
    forces = bias(pendulum(mass, length), ["hinge"], {"hinge": angle}, nu, WEIGHT)
    flung = mass * length**2 * turning**2 * math.sin(angle) * math.cos(angle)
    weight = mass * GRAVITY * length * math.sin(angle)
    assert float(forces[6]) == pytest.approx(weight - flung, abs=1e-9)


@given(st.floats(-1.0, 1.0), speeds, speeds)
def test_a_bead_on_a_turning_wire_feels_coriolis(place: float, turning: float, speed: float) -> None:
    """Without gravity: -m w^2 x along the wire, 2 m w s across it, and the moment 2 m w s x on the wire."""
    wire = Joint("wire", JointKind.PRISMATIC, "base", "bead", Placement(), (1.0, 0.0, 0.0), -2.0, 2.0)
    tree = Tree("wire", (Link("base"), Link("bead", own_inertia=Inertia(2.0))), (wire,))
    nu = ca.DM([0.0, 0.0, 0.0, 0.0, 0.0, turning, speed])
    forces = np.array(bias(tree, ["wire"], {"wire": place}, nu, ca.DM.zeros(3))).ravel()
    inward, across = -2.0 * turning**2 * place, 4.0 * turning * speed
    expected = [inward, across, 0.0, 0.0, 0.0, across * place, inward]
    assert forces == pytest.approx(expected, abs=1e-9)


def test_what_is_thrown_needs_no_force() -> None:
    """A free body that moves on at constant world velocity and spins about a principal axis."""
    tree = Tree(
        "ball", (Link("ball", own_inertia=Inertia(2.0, about_center=((1, 0, 0), (0, 2, 0), (0, 0, 3)))),), ()
    )
    nu, spin = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 4.0]), np.array([0.0, 0.0, 4.0])
    in_body = np.concatenate([-np.cross(spin, nu[:3]), np.zeros(3)])
    forces = inverse_dynamics(tree, [], {}, ca.DM(nu), ca.DM(in_body), ca.DM.zeros(3))
    assert np.allclose(np.array(forces).ravel(), 0.0, atol=1e-12)
