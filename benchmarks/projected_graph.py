"""The paper's torques and wrenches as a graph that a solver can differentiate.

    N = 1 - Q^T (Q M^-1 Q^T)^-1 Q M^-1                         projector (Eq. 11)
    tau = ((N B)^T N B + damping)^-1 (N B)^T N h               torques at rest (Eq. 12, normal equations)
    f = (Q M^-1 Q^T)^-1 Q M^-1 (h - B tau)                     wrenches (Eq. 13)

M, h and Q of each body are flat SX functions of its posture (and of the design); the linear algebra above is
MX, with dense LU factorisations that CasADi differentiates. M is block diagonal, so M^-1 Q^T is found body by
body. Rows and columns are those of `evodesign.mechanics.coupled`.

Source: Sartore et al. 2022, Eq. 5 to 13.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.balance import AppliedWrench, cut
from evodesign.mechanics.coupled import PAYLOAD
from evodesign.mechanics.dynamics import mass_matrix
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.terms.base import hand_wrench
from evodesign.posture.terms.grasp import GRASP_ROWS
from evodesign.tree.kinematics import Pose, euler_rotation, forward, vector
from evodesign.tree.model import Link, Tree

Expression = Any

DAMPING = 1e-6
"""Added to the diagonal of the normal equations, whose rank is 40 of 58 in the point-grasp problem.

At nine solved postures torques were within 1e-5 N m of Eq. 12; with 1e-10 they were 6e-3 N m off, with 1e-12
0.7 N m. The singular values of N B that count lie between 0.5 and 50 there; the others are rounding, which
less damping lets in.
"""

ROTOR = 1e-4
"""Added to the diagonal of M [kg, kg m^2]: where a person's massless links lock, M is singular, and a solver
may pass such postures. Torques and wrenches at rest do not depend on M."""

FOOT_ROWS = 6
ROOT_ROWS = 6
LINEAR_SOLVER = "lapacklu"


@dataclass(frozen=True, slots=True)
class Statics:
    """What holds the system still.

    Args:
        torques: of the robot's joints, then the person's [N m].
        wrenches: of all contacts [N, N m]: each agent's feet, then its hands, robot first.
    """

    torques: Expression
    wrenches: Expression

    def feet(self, place: int) -> Expression:
        """Both feet's wrenches of the agent at a place (0 or 1), left then right."""
        return self._own(place)[: len(SIDES) * FOOT_ROWS]

    def hands(self, place: int) -> dict[str, Expression]:
        """Wrenches on the hands of the agent at a place, by side."""
        both = self._own(place)[len(SIDES) * FOOT_ROWS :]
        each = both.shape[0] // len(SIDES)
        return {side: both[row * each : (row + 1) * each] for row, side in enumerate(SIDES)}

    def _own(self, place: int) -> Expression:
        half = self.wrenches.shape[0] // 2
        return self.wrenches[place * half : (place + 1) * half]


@dataclass(frozen=True, slots=True)
class _Body:
    """M, h and Q^T of one body; the columns of Q^T are those of the contacts that it feels."""

    mass: Expression
    bias: Expression
    coupling: Expression


def agent_matrices(agent: Agent, tree: Tree, scene: Scene, design: Expression) -> Any:
    """The function from an agent's posture and the design to its M, h and Q^T.

    A posture is the base's position [m] and angles [rad], then the joints [rad].

    Args:
        agent: robot or person.
        tree: resized by the design, if it is the robot.
        scene: says what hands pass.
        design: the symbols of which the tree is made.
    """
    posture = ca.SX.sym("posture", ROOT_ROWS + len(agent.joints))
    base = Pose(euler_rotation(posture[3:6]), posture[:3])
    positions = {name: posture[ROOT_ROWS + row] for row, name in enumerate(agent.joints)}
    poses = forward(tree, base, positions)
    free, rows = ca.SX.sym("f", sum(_rows(scene))), _rows(scene)
    blocks = ca.vertsplit(free, [0, *(sum(rows[: end + 1]) for end in range(len(rows)))])
    applied = []
    for side, wrench in zip(SIDES, blocks[:2], strict=True):
        sole = poses[agent.frame(f"{side}_foot")]
        parts = (sole.rotation @ wrench[:3], sole.rotation @ wrench[3:])
        applied.append(AppliedWrench(agent.frame(f"{side}_foot"), sole.position, *parts))
    for side, wrench in zip(SIDES, blocks[2:], strict=True):
        six = hand_wrench(wrench)
        frame = agent.frame(f"{side}_hand")
        applied.append(AppliedWrench(frame, poses[frame].position, six[:3], six[3:]))
    needed = _needed(tree, agent.joints, base, poses, applied)
    mass = mass_matrix(tree, agent.joints, positions)
    matrices = [mass, *_split(needed, free)]
    return ca.Function(agent.name, [posture, design], ca.cse(matrices))


def _rows(scene: Scene) -> tuple[int, ...]:
    """Rows of an agent's contacts in f: feet, then hands."""
    hand = GRASP_ROWS[scene.payload.grasp]
    return (FOOT_ROWS, FOOT_ROWS, hand, hand)


def _needed(
    tree: Tree,
    joints: Sequence[str],
    base: Pose,
    poses: Mapping[str, Pose],
    applied: Sequence[AppliedWrench],
) -> Expression:
    """Rows h - Q^T f, from the cut statics: base rows in the root's axes, then the joints."""
    balance = cut(tree, poses, applied)
    root = [-base.rotation.T @ balance.force, -base.rotation.T @ balance.moment]
    return ca.vertcat(*root, *[balance.torques[name] for name in joints])


def _split(needed: Expression, free: Expression) -> tuple[Expression, Expression]:
    """From rows h - Q^T f: h and Q^T."""
    return ca.substitute(needed, free, ca.DM.zeros(free.numel())), -ca.jacobian(needed, free)


def _load(scene: Scene) -> _Body:
    """The level load's M, h and Q^T (columns: the robot's hands, then the person's), as numbers."""
    payload, hand = scene.payload, GRASP_ROWS[scene.payload.grasp]
    tree = Tree(PAYLOAD, (Link(PAYLOAD, own_inertia=payload.inertia),), ())
    pose = Pose(ca.DM.eye(3), ca.DM.zeros(3))
    free = ca.SX.sym("f", 2 * len(SIDES) * hand)
    places = [(agent, side) for agent in scene.agents for side in SIDES]
    applied = [
        _on_load(payload, agent, side, hand_wrench(wrench))
        for (agent, side), wrench in zip(places, ca.vertsplit(free, hand), strict=True)
    ]
    needed = _needed(tree, (), pose, {PAYLOAD: pose}, applied)
    numbers = [ca.evalf(ca.SX(part)) for part in _split(needed, free)]
    return _Body(ca.evalf(ca.SX(mass_matrix(tree, (), {}))), *numbers)


def _on_load(payload: Payload, agent: Agent, side: str, wrench: Expression) -> AppliedWrench:
    """The reaction to a hand's wrench, in the world."""
    turn = ca.DM(agent.turn)
    point = turn @ vector(payload.grasp_point(agent, next(each for each in agent.hands if each.side == side)))
    return AppliedWrench(PAYLOAD, point, -turn @ wrench[:3], -turn @ wrench[3:])


def projected_statics(
    scene: Scene, agents: Sequence[Any], postures: Sequence[Expression], design: Expression, damping: float
) -> Statics:
    """Torques of Eq. 12 and wrenches of Eq. 13 of the coupled system.

    Args:
        scene: agents and load.
        agents: the functions of `agent_matrices`, robot first.
        postures: MX columns that they take.
        design: MX column.
        damping: of the normal equations.
    """
    bodies = [_Body(*call(posture, design)) for call, posture in zip(agents, postures, strict=True)]
    feet, hands = len(SIDES) * FOOT_ROWS, len(SIDES) * GRASP_ROWS[scene.payload.grasp]
    load = _load(scene)
    own = feet + hands
    columns = [(0, own), (own, 2 * own)]
    gap = ca.DM(ROOT_ROWS, feet)
    everywhere = [
        *(_padded(body.coupling, first, 2 * own) for body, (first, _) in zip(bodies, columns, strict=True)),
        ca.horzcat(gap, load.coupling[:, :hands], gap, load.coupling[:, hands:]),
    ]
    bodies.append(load)
    transposed = ca.densify(ca.vertcat(*everywhere))  # Q^T
    moved = ca.vertcat(  # M^-1 Q^T
        *[
            _solved(body.mass + ROTOR * ca.DM.eye(body.mass.shape[0]), rows)
            for body, rows in zip(bodies, everywhere, strict=True)
        ]
    )
    bias = ca.vertcat(*[body.bias for body in bodies])
    selector = ca.diagcat(*[_selector(body) for body in bodies])
    felt = transposed.T @ moved  # Q M^-1 Q^T
    carried = _solved(felt, moved.T @ ca.horzcat(selector, bias))
    projected = ca.horzcat(selector, bias) - transposed @ carried  # N B and N h
    count = selector.shape[1]
    projected_selector, projected_bias = projected[:, :count], projected[:, count]
    normal = projected_selector.T @ projected_selector + damping * ca.DM.eye(count)
    torques = _solved(normal, projected_selector.T @ projected_bias)
    return Statics(torques, _solved(felt, moved.T @ (bias - selector @ torques)))


def _selector(body: _Body) -> Expression:
    """A body's part of B: nothing on the root, one torque on each joint."""
    joints = body.bias.numel() - ROOT_ROWS
    return ca.vertcat(ca.DM(ROOT_ROWS, joints), ca.DM.eye(joints))


def _padded(coupling: Expression, first: int, width: int) -> Expression:
    """Q^T of one agent among the columns of all contacts."""
    rows, own = coupling.shape
    return ca.horzcat(ca.DM(rows, first), coupling, ca.DM(rows, width - first - own))


def _solved(matrix: Expression, right: Expression) -> Expression:
    if isinstance(matrix, ca.DM):
        return ca.solve(matrix, ca.densify(right))
    return ca.solve(ca.densify(matrix), ca.densify(right), LINEAR_SOLVER)
