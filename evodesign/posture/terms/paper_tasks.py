"""The tasks t1 to t4 of the paper's problem and their weights.

    t1 = |tau|^2                            per height, both agents            [(10 N m)^2]
    t2 = sum_j prod_i |rho_j - rho*_i|      over density parameters j          [(1000 kg/m^3)^i]
    t3 = sum |CoP - CoP*|^2                 per height, all four feet          [m^2]
    t4 = 1 / z_com^2                        at the null configuration          [1/m^2]

The absolute value of t2 has a kink exactly where it is sought, so |x| is sqrt(x^2 + w^2) - w with a small w:
still zero at a preferred density, and smooth. CoP* is the origin of the sole frame, the middle of the sole.

Source: Sartore et al. 2022, Section III-D and Eq. 14.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from evodesign.design.parameter import ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import standing_height_of_mass
from evodesign.tree.kinematics import Expression
from evodesign.tree.model import Tree

DENSITY_UNIT = 1000.0  # [kg/m^3]
SMOOTHING = 0.01
"""w, in units of density: 10 kg/m^3."""


@dataclass(frozen=True, slots=True)
class TaskWeights:
    """Weights W1 to W4; the paper does not print its own."""

    torque: float = 1.0
    density: float = 0.0
    center_of_pressure: float = 0.0
    mass_height: float = 0.0


@dataclass(frozen=True, slots=True)
class Tasks:
    """What Eq. 14 minimises.

    Args:
        weights: W1 to W4.
        preferred_densities: rho*_i [kg/m^3].
    """

    weights: TaskWeights = TaskWeights()
    preferred_densities: tuple[float, ...] = ()

    def of_design(
        self, space: DesignSpace, values: Sequence[Expression], robot: Agent, tree: Tree
    ) -> Expression:
        """W2 t2 + W4 t4, which depend on the design alone.

        Args:
            space: design parameters.
            values: one number or expression per parameter.
            robot: the agent, for its soles.
            tree: the robot of the design.
        """
        total: Expression = 0.0
        if self.weights.density:
            total += self.weights.density * density_task(space, values, self.preferred_densities)
        if self.weights.mass_height:
            total += self.weights.mass_height * mass_height_task(robot, tree)
        return total


def density_task(space: DesignSpace, values: Sequence[Expression], preferred: Sequence[float]) -> Expression:
    """t2: zero where every density is one of the preferred ones [kg/m^3]."""
    total: Expression = 0.0
    for parameter, value in zip(space.parameters, values, strict=True):
        if parameter.kind is ParameterKind.DENSITY:
            product: Expression = 1.0
            for density in preferred:
                product = product * _distance((value - density) / DENSITY_UNIT)
            total = total + product
    return total


def _distance(difference: Expression) -> Expression:
    return ca.sqrt(difference**2 + SMOOTHING**2) - SMOOTHING


def pressure_task(feet: Mapping[str, Expression]) -> Expression:
    """One agent's part of t3.

    Args:
        feet: wrench [N, N m] on each foot in its sole frame, by side; a foot must press on the ground.
    """
    return sum((wrench[3] ** 2 + wrench[4] ** 2) / wrench[2] ** 2 for wrench in feet.values())


def mass_height_task(robot: Agent, tree: Tree) -> Expression:
    """t4: the less, the higher the centre of mass of the standing robot."""
    return 1.0 / standing_height_of_mass(tree, robot.foot_frames) ** 2
