"""What a term of the posture programs is, and what it sees.

A term is one physical statement: the numbers that it asks the solver for, the rows and costs in which it
speaks in a program, and the residuals in which other code, with pinocchio's numbers, finds it violated. It
speaks of one agent with a body (`Body`, `MeasuredBody`), or of robot, person and load together (`Coupled`,
`MeasuredSystem`). What depends on the posture alone is said once per instant; the rest holds anew in every
load case: the undisturbed one, and one for each disturbance.

A new term is a file with a `Term` in it, and a line in `terms/registry.py`.

Beyond 300 lines: a list of what terms are given and what they return, mostly docstrings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.collision.scene_bodies import SceneBodies
from evodesign.mechanics.agent import Agent, Contact
from evodesign.mechanics.balance import AppliedWrench
from evodesign.mechanics.disturbance import Disturbance
from evodesign.mechanics.floating_base import BodyState
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import WRENCH, Form, both_sides
from evodesign.tree.kinematics import Pose
from evodesign.tree.model import Tree

Array = NDArray[np.float64]
Expression = Any

TORQUE_UNIT = 10.0  # [N m] per unit of a lifted torque
FORCE_UNIT = 100.0  # [N] per unit of a foot wrench
HAND_UNIT = 10.0  # [N] per unit of a hand force, [N m] per unit of a hand moment

REGULARISATION = 1e-2
"""Weight of what is slightly disliked beside a lifted torque."""

UNDISTURBED = Disturbance("none")
"""Nothing happens."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A number that bounds rows or numbers of a term from one side, as a user knows it.

    Args:
        name: what is bounded, in words.
        value: SI units; a number, or an expression where a design chooses it.
        unit: of the value: `m`, `rad`, `N`, `N m` or `1`; empty where nobody says.
        at_most: whether it is the most that is allowed; otherwise the least.
        moves: derivative of the row's bound less its expression, by the value: in units of the row's
            expression, or in SI units for numbers that a term asks for. A number or an expression.
        key: where the problem file has it; empty where it has not.
        part: the joints or bodies that it is about; empty where the name says it all.
        agent: whose it is; empty for one of robot, person and load together.
    """

    name: str
    value: Expression
    unit: str
    at_most: bool
    moves: Expression = 1.0
    key: str = ""
    part: str = ""
    agent: str = ""


def both_ways(most: Bound) -> tuple[Bound, Bound]:
    """The bounds of rows from below and above whose size is bounded, from that above."""
    return replace(most, moves=-most.moves), most


@dataclass(frozen=True, slots=True)
class Unknown:
    """Numbers of an agent that a term asks the solver for.

    Args:
        part: what they are called within the agent, such as `joints`.
        lower, upper, start: bounds and starting values, SI units, one per row.
        unit: size of one unit of the solver's symbols, in SI units.
        group: to which the bounds belong.
        posture_only: whether they are the same in all load cases.
        labels: words for the rows.
        drawn: whether random starts draw them from between their bounds.
        least, most: what the bounds are to a user, the same for all rows or one each; left out, they have the
            part's name.
    """

    part: str
    lower: Sequence[float]
    upper: Sequence[float]
    start: Sequence[float]
    unit: float = 1.0
    group: LimitGroup = LimitGroup.ALWAYS
    posture_only: bool = False
    labels: tuple[str, ...] = ()
    drawn: bool = False
    least: tuple[Bound, ...] = ()
    most: tuple[Bound, ...] = ()


@dataclass(frozen=True, slots=True)
class Held:
    """Numbers of an agent's posture that a solve holds as its start has them; zero where it says nothing.

    Args:
        part: what they are called within the agent.
        count: how many.
    """

    part: str
    count: int


@dataclass(frozen=True, slots=True)
class Row:
    """Rows lower <= expression <= upper of a program.

    Args:
        name: what they are called.
        expression: a column.
        lower, upper: limits of every row, in the expression's unit.
        residuals: names of the residuals that find them violated.
        unit: size of one unit of the expression, in SI units.
        group: to which they belong.
        posture_only: whether they are the same in all load cases.
        labels: words for the rows.
        least, most: what the limits are to a user, the same for all rows or one each; left out, they have the
            row's name.
    """

    name: str
    expression: Expression
    lower: float
    upper: float
    residuals: tuple[str, ...]
    unit: float = 1.0
    group: LimitGroup = LimitGroup.ALWAYS
    posture_only: bool = False
    labels: tuple[str, ...] = ()
    least: tuple[Bound, ...] = ()
    most: tuple[Bound, ...] = ()


def bounds_of(bounded: Unknown | Row, agent: str) -> tuple[tuple[Bound, ...], tuple[Bound, ...]]:
    """What bounds an agent's numbers or rows from below and from above; where nobody says, by their name.

    Args:
        bounded: the numbers or rows.
        agent: its name; empty for robot, person and load together.
    """
    if isinstance(bounded, Row):
        name, moves = bounded.name, 1.0 / bounded.unit
        lower, upper = [bounded.lower * bounded.unit], [bounded.upper * bounded.unit]
    else:
        name, moves, lower, upper = bounded.part, 1.0, [*bounded.lower], [*bounded.upper]
    words = name.replace("_", " ")
    least = bounded.least or tuple(Bound(words, value, "", False, moves) for value in lower)
    most = bounded.most or tuple(Bound(words, value, "", True, moves) for value in upper)
    return tuple(replace(x, agent=agent) for x in least), tuple(replace(x, agent=agent) for x in most)


@dataclass(frozen=True, slots=True)
class Residual:
    """By how much a posture violates something.

    Args:
        name: what is violated.
        size: SI units; zero or rounding where it holds.
        unit: of the size.
        words: what is violated, in a sentence.
        group: to which it belongs.
        posture_only: whether it is the same in all load cases.
    """

    name: str
    size: float
    unit: str
    words: str
    group: LimitGroup = LimitGroup.ALWAYS
    posture_only: bool = False

    def named(self, name: str) -> Residual:
        """The same under another name; `dataclasses.replace` would cost 2 ms a design."""
        return Residual(name, self.size, self.unit, self.words, self.group, self.posture_only)


@dataclass(frozen=True)
class Body:
    """An agent with a body at one instant and in one load case: expressions in the agent's own frame.

    The frame looks along +x at the load above its origin, so robot and person share every line, and so do
    whole agents and the halves of symmetric ones.

    Args:
        form: all of the agent, or its left half.
        scene: load, ground and stance, undisturbed.
        load_height: of the load's centre above the ground [m].
        part: links and joints that the form holds, resized by a design.
        doubled: joints of the part whose branch stands for its mirror image too.
        poses: of the part's links.
        values: of the unknowns of all terms, SI units, by part.
        disturbance: of the load case; one of nothing where it is undisturbed.
        inertial: what the links' inertia does to an agent that moves.
        reflected: torque [N m] that turning the rotor of a joint's actuator takes, by joint.
        moving: whether the agent moves with the load, as in a lift.
    """

    form: Form
    scene: Scene
    load_height: Expression
    part: Tree
    doubled: Set[str]
    poses: Mapping[str, Pose]
    values: Mapping[str, Expression]
    disturbance: Disturbance = UNDISTURBED
    inertial: Sequence[AppliedWrench] = ()
    reflected: Mapping[str, Expression] = field(default_factory=dict)
    moving: bool = False

    @property
    def agent(self) -> Agent:
        """The agent as its file describes it."""
        return self.form.agent

    @cached_property
    def hands(self) -> Mapping[str, Expression]:
        """Force [N] and moment about the grasp point [N m] on all hands; the load feels their negative."""
        return all_hands(self.agent.hands, {hand.name: self.values[hand.name] for hand in self.form.hands})

    @cached_property
    def feet(self) -> Mapping[str, Expression]:
        """Force [N] and moment [N m] on each of the form's feet, in the sole frame."""
        return {foot.name: self.values[foot.name] for foot in self.form.feet}


def hand_wrench(free: Expression) -> Expression:
    """Six rows from the free numbers of a grasp: a point grasp passes no moment."""
    return ca.vertcat(free, ca.DM.zeros(6 - free.numel()))


def all_hands(hands: Iterable[Contact], free: Mapping[str, Expression]) -> Mapping[str, Expression]:
    """Wrenches on all of an agent's hands, by name, from the free numbers of those that mirror no other."""
    return both_sides(hands, {name: hand_wrench(numbers) for name, numbers in free.items()}, ca.DM(WRENCH))


@dataclass(frozen=True, slots=True)
class Coupled:
    """Robot, person and load together, at one instant and in one load case.

    Args:
        scene: agents, load, ground and stance, undisturbed.
        bodies: agents that have one, by name.
        hands: force [N] and moment [N m] on all hands, by the names of agent and contact, in the agents'
            frames.
        symmetric: whether right hands mirror left ones.
        disturbance: of the load case.
        load_acceleration: of the load, upwards [m/s^2].
    """

    scene: Scene
    bodies: Mapping[str, Body]
    hands: Mapping[str, Mapping[str, Expression]]
    symmetric: bool
    disturbance: Disturbance
    load_acceleration: Expression = 0.0


@dataclass(frozen=True, slots=True)
class MeasuredBody:
    """An agent in a posture as pinocchio sees it, in the agent's own frame.

    Args:
        agent: whose posture it is.
        posture: with what is carried in the load case.
        undisturbed: with what is carried where nothing happens.
        state: kinematics, Jacobians and gravity torques.
        scene: load, ground and stance, undisturbed.
        load_height: of the load's centre [m].
        disturbance: of the load case.
    """

    agent: Agent
    posture: AgentPosture
    undisturbed: AgentPosture
    state: BodyState
    scene: Scene
    load_height: float
    disturbance: Disturbance

    @property
    def disturbed(self) -> bool:
        """Whether something happens."""
        return self.disturbance is not UNDISTURBED


@dataclass(frozen=True, slots=True)
class MeasuredSystem:
    """Robot, person and load in a posture.

    Args:
        scene: agents, ground and stance.
        payload: as the disturbance makes it.
        bodies: both agents, by name.
        disturbance: of the load case.
        solids: their bodies; None where they may pass through anything.
        load_acceleration: of the load, upwards [m/s^2].
    """

    scene: Scene
    payload: Payload
    bodies: Mapping[str, MeasuredBody]
    disturbance: Disturbance
    solids: SceneBodies | None
    load_acceleration: float = 0.0


def no_unknowns(form: Form, scene: Scene) -> Iterable[Unknown]:
    """No numbers are asked for."""
    return ()


def nothing_held(form: Form, scene: Scene) -> Iterable[Held]:
    """Nothing is held."""
    return ()


def nothing(seen: Any) -> Iterable[Any]:
    """Neither rows nor residuals."""
    return ()


def no_cost(seen: Any) -> Expression | None:
    """Nothing is disliked."""
    return None


@dataclass(frozen=True, slots=True)
class BodyTerm:
    """A statement about each agent that has a body.

    Args:
        name: unique among terms.
        group: to which its cost belongs.
        unknowns: numbers that it asks for, of a form in a scene.
        held: numbers that it holds during a solve.
        rows: in a program.
        posture_cost: a cost that depends on the posture alone, beside |tau|^2 / TORQUE_UNIT^2; or None.
        cost: one that every load case has; or None.
        residuals: of a posture.
    """

    name: str
    group: LimitGroup = LimitGroup.ALWAYS
    unknowns: Callable[[Form, Scene], Iterable[Unknown]] = field(default=no_unknowns)
    held: Callable[[Form, Scene], Iterable[Held]] = field(default=nothing_held)
    rows: Callable[[Body], Iterable[Row]] = field(default=nothing)
    posture_cost: Callable[[Body], Expression | None] = field(default=no_cost)
    cost: Callable[[Body], Expression | None] = field(default=no_cost)
    residuals: Callable[[MeasuredBody], Iterable[Residual]] = field(default=nothing)


@dataclass(frozen=True, slots=True)
class SystemTerm:
    """A statement about robot, person and load together; the fields are those of `BodyTerm`."""

    name: str
    group: LimitGroup = LimitGroup.ALWAYS
    rows: Callable[[Coupled], Iterable[Row]] = field(default=nothing)
    posture_cost: Callable[[Coupled], Expression | None] = field(default=no_cost)
    cost: Callable[[Coupled], Expression | None] = field(default=no_cost)
    residuals: Callable[[MeasuredSystem], Iterable[Residual]] = field(default=nothing)
