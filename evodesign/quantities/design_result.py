"""Everything that was computed of one design, and how quantities of its cases are taken together."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from evodesign.design.space import DesignSpace
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.robot_gradient import RobotGradient
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.posture.formulations.codesign import JointSettings
from evodesign.posture.formulations.reach import Reach
from evodesign.posture.results import AgentPosture, Array, CaseSolution
from evodesign.quantities.demand import Demand
from evodesign.quantities.push_quantities import FoundPushes
from evodesign.quantities.stance_model import StanceModel
from evodesign.records import Case
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree


@dataclass(frozen=True, slots=True)
class DesignResult:
    """Everything that was computed of one design.

    Args:
        scenes: every person with every load.
        space: design parameters.
        values: one number per design parameter.
        tree: the robot of the design.
        reach: interval of load heights that it can hold, whatever the load.
        people_highest: highest load that all of the people can hold [m]; None where that was not asked for.
        rated: the values with rated torques [N m] in place of margins; none where there are no margins.
        standing: what postures in which the robot stands alone ask of a tree's actuators.
        cases: one solution per undisturbed case of the problem, in its order.
        paper: the paper's tasks and their weights.
        demand: on sized actuators; None without any, and where no posture was found.
        pushes: what simulations say; None before any, which take seconds and are for feasible designs alone.
    """

    scenes: tuple[Scene, ...]
    space: DesignSpace
    values: Sequence[float]
    tree: Tree
    reach: Reach
    cases: tuple[CaseSolution, ...]
    paper: JointSettings
    people_highest: float | None = None
    rated: tuple[float, ...] = ()
    standing: StanceModel | None = None
    demand: Demand | None = None
    pushes: FoundPushes | None = None

    @property
    def program_values(self) -> Sequence[float]:
        """What programs and trees are given: one number per parameter."""
        return self.rated or self.values

    @property
    def rated_torques(self) -> dict[str, float]:
        """Of sized actuators [N m], by the parameter that is their margin."""
        return {self.space.parameters[place].name: self.rated[place] for place in self.space.margins}

    @property
    def robot(self) -> Agent:
        """The robot that designs change, as the file describes it."""
        return self.scenes[0].robot

    def scene_of(self, case: Case) -> Scene:
        """The scene of a case; designed robots have the design's tree and limits where it has hardware."""
        scene = scene_of(self.scenes, case.pair)
        rated = {joint: each.rated for joint, each in actuators_of(self.tree).items()}
        if not rated and not self.space.walls:
            return scene
        return scene.with_agents(
            *(
                replace(robot, tree=self.tree, torque_limits={**robot.torque_limits, **rated})
                for robot in scene.designed
            )
        )

    def every_case(self) -> Iterator[tuple[CaseSolution, str]]:
        """Every solved case with a disturbance's name, undisturbed ones first, for which that is empty."""
        for solution in self.cases:
            for instant in solution.instants[:1]:
                yield from ((solution, name) for name in ("", *instant.disturbed))


WORST = "worst_"
"""What stands before the name of a quantity whose largest value counts."""


CaseValue = Callable[[Scene, Mapping[str, AgentPosture]], float]
"""From a scene and the postures in it, by agent name, to a value."""


ByTorque = Callable[[Scene, Mapping[str, AgentPosture]], Mapping[str, Mapping[str, float]]]
"""From a scene and the postures in it to a quantity's derivatives by torques, by agent and joint."""


@dataclass(frozen=True, slots=True)
class PostureSlopes:
    """A quantity's derivatives by one agent's posture and wrenches, torques held.

    Args:
        base_angles: by roll, pitch, yaw [1/rad], shape (3,).
        joints: by position of each joint [1/rad].
        wrenches: by the wrench of each contact, by name, shape (6,); none: they do not matter.
    """

    base_angles: Array
    joints: Mapping[str, float]
    wrenches: Mapping[str, Array] = field(default_factory=dict)

    def times(self, factor: float) -> PostureSlopes:
        """Those of a multiple."""
        return PostureSlopes(
            factor * self.base_angles,
            {joint: factor * slope for joint, slope in self.joints.items()},
            {name: factor * slope for name, slope in self.wrenches.items()},
        )

    def along(self, posture: AgentPosture) -> float:
        """The sum of what a posture has, each times its derivative."""
        found = float(self.base_angles @ posture.base_angles)
        found += sum(slope * posture.joints[joint] for joint, slope in self.joints.items())
        found += sum(float(slope @ posture.wrenches[name]) for name, slope in self.wrenches.items())
        return found


ByRobot = Callable[
    [RobotGradient, Sequence[float], Scene, Mapping[str, AgentPosture]],
    tuple[Array, Mapping[str, PostureSlopes]],
]
"""From derivatives of the robot, what programs are given, a scene and the postures in it to a quantity's
derivatives by what programs are given, shape (n,), and by postures, by agent."""


ByPosture = Callable[[Scene, Mapping[str, AgentPosture]], Mapping[str, PostureSlopes]]
"""From a scene and the postures in it to a quantity's derivatives by postures, by agent."""


@dataclass(frozen=True, slots=True)
class CaseQuantity:
    """A value of every case: its unit and formula.

    `by_torque` is its derivative, for a quantity that depends on torques alone, `by_speed` that by the
    speeds of joints, for one that depends on them as well, and `by_posture` that by postures and wrenches,
    for one of people that depends on these (and on torques, if it has `by_torque` too). `by_robot` is that of
    one which depends on the designed robot and its posture. Without any, gradients are taken by differences
    along the exact tangent, which costs many times as much.
    `of_actuators` says whether the formula may hold numbers of the robot's actuators.
    """

    unit: str
    value: CaseValue
    by_torque: ByTorque | None = None
    by_speed: ByTorque | None = None
    by_posture: ByPosture | None = None
    by_robot: ByRobot | None = None
    of_actuators: bool = True

    @property
    def has_slopes(self) -> bool:
        """Whether a formula gives its gradient."""
        return any(each is not None for each in (self.by_torque, self.by_posture, self.by_robot))


@dataclass(frozen=True, slots=True)
class ObjectiveKind:
    """An objective's unit and formula."""

    unit: str
    value: Callable[[DesignResult], float | None]


Value = TypeVar("Value", float, Array)


def mean_over_time(times: Sequence[float], values: Sequence[Value]) -> Value:
    """The mean of numbers or arrays: the only one, or by the trapezoidal rule over their times [s]."""
    if len(values) == 1:
        return values[0]
    lengths = np.diff(times)
    weights = (np.append(lengths, 0.0) + np.insert(lengths, 0, 0.0)) / (2.0 * (times[-1] - times[0]))
    parts = (float(weight) * value for weight, value in zip(weights, values, strict=True))
    return functools.reduce(operator.add, parts)


def values_over_cases(
    value: CaseValue, result: DesignResult, *, disturbed: bool = True
) -> list[float] | None:
    """A quantity in every case, or in every undisturbed one, in their order; None unless all are solved.

    That of a lift is its mean over time.
    """
    found = values_over_instants(value, result)
    if found is None:
        return None
    return [
        mean_over_time(solution.times, values)
        for (solution, disturbance), values in zip(result.every_case(), found, strict=True)
        if disturbed or not disturbance
    ]


def values_over_instants(value: CaseValue, result: DesignResult) -> list[list[float]] | None:
    """A quantity at each instant of every case, as `every_case`; None unless all are solved."""
    if not all(solution.solved for solution in result.cases):
        return None
    return [
        [
            value(result.scene_of(solution.case), instant.disturbed.get(disturbance, instant.postures))
            for instant in solution.instants
        ]
        for solution, disturbance in result.every_case()
    ]


def aggregate(quantity: CaseQuantity, way: str) -> ObjectiveKind:
    """The objective that a quantity is over all cases.

    Args:
        quantity: of single cases.
        way: nothing for the mean, `worst_` for the largest at any instant, `q90_` for the 90 % quantile
            (interpolated linearly between the values on both sides of it).
    """

    def value(result: DesignResult) -> float | None:
        if way == WORST:
            return largest_value(quantity.value, result)
        values = values_over_cases(quantity.value, result)
        if values is None:
            return None
        return float(np.quantile(values, float(way[1:-1]) / 100.0) if way else np.mean(values))

    return ObjectiveKind(quantity.unit, value)


def largest_value(value: CaseValue, result: DesignResult) -> float | None:
    """The largest value of a quantity at any instant of any case; None unless all are solved."""
    found = values_over_instants(value, result)
    return None if found is None else max(each for values in found for each in values)
