"""`[baseline]` of a problem file: the paper's joint problem."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from evodesign.problem.table import Name, NotNegative, Positive, Table


class TaskWeightsTable(Table, frozen=True):
    """`[baseline.weights]`: W1 to W4 of the paper's tasks.

    Attributes:
        torque: weight of the squared norm of torques in (10 N m)^2.
        density: weight of the product of distances to the preferred densities in 1000 kg/m^3.
        center_of_pressure: weight of squared distances from the sole's middle in m^2.
        mass_height: weight of 1 / z^2 of the standing robot's centre of mass in 1/m^2.
    """

    torque: Positive = 1.0
    density: NotNegative = 0.0
    center_of_pressure: NotNegative = 0.0
    mass_height: NotNegative = 0.0


class BaselineTable(Table, frozen=True):
    """`[baseline]`: the paper's joint problem, postures of all heights and the design in one program.

    Attributes:
        start: designs of the file `search.start` to start from; without it, all.
        weights: weights of the paper's tasks.
        preferred_densities_kg_per_m3: densities that the task of densities prefers.
        joint_limits: false drops the limits of joints.
        contact_limits: false drops the limits of contacts.
        stance_limits: false drops the limits of stance.
        length_bounds: false drops the bounds of lengths.
        compile: compile the program; takes longer than it saves below hundreds of starts.
        iterations: most iterations of a solve.
        seconds: longest time of a solve.
    """

    start: tuple[Name, ...] | None = None
    weights: TaskWeightsTable = TaskWeightsTable()
    preferred_densities_kg_per_m3: tuple[Positive, ...] = ()
    joint_limits: bool = True
    contact_limits: bool = True
    stance_limits: bool = True
    length_bounds: bool = True
    compile: bool = False
    iterations: Annotated[int, Meta(ge=1)] = 1000
    seconds: Positive = 60.0
