"""Assembling a program: parties, terms and a case become variables, rows and costs.

A party is an agent with a body, or a pair of free hands in its place. At each instant of the case every term
speaks of each body, then of the system; in every disturbed load case it says again what does not depend on
the posture alone. Names tell instant, load case, party and part; nothing is ever read from a name: a
variable's key (`Slot`) says where it belongs.

Beyond 300 lines: the parts are one walk over instants, load cases and parties, which share their variables.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import Agent, Contact
from evodesign.mechanics.balance import AppliedWrench
from evodesign.mechanics.disturbance import Disturbance
from evodesign.mechanics.inertial_forces import euler_motion, inertial_wrenches
from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import ConstraintBlock, Expression, Variable
from evodesign.posture.limit_groups import Enforced
from evodesign.posture.parting import PartedBody
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import (
    TORQUE_UNIT,
    UNDISTURBED,
    Body,
    BodyTerm,
    Coupled,
    Row,
    SystemTerm,
    Unknown,
    all_hands,
    bounds_of,
)
from evodesign.posture.terms.collisions import CLEAR, PARTING, directed
from evodesign.posture.terms.grasp import hand_unknowns, moment_cost
from evodesign.posture.terms.torque import effort
from evodesign.tree.equip import actuators_of
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree

EVERYTHING = Enforced()

JOINTS = "joints"
"""The part whose variables are coordinates (`posture.symmetry`), from which joint positions follow."""

MOVING_PARTS = ("base_position", "base_angles", JOINTS)
"""The parts of a posture that move in a motion."""


@dataclass(frozen=True, slots=True)
class Embodied:
    """An agent with a body.

    Args:
        form: all of the agent, or its left half.
        tree: the agent's whole tree, resized by a design; numbers or expressions.
    """

    form: Form
    tree: Tree

    @property
    def name(self) -> str:
        """The agent's."""
        return self.form.agent.name


@dataclass(frozen=True, slots=True)
class FreeHands:
    """An agent reduced to its hands: forces on the load that it may choose freely, with no body behind them.

    Args:
        agent: whose they are.
        free: hands whose wrenches are variables; the others mirror them.
    """

    agent: Agent
    free: tuple[Contact, ...]

    @property
    def name(self) -> str:
        """The agent's."""
        return self.agent.name


Party = Embodied | FreeHands


def free_hands_beside(form: Form, scene: Scene) -> tuple[FreeHands, ...]:
    """The hands of the other agents of a scene, beside an agent of a form; mirrored where it is."""
    return tuple(
        FreeHands(agent, tuple(h for h in agent.hands if form.mirror is None or h.side != "right"))
        for agent in scene.agents
        if agent.name != form.agent.name
    )


@dataclass(frozen=True, slots=True)
class PostureMotion:
    """How an agent moves: time derivatives of the parts of its posture; numbers or expressions.

    Args:
        rates: of `base_position`, `base_angles` and the coordinates of `joints` [m/s, rad/s].
        changes: of these rates [m/s^2, rad/s^2].
    """

    rates: Mapping[str, Expression]
    changes: Mapping[str, Expression]


@dataclass(frozen=True, slots=True)
class CaseSymbols:
    """A case as a program is given it: numbers or expressions.

    Args:
        scene: person, load and disturbances, ground and stance.
        load_heights: of the load's centre at each instant [m].
        motions: how agents move at every instant, by name; those left out stand still.
        load_acceleration: of the load, upwards [m/s^2].
    """

    scene: Scene
    load_heights: tuple[Expression, ...]
    motions: Mapping[str, PostureMotion] = field(default_factory=dict)
    load_acceleration: Expression = 0.0


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a variable belongs.

    Args:
        instant: its number, from zero.
        load_case: zero for the undisturbed one, else one more than the disturbance's number in the scene.
        party: the agent's name.
        part: what the numbers are, such as `joints`.
    """

    instant: int
    load_case: int
    party: str
    part: str


@dataclass(frozen=True, slots=True)
class LoadCase:
    """What is said in one load case.

    Args:
        bodies: by agent name.
        hands: wrenches on all hands, by the names of agent and contact.
        costs: by party, then the system's; without those of the posture alone.
        posture_costs: likewise those that depend on the posture alone; zero in disturbed load cases.
        free_moments: cost of the moments of free hands.
    """

    bodies: Mapping[str, Body]
    hands: Mapping[str, Mapping[str, Expression]]
    costs: Sequence[Expression]
    posture_costs: Sequence[Expression]
    free_moments: Expression

    def effort(self, weights: Mapping[str, Expression]) -> Expression:
        """Weighted squared torques of the agents with a body, in units of TORQUE_UNIT^2."""
        efforts = [weights[name] * effort(body) for name, body in self.bodies.items()]
        return total(efforts) / TORQUE_UNIT**2

    @property
    def regularisation(self) -> list[Expression]:
        """All costs beside the effort, by party, then the system's."""
        pairs = zip(self.posture_costs, self.costs, strict=True)
        return [posture + wrenches for posture, wrenches in pairs]


@dataclass(frozen=True, slots=True)
class Assembly:
    """The parts of a program.

    Args:
        variables, constraints: of all parties and load cases, instant after instant.
        instants: load cases of each instant, the undisturbed one first.
        given: parameters that a solve takes from its start, by name.
        parted: bodies that they part.
    """

    variables: tuple[Variable, ...]
    constraints: tuple[ConstraintBlock, ...]
    instants: tuple[tuple[LoadCase, ...], ...]
    given: Mapping[str, Expression]
    parted: tuple[PartedBody, ...]

    @property
    def undisturbed(self) -> LoadCase:
        """The undisturbed load case of the first instant, which is a hold's only one."""
        return self.instants[0][0]


def total(expressions: Iterable[Expression | None]) -> Expression:
    """The sum of those that there are; zero for none."""
    found: Expression = 0.0
    for expression in expressions:
        found = found if expression is None else found + expression
    return found


def assemble(
    parties: Sequence[Party],
    terms: Iterable[BodyTerm | SystemTerm],
    case: CaseSymbols,
    enforced: Enforced = EVERYTHING,
    *,
    switched: bool = False,
) -> Assembly:
    """Variables, constraints and costs of parties in a case.

    Args:
        parties: robot and person in any order; those with a body come first in the program.
        terms: what is said of them, in order.
        case: numbers or expressions.
        enforced: groups of limits that are left out are left out with their rows, bounds and costs.
        switched: whether rows are there that are left out until they are violated.
    """
    return _Assembler(parties, tuple(terms), case, enforced, switched=switched).assembly()


class _Assembler:
    def __init__(
        self,
        parties: Sequence[Party],
        terms: Sequence[BodyTerm | SystemTerm],
        case: CaseSymbols,
        enforced: Enforced,
        *,
        switched: bool,
    ) -> None:
        self._embodied = [party for party in parties if isinstance(party, Embodied)]
        self._hands = [party for party in parties if isinstance(party, FreeHands)]
        self._body_terms = [term for term in terms if isinstance(term, BodyTerm)]
        self._system_terms = [term for term in terms if isinstance(term, SystemTerm)]
        self._case, self._enforced, self._switched = case, enforced, switched
        self._symmetric = any(party.form.mirror is not None for party in self._embodied)
        self._variables: list[Variable] = []
        self._constraints: list[ConstraintBlock] = []
        self._given: dict[str, Expression] = {}
        self._parted: list[PartedBody] = []

    def assembly(self) -> Assembly:
        instants = tuple(self._instant(number) for number in range(len(self._case.load_heights)))
        bodies = tuple(self._parted)
        return Assembly(tuple(self._variables), tuple(self._constraints), instants, self._given, bodies)

    def _instant(self, number: int) -> tuple[LoadCase, ...]:
        postures: dict[str, _Posture] = {}
        cases = [self._load_case(number, 0, UNDISTURBED, postures)]
        places = [party.name for party in self._embodied]
        for position, disturbance in enumerate(self._case.scene.disturbances.cases, 1):
            if any(disturbance.changes_for(place) for place in places):  # somebody with a body feels it
                cases.append(self._load_case(number, position, disturbance, postures))
        return tuple(cases)

    def _load_case(
        self, instant: int, number: int, disturbance: Disturbance, postures: dict[str, _Posture]
    ) -> LoadCase:
        prefix = f"instant_{instant}." if len(self._case.load_heights) > 1 else ""
        prefix += f"disturbed_{number - 1}." if number else ""
        scene, again = self._case.scene, number > 0
        bodies: dict[str, Body] = {}
        for party in self._embodied:
            values = self._unknown_values(party, Slot(instant, number, party.name, ""), prefix, again=again)
            block = f"{prefix}{party.name}"
            if not again:
                values |= self._held_values(party, block)
                postures[party.name] = _Posture.of(party, values, self._case.motions.get(party.name))
            body = postures[party.name].body(party, self._case, instant, values, disturbance)
            bodies[party.name] = body
            if not again and directed(party.form):
                self._parted.append(PartedBody(f"{block}.{PARTING}", f"{block}.{CLEAR}", body))
        hands = {name: body.hands for name, body in bodies.items()}
        for free in self._hands:
            asked, slot = hand_unknowns(free.free, scene.payload), Slot(instant, number, free.name, "")
            found = {unknown.part: self._variable(unknown, f"{prefix}{free.name}", slot) for unknown in asked}
            hands[free.name] = all_hands(free.agent.hands, found)
        for name, body in bodies.items():
            rows = [row for term in self._body_terms for row in term.rows(body)]
            self._add(rows, f"{prefix}{name}.", name, again=again)
        accelerated = self._case.load_acceleration
        coupled = Coupled(scene, bodies, hands, self._symmetric, disturbance, accelerated)
        rows = [row for term in self._system_terms for row in term.rows(coupled)]
        self._add(rows, prefix, "", again=again)
        everyone: list[tuple[Sequence[Any], Any]] = [
            *((self._enforced_ones(self._body_terms), body) for body in bodies.values()),
            (self._enforced_ones(self._system_terms), coupled),
        ]
        return LoadCase(
            bodies=bodies,
            hands=hands,
            costs=[total(term.cost(seen) for term in terms) for terms, seen in everyone],
            posture_costs=[
                total(term.posture_cost(seen) for term in terms if not again) for terms, seen in everyone
            ],
            free_moments=total([moment_cost(hands[free.name], scene.payload) for free in self._hands]),
        )

    def _unknown_values(
        self, party: Embodied, slot: Slot, prefix: str, *, again: bool
    ) -> dict[str, Expression]:
        """New variables of an agent, by part; those of its posture are made once."""
        asked = [
            unknown for term in self._body_terms for unknown in term.unknowns(party.form, self._case.scene)
        ]
        wanted = [unknown for unknown in asked if not (again and unknown.posture_only)]
        made = {unknown.part: self._variable(unknown, f"{prefix}{party.name}", slot) for unknown in wanted}
        if JOINTS in made:
            made[JOINTS] = party.form.positions(made[JOINTS])
        return made

    def _held_values(self, party: Embodied, block: str) -> dict[str, Expression]:
        """New parameters of an agent's posture, by part."""
        asking = self._body_terms if self._switched else ()
        held = [each for term in asking for each in term.held(party.form, self._case.scene)]
        values = {each.part: ca.SX.sym(f"{block}.{each.part}", each.count) for each in held}
        self._given |= {f"{block}.{part}": symbol for part, symbol in values.items()}
        return values

    def _variable(self, unknown: Unknown, block: str, slot: Slot) -> Expression:
        """The value of a new variable; without its bounds, unless they are enforced."""
        made = Variable.column(
            f"{block}.{unknown.part}", unknown.lower, unknown.upper, unknown.start, unknown.unit
        )
        if not self._enforced.covers(unknown.group):
            held = made.lower == made.upper  # what a symmetric posture does not have
            lower, upper = np.where(held, made.lower, -np.inf), np.where(held, made.upper, np.inf)
            made = replace(made, lower=lower, upper=upper)
        key, least, most = replace(slot, part=unknown.part), *bounds_of(unknown, slot.party)
        named = replace(made, labels=unknown.labels, drawn=unknown.drawn, key=key)
        self._variables.append(replace(named, least=least, most=most))
        return made.value

    def _add(self, rows: Iterable[Row], prefix: str, agent: str, *, again: bool) -> None:
        """Constraints of an agent's rows, or the system's, that are enforced, and not said before."""
        self._constraints += [
            ConstraintBlock(
                f"{prefix}{row.name}",
                row.expression,
                row.lower,
                row.upper,
                row.labels,
                *bounds_of(row, agent),
            )
            for row in rows
            if self._enforced.covers(row.group) and not (again and row.posture_only)
        ]

    def _enforced_ones(self, terms: Sequence[BodyTerm | SystemTerm]) -> list[BodyTerm | SystemTerm]:
        """The terms whose costs count."""
        return [term for term in terms if self._enforced.covers(term.group)]


@dataclass(frozen=True, slots=True)
class _Posture:
    """What all load cases of an agent at an instant have in common."""

    values: Mapping[str, Expression]
    part: Tree
    doubled: frozenset[str]
    poses: Mapping[str, Pose]
    inertial: Sequence[AppliedWrench] = ()
    reflected: Mapping[str, Expression] = field(default_factory=dict)

    @classmethod
    def of(cls, party: Embodied, values: Mapping[str, Expression], motion: PostureMotion | None) -> _Posture:
        part, doubled = party.form.part(party.tree)
        positions = {name: values[JOINTS][i] for i, name in enumerate(party.form.joints)}
        base = Pose(euler_rotation(values["base_angles"]), values["base_position"])
        poses = forward(part, base, positions)
        if motion is None:
            return cls(values, part, doubled, poses)
        rates, changes = (
            {name: found[i] for i, name in enumerate(party.form.joints)}
            for found in (party.form.positions(each[JOINTS]) for each in (motion.rates, motion.changes))
        )
        root = euler_motion(
            values["base_angles"],
            motion.rates["base_angles"],
            motion.changes["base_angles"],
            motion.changes["base_position"],
        )
        inertial = tuple(inertial_wrenches(part, poses, root, rates, changes))
        rotors = {name: each.inertia for name, each in actuators_of(part).items() if name in changes}
        reflected = {name: inertia * changes[name] for name, inertia in rotors.items()}
        return cls(values, part, doubled, poses, inertial, reflected)

    def body(
        self,
        party: Embodied,
        case: CaseSymbols,
        instant: int,
        values: Mapping[str, Expression],
        disturbance: Disturbance,
    ) -> Body:
        """The agent in a load case, with the values that are new in it."""
        return Body(
            form=party.form,
            scene=case.scene,
            load_height=case.load_heights[instant],
            part=self.part,
            doubled=self.doubled,
            poses=self.poses,
            values={**self.values, **values},
            disturbance=disturbance,
            inertial=self.inertial,
            reflected=self.reflected,
            moving=party.name in case.motions,
        )
