"""What is said of a lift at one knot, and between two: blocks over the terms of a hold.

At a knot robot, person and load are in balance with their inertial forces, and every term of a hold is said
as it is there (`posture.terms`). Four things are new: joints keep within their speed; feet stay in their
place; hands that hold rigidly do not turn, for else their moments would do work on nothing; accelerations
are slightly disliked. Half-way between knots hands and feet are nearly in their places; without that the
best motion bends an elbow the other way between two knots that are exact.

Under each disturbance wrenches and torques are others, and the motion is the same. How load cases count
together is said of every knot by itself (`posture.load_cases`).

Rows that part bodies (`posture.terms.collisions`) are left out at first, those of floor, partner and middle
plane too. Blocks that have them say them at knots and half-way between, along directions of each one's own.

A block's symbols are, in the program's units, step the time between knots:

    posture, step * its rate, step^2 * its change, load height, step^2 * its change, torques and wrenches,
    places of the feet, turns of rigid hands

and, where the least time is looked for, the time of the lift, as a share of what was asked for: it is what is
minimised then, and all that else costs counts little.

Beyond 300 lines: both blocks are made of the same symbols.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from evodesign.mechanics.agent import Contact
from evodesign.mechanics.payload import Grasp
from evodesign.nlp.blocks import Block
from evodesign.nlp.program import ConstraintBlock, Expression, Variable
from evodesign.posture.allocation import shared_scene, shared_weights
from evodesign.posture.assemble import (
    MOVING_PARTS,
    Assembly,
    CaseSymbols,
    PostureMotion,
    assemble,
    total,
)
from evodesign.posture.formulations.base import Setting, embodied
from evodesign.posture.load_cases import counted_together
from evodesign.posture.parting import Meetings, meetings_of, rows_of
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.base import Body
from evodesign.posture.terms.collisions import CLEAR, COLLISIONS, meetings
from evodesign.posture.terms.grasp import GRASP
from evodesign.posture.terms.load import any_load
from evodesign.posture.terms.measured_posture import any_person, person_parameters
from evodesign.posture.terms.registry import TERMS
from evodesign.tree.model import Tree

SPEED = 6.0
"""Largest speed of a joint whose file or actuator says none [rad/s]."""

SMOOTHING, SPEEDING_UP = 1e-2, 10.0
"""Weight of the squared accelerations of joints, and their unit [rad/s^2]."""

HAND_CLOSURE, SOLE_CLOSURE, SLANT_CLOSURE = 2e-3, 1e-3, 5e-3
"""By how much hands [m] and soles [m, 1] may be out of place half-way between knots."""

CLOSURE_UNIT = 0.1
"""Of the rows between knots, in which their bounds are of the size of other rows."""

LITTLE = 1e-6
"""What torques and all that a lift else costs count beside the share of the asked-for time."""

FastestJoint = Mapping[str, Expression]


def fastest_joints(form: Form, part: Tree) -> FastestJoint:
    """The largest speed of each of the form's joints [rad/s]; of a design's actuators where it has them."""
    joints = {joint.name: joint.velocity for joint in part.joints}
    return {name: _known(joints[name]) for name in form.joints}


def _known(speed: Expression) -> Expression:
    return speed if not isinstance(speed, float) or math.isfinite(speed) else SPEED


@dataclass(frozen=True, slots=True)
class Symbols:
    """The symbols of a knot's block.

    Args:
        moving: variables of postures.
        others: torques and wrenches of every load case, and the cost of the worst one where that counts.
        rates, changes: time derivatives of the posture variables, SI units, by variable name.
        height: of the load [m].
        lifted: its acceleration [m/s^2].
        places: of the soles: x, y [m] and the sine of their turn, by agent and contact.
        grips: of hands that hold rigidly: how they are turned against where a start has them, likewise.
    """

    moving: tuple[Variable, ...]
    others: tuple[Variable, ...]
    rates: Mapping[str, Expression]
    changes: Mapping[str, Expression]
    height: Expression
    lifted: Expression
    places: Mapping[tuple[str, Contact], Expression]
    grips: Mapping[tuple[str, Contact], Expression]


class KnotBlocks:
    """The blocks of a lift in a setting.

    Args:
        forms: of robot and person, whole or halves.
        setting: of the problem.
        switched: whether rows are there that part bodies.
        timed: whether the least time is looked for.
    Attributes:
        forms: likewise.
        timed: likewise.
    """

    def __init__(
        self, forms: tuple[Form, ...], setting: Setting, *, switched: bool = False, timed: bool = False
    ) -> None:
        self.forms, self.timed, self._setting, self._switched = forms, timed, setting, switched
        self._time = ca.SX.sym("time", int(timed))
        self.design = ca.SX.sym("design", len(setting.space.parameters))
        self._step, self._inertia = ca.SX.sym("step"), ca.SX.sym("inertia")
        scene, self._mass = any_load(setting.scene)
        scene, person = any_person(scene)
        self._person = ca.vertcat(ca.SX(0, 1), *person.values())
        values = ca.vertsplit(self.design)
        self._scene = shared_scene(scene, setting.space, values)
        self._weights = shared_weights(setting.weights, setting.space, values)
        self._parties = embodied(forms, setting.space, values)
        self._rates = {form.agent.name: _derivatives(form, "rate") for form in forms}
        self._changes = {form.agent.name: _derivatives(form, "change") for form in forms}
        rigid = scene.payload.grasp is Grasp.RIGID
        hands = [(form.agent.name, hand) for form in forms for hand in form.hands if rigid]
        self._turns = {(name, hand): ca.SX.sym(f"{name}.{hand.name}_turn", 3, 3) for name, hand in hands}
        self._height, self._lifted = ca.SX.sym("height"), ca.SX.sym("lifted")

    @cached_property
    def _assembly(self) -> Assembly:
        names = [form.agent.name for form in self.forms]
        motions = {name: PostureMotion(self._rates[name], self._changes[name]) for name in names}
        case = CaseSymbols(self._scene, (self._height,), motions, self._lifted)
        terms = [term for term in TERMS.values() if self._switched or term is not COLLISIONS]
        return assemble(self._parties, terms, case, switched=self._switched)

    @cached_property
    def parted(self) -> KnotBlocks | None:
        """The same with rows that part bodies; None where no bodies are parted."""
        parting = any(meetings(form) for form in self.forms)
        return KnotBlocks(self.forms, self._setting, switched=True, timed=self.timed) if parting else None

    @cached_property
    def directions(self) -> int:
        """How many numbers say along which directions bodies are parted at a time."""
        return int(self._directions.numel())

    @property
    def _directions(self) -> Expression:
        return ca.vertcat(ca.SX(0, 1), *self._assembly.given.values())

    @cached_property
    def meetings(self) -> tuple[Meetings, Meetings]:
        """Of bodies that are parted along directions, with their rows at a knot and half-way between two.

        The arguments of their functions are all posture symbols, the load's height, the directions and the
        shared numbers.
        """
        bodies = self._assembly.parted
        at_knot = meetings_of(bodies, self._assembly.constraints, self._placing)
        return at_knot, replace(at_knot, rows=rows_of(bodies, self._half_way))

    @cached_property
    def beyond_planes(self) -> ca.Function:
        """By how much bodies are nearer to planes than the margin [m], negative where they are farther."""
        short = [
            row.lower - row.expression
            for body in self._assembly.undisturbed.bodies.values()
            for row in COLLISIONS.rows(body)
            if row.name != CLEAR
        ]
        return ca.Function("beyond_planes", self._placing, [ca.vertcat(ca.SX(0, 1), *short)], {"cse": True})

    @property
    def _placing(self) -> list[Expression]:
        """What bodies and their directions follow from."""
        postures = ca.vertcat(*[v.symbol for v in self.symbols.moving])
        return [postures, self._height, self._directions, self.shared]

    @property
    def disturbances(self) -> tuple[str, ...]:
        """Names of those that have load cases, in the order of their numbers from one."""
        return tuple(each.name for each in self._setting.scene.disturbances.cases)

    @cached_property
    def _carrying(self) -> tuple[Expression, tuple[Variable, ...], tuple[ConstraintBlock, ...]]:
        """What torques, wrenches and the posture itself cost, with what the worst load case adds."""
        by_agent = self._weights.by_agent(self._scene.agents)
        held = self._assembly.undisturbed
        if not self.disturbances:
            return total([held.effort(by_agent), *held.regularisation]), (), ()
        (load_cases,) = self._assembly.instants
        costs = [total([each.effort(by_agent), *each.costs]) for each in load_cases]
        cost, variables, rows = counted_together(self._setting.scene.disturbances.effort, costs)
        return total([cost, *held.posture_costs]), variables, rows

    @cached_property
    def worst(self) -> ca.Function | None:
        """The least value that the worst load case's cost may have; None where the worst does not count.

        Arguments are the symbols of torques, wrenches and that cost, and the design.
        """
        _, worst, below = self._carrying
        if not worst:
            return None
        others = ca.vertcat(*[v.symbol for v in self.symbols.others])
        least = ca.mmax(below[0].expression + worst[0].value)
        return ca.Function("worst", [others, self.design], [least])

    @cached_property
    def symbols(self) -> Symbols:
        """Of the knot's block."""
        variables = self._assembly.variables
        moving = tuple(v for v in variables if v.key.part in MOVING_PARTS)  # type: ignore[attr-defined]
        by_slot = {v.name: (v.key.party, v.key.part) for v in moving}  # type: ignore[attr-defined]
        return Symbols(
            moving=moving,
            others=(*(v for v in variables if v not in moving), *self._carrying[1]),
            rates={name: self._rates[party][part] for name, (party, part) in by_slot.items()},
            changes={name: self._changes[party][part] for name, (party, part) in by_slot.items()},
            height=self._height,
            lifted=self._lifted,
            places={
                (form.agent.name, foot): ca.SX.sym(f"{form.agent.name}.{foot.name}_place", 3)
                for form in self.forms
                for foot in form.feet
            },
            grips={(name, hand): ca.SX.sym(f"{name}.{hand.name}_grip", 3) for name, hand in self._turns},
        )

    @cached_property
    def free(self) -> np.ndarray:
        """Which rows of the posture variables move at all, of those stacked one after the other."""
        return np.concatenate([v.lower < v.upper for v in self.symbols.moving])

    @property
    def shared(self) -> Expression:
        """Design, step [s], the load's mass [kg], the share of inertia, who it is, and a start's hands."""
        turns = [ca.vec(turn) for turn in self._turns.values()]
        return ca.vertcat(self.design, self._step, self._mass, self._inertia, self._person, *turns)

    @property
    def person(self) -> tuple[float, ...]:
        """The numbers that say who of the people of a distribution it is; none where there is none."""
        return tuple(number for each in person_parameters(self._setting.scene).values() for number in each)

    @cached_property
    def knot(self) -> Block:
        """What is said at a knot; its own number is its weight in the cost."""
        _seen, assembly, weight = self.symbols, self._assembly, ca.SX.sym("weight")
        carrying, _, further = self._carrying
        rows, low, high = [], [], []
        for each in (*assembly.constraints, *further):
            rows.append(each.expression)
            low += [each.lower] * each.expression.numel()
            high += [each.upper] * each.expression.numel()
        for body in assembly.undisturbed.bodies.values():
            speeds = self._speeds(body)
            placed = ca.vertcat(*[offset[[0, 1, 5]] for offset in self._soles(body)], *self._grips(body))
            rows += [speeds, placed]
            low += [-1.0] * speeds.numel() + [0.0] * placed.numel()
            high += [1.0] * speeds.numel() + [0.0] * placed.numel()
        cost = total([carrying, *map(self._smoothness, self.forms)])
        if self.timed:
            cost = self._time + LITTLE * cost
        column, own = self._column(), ca.vertcat(weight, self._directions)
        cost, stacked = self._in_units([weight * cost, ca.vertcat(*rows)], column)
        return Block("knot", column, own, self.shared, cost, stacked, np.array(low), np.array(high))

    @cached_property
    def between(self) -> Block:
        """What is said half-way between knots, of posture, load height and places."""
        moved = [self._stepped[0]] * self.timed
        column = ca.vertcat(self._posture, *moved, self._height, self._places, self._time)
        rows = self._half_way
        (stacked,) = self._in_units([ca.vertcat(*[row.expression for row in rows])], column)
        counts = [row.expression.numel() for row in rows]
        low, high = (
            np.repeat(side, counts) for side in zip(*[(r.lower, r.upper) for r in rows], strict=True)
        )
        return Block("between", column, self._directions, self.shared, ca.SX(0.0), stacked, low, high)

    @cached_property
    def _half_way(self) -> list[ConstraintBlock]:
        """Hands and feet nearly in place, and bodies apart where they are parted along directions.

        Where the least time is looked for joints are within their speed everywhere: speeds are a quadratic
        spline, whose coefficients are the differences of the motion's, and a weighted mean of these.
        """
        rows, bodies = [], self._assembly.undisturbed.bodies
        for body in bodies.values():
            rows += [row.expression / HAND_CLOSURE for row in GRASP.rows(body)]
            for offset in self._soles(body):
                rows += [offset[:3] / SOLE_CLOSURE, offset[3:] / SLANT_CLOSURE]
            rows += [turned / SLANT_CLOSURE for turned in self._grips(body)]
        closed = ConstraintBlock("closed", CLOSURE_UNIT * ca.vertcat(*rows), -CLOSURE_UNIT, CLOSURE_UNIT)
        apart = [
            ConstraintBlock(f"{name}.{row.name}", row.expression, row.lower, row.upper)
            for name, body in bodies.items()
            for row in COLLISIONS.rows(body)
            if self._switched
        ]
        speeds = [
            ConstraintBlock(f"{name}.speeds", self._speeds(body), -1.0, 1.0)
            for name, body in bodies.items()
            if self.timed
        ]
        return [closed, *apart, *speeds]

    @cached_property
    def closure(self) -> ca.Function:
        """Hands and soles out of place [m, 1] from a posture, height and places, and the same of each agent.

        Arguments are the posture's free symbols, the load's height, the places and the shared numbers.
        """
        rows = []
        for body in self._assembly.undisturbed.bodies.values():
            rows += [row.expression for row in GRASP.rows(body)]
            rows += [*self._soles(body), *self._grips(body)]
        (open_by,) = self._in_units([ca.vertcat(*rows)], ca.vertcat(self._posture))
        arguments = [self._posture, self._height, self._places, self.shared]
        outputs = [open_by, ca.jacobian(open_by, self._posture)]
        return ca.Function("closure", arguments, outputs, {"cse": True})

    @property
    def _posture(self) -> Expression:
        moving = ca.vertcat(*[v.symbol for v in self.symbols.moving])
        return moving[np.flatnonzero(self.free).tolist()]

    @property
    def _places(self) -> Expression:
        return ca.vertcat(*self.symbols.places.values(), *self.symbols.grips.values())

    @cached_property
    def hands(self) -> ca.Function:
        """How hands that hold rigidly are turned, as `shared` has them, from posture and design."""
        bodies = self._assembly.undisturbed.bodies
        turns = [bodies[name].poses[hand.frame].rotation for name, hand in self._turns]
        column = ca.vertcat(ca.SX(0, 1), *[ca.vec(turn) for turn in turns])
        (found,) = self._in_units([column], self._posture)
        return ca.Function("hands", [self._posture, self.design], [found], {"cse": True})

    @cached_property
    def _stepped(self) -> tuple[Expression, Expression, Expression]:
        """Symbols of step * rates, step^2 * changes, and step^2 * the load's acceleration."""
        count = int(self.free.sum())
        return ca.SX.sym("moved", count), ca.SX.sym("bent", count), ca.SX.sym("load_bent")

    def _column(self) -> Expression:
        moved, bent, load_bent = self._stepped
        others = [v.symbol for v in self.symbols.others]
        posture = [self._posture, moved, bent, self._height, load_bent]
        return ca.vertcat(*posture, *others, self._places, self._time)

    def _in_units(self, expressions: Sequence[Expression], column: Expression) -> list[Expression]:
        """Expressions of the block's symbols: derivatives in steps, and zero for what does not move."""
        seen, (moved, bent, load_bent) = self.symbols, self._stepped
        scale = np.concatenate([np.full(len(v.lower), v.scale) for v in seen.moving])[self.free]
        free, fixed = np.flatnonzero(self.free).tolist(), np.flatnonzero(~self.free).tolist()
        symbols = ca.vertcat(*[v.symbol for v in seen.moving])
        rates, changes = ca.vertcat(*seen.rates.values()), ca.vertcat(*seen.changes.values())
        still = ca.DM(np.concatenate([v.lower / v.scale for v in seen.moving])[fixed])
        pace = self._inertia / (self._step * self._time if self.timed else self._step)
        replaced = [
            (symbols[fixed], still),
            (rates[fixed], ca.DM.zeros(len(fixed))),
            (changes[fixed], ca.DM.zeros(len(fixed))),
            (rates[free], scale * moved * pace),
            (changes[free], scale * bent * pace**2),
            (self._lifted, load_bent * pace**2),
        ]
        names, values = (ca.vertcat(*each) for each in zip(*replaced, strict=True))
        return list(ca.substitute(list(expressions), [names], [values]))

    def _speeds(self, body: Body) -> Expression:
        """Shares of the joints' largest speeds."""
        fastest = fastest_joints(body.form, body.part)
        rates = body.form.positions(self._rates[body.agent.name]["joints"])
        return ca.vertcat(*[rates[place] / fastest[name] for place, name in enumerate(body.form.joints)])

    def _soles(self, body: Body) -> Iterator[Expression]:
        """By how much each sole is out of its place: x, y, z [m], its slants and the sine of its turn."""
        for foot in body.form.feet:
            sole, place = body.poses[foot.frame], self.symbols.places[body.agent.name, foot]
            where = sole.position - ca.vertcat(place[:2], 0.0)
            yield ca.vertcat(where, sole.rotation[:2, 2], sole.rotation[1, 0] - place[2])

    def _grips(self, body: Body) -> Iterator[Expression]:
        """By how much each rigid hand turns from its grip: axis times sine of the angle."""
        for hand in body.form.hands if self._turns else ():
            key = body.agent.name, hand
            turn = self._turns[key].T @ body.poses[hand.frame].rotation
            yield ca.inv_skew(turn - turn.T) / 2.0 - self.symbols.grips[key]

    def _smoothness(self, form: Form) -> Expression:
        changes = form.positions(self._changes[form.agent.name]["joints"]) / SPEEDING_UP
        return SMOOTHING * ca.dot(ca.DM(list(form.counts)), changes**2)


def _derivatives(form: Form, word: str) -> dict[str, Expression]:
    counts = dict(zip(MOVING_PARTS, (3, 3, len(form.coordinates)), strict=True))
    return {part: ca.SX.sym(f"{form.agent.name}.{part}_{word}", count) for part, count in counts.items()}
