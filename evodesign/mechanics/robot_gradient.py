"""How what depends on the designed robot moves with a design: masses, torques of standing, deflections.

The robot's tree is made of symbols once, as for the posture programs; CasADi differentiates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from evodesign.design.space import Family
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import standing_height_of_mass
from evodesign.mechanics.deflection_gradient import DeflectionGradient
from evodesign.mechanics.stance_case import StanceCase
from evodesign.mechanics.stance_gradient import StanceGradient
from evodesign.tree.equip import actuators_of
from evodesign.tree.kinematics import Expression
from evodesign.tree.model import Tree

Array = NDArray[np.float64]

OF_MASSES: Mapping[str, Callable[[Tree, tuple[str, ...]], Expression]] = {
    "mass": lambda tree, _: tree.mass,
    "com_height": standing_height_of_mass,
    "actuator_mass": lambda tree, _: sum(each.mass for each in actuators_of(tree).values()),
}
"""Quantities that depend on the masses of the robot's links and actuators alone, of its tree and soles."""


class RobotGradient:
    """Derivatives by what programs are given, for any design.

    Args:
        family: of the designs.
        agent: the robot that they change.
        cases: in which it stands alone.
    """

    def __init__(self, family: Family, agent: Agent, cases: Sequence[StanceCase]) -> None:
        self._family, self._agent, self._cases = family, agent, tuple(cases)
        self._known: dict[str, ca.Function] = {}
        self._deflections: dict[str, DeflectionGradient] = {}

    @cached_property
    def _symbolic(self) -> tuple[ca.SX, Tree]:
        """The values as symbols, and the robot of them."""
        values = ca.SX.sym("values", len(self._family.space.parameters))
        return values, self._family.resized(ca.vertsplit(values))

    @cached_property
    def stances(self) -> tuple[StanceGradient, ...]:
        """Torques of the cases in which the robot stands alone."""
        joints = tuple(dict.fromkeys((*self._agent.joints, *self._family.space.driven)))
        values, tree = self._symbolic
        return tuple(StanceGradient(case, tree, values, joints) for case in self._cases)

    def deflection(self, agent: Agent) -> DeflectionGradient:
        """That of the hands of a robot of the design."""
        if agent.name not in self._deflections:
            values, tree = self._symbolic
            self._deflections[agent.name] = DeflectionGradient(tree, values, agent)
        return self._deflections[agent.name]

    def of_masses(self, name: str, values: Sequence[float]) -> Array:
        """The derivatives of one of `OF_MASSES`, shape (n,).

        Args:
            name: of the quantity.
            values: of the design, as programs are given them.
        """
        if name not in self._known:
            given, tree = self._symbolic
            slopes = ca.jacobian(ca.SX(OF_MASSES[name](tree, self._agent.foot_frames)), given)
            self._known[name] = ca.Function(name, [given], [slopes])
        return np.array(self._known[name](list(values))).ravel()
