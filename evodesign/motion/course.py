"""The motion that a solve of a lift gives, at any time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import scipy
from numpy.typing import NDArray

from evodesign.motion.spline import RestingSpline
from evodesign.posture.check import AgentMotion, SceneMotion
from evodesign.posture.results import AgentPosture, Instant
from evodesign.posture.symmetry import Form
from evodesign.records import Lift

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class LiftCourse:
    """The motion that a solve gives, at any time.

    Args:
        lift: what was asked for.
        forms: of robot and person.
        coefficients: of the splines of postures, by agent and part, shape (knots, rows).
        carried: torques and wrenches at the knots, by agent and part, shape (knots, rows).
        load: coefficients of the load's height [m], shape (knots,).
        disturbed: what is carried under each disturbance, by its name, likewise.
        abrupt: whether torques and wrenches are linear between knots, as accelerations are: those of the
            quickest motion jump from one limit to another, which a spline overshoots.
    """

    lift: Lift
    forms: tuple[Form, ...]
    coefficients: Mapping[str, Mapping[str, Array]]
    carried: Mapping[str, Mapping[str, Array]]
    load: Array
    disturbed: Mapping[str, Mapping[str, Mapping[str, Array]]] = field(default_factory=dict)
    abrupt: bool = False

    def instants(self, times: Sequence[float] | Array) -> tuple[Instant, ...]:
        """Whole postures and what is carried, between knots by splines through those at the knots."""
        undisturbed = self._whole(times, self.carried)
        disturbed = {name: self._whole(times, carried) for name, carried in self.disturbed.items()}
        return tuple(
            Instant(
                float(time),
                undisturbed[number],
                {name: each[number] for name, each in disturbed.items()},
                height=float(height),
            )
            for number, (time, height) in enumerate(zip(times, self.heights(times), strict=True))
        )

    def _whole(
        self, times: Sequence[float] | Array, carried: Mapping[str, Mapping[str, Array]]
    ) -> list[dict[str, AgentPosture]]:
        """Whole postures by agent, at each time, with what is carried in one load case."""
        postures, carriage = self.postures(times), self.carriage(times, carried)
        image = self._image(times, 1) / self.lift.step
        found: list[dict[str, AgentPosture]] = [{} for _ in times]
        for form in self.forms:
            name = form.agent.name
            parts, rates = {**postures[name], **carriage[name]}, image @ self.coefficients[name]["joints"]
            for number, each in enumerate(found):
                posture = form.expand({part: values[number] for part, values in parts.items()})
                each[name] = replace(posture, speeds=form.whole_joints(form.positions(rates[number])))
        return found

    def postures(self, times: Sequence[float] | Array) -> dict[str, dict[str, Array]]:
        """Of the forms, by agent and part, shape (times, rows)."""
        image = self._image(times)
        return {
            name: {part: image @ c for part, c in parts.items()} for name, parts in self.coefficients.items()
        }

    def carriage(
        self, times: Sequence[float] | Array, carried: Mapping[str, Mapping[str, Array]]
    ) -> dict[str, dict[str, Array]]:
        """Torques and wrenches of the forms, likewise, from those of a load case at the knots."""
        knots = self.lift.knot_times
        through = partial(scipy.interpolate.make_interp_spline, k=1 if self.abrupt else 3)
        return {
            name: {part: through(knots, at)(times) for part, at in parts.items()}
            for name, parts in carried.items()
        }

    def motions(self, times: Sequence[float] | Array) -> tuple[SceneMotion, ...]:
        """How everything moves."""
        step, agents = self.lift.step, {form.agent.name: self._moving(form, times) for form in self.forms}
        lifted = self._image(times, 2) @ self.load / step**2
        return tuple(
            SceneMotion({name: moving[number] for name, moving in agents.items()}, float(lifted[number]))
            for number in range(len(times))
        )

    def heights(self, times: Sequence[float] | Array) -> Array:
        """Of the load's centre [m]."""
        return np.asarray(self._image(times) @ self.load)

    def _moving(self, form: Form, times: Sequence[float] | Array) -> list[AgentMotion]:
        own, step = self.coefficients[form.agent.name], self.lift.step
        orders = []
        for order in (1, 2):
            image = self._image(times, order) / step**order
            base = np.hstack([image @ own["base_position"], image @ own["base_angles"]])
            joints = [list(form.whole_joints(form.positions(row)).values()) for row in image @ own["joints"]]
            orders.append(np.hstack([base, np.array(joints)]))
        return [AgentMotion(rates, changes) for rates, changes in zip(*orders, strict=True)]

    def _image(self, times: Sequence[float] | Array, order: int = 0) -> Array:
        return RestingSpline(self.lift.knots).image(np.asarray(times) / self.lift.step, order)
