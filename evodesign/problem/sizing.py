"""Designs whose actuators are sized by what is asked of them.

    rated torque of a group = margin x max over its joints of  |tau| of every case of the lift,
                                                              factor |tau| / peak ratio of standing cases

An actuator is part of what the others carry, so design, postures and sizes are solved in rounds
(`hardware.sizing`). The first round is an evaluation as any other; each further one begins at the postures of
the last, with sizes that would meet the demand if postures stayed: torques are linear then in the masses of
actuators,

    d tau / d m = g J_z^T at the actuator's joint, less what the feet carry of it

Reach is asked for in the first round, and of the final sizes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.design.space import TYPICAL, DesignSpace
from evodesign.hardware.actuators import actuator_law
from evodesign.hardware.sizing import Sizing, sized
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.floating_base import ROOT, BodyState
from evodesign.mechanics.scene import ROBOT
from evodesign.mechanics.stance_case import stance_slopes
from evodesign.posture.check import AgentModel
from evodesign.posture.results import CaseSolution
from evodesign.problem.objectives import DesignResult
from evodesign.records import Status

__all__ = ["BOUNDS", "sized_result"]

Array = NDArray[np.float64]

BOUNDS = (1.0, 300.0)
"""Smallest and largest rated torque [N m] that an actuator is made for: somewhat beyond the catalogue."""

Solve = Callable[[Sequence[float], DesignResult | None], DesignResult]


def sized_result(space: DesignSpace, values: Sequence[float], solve: Solve) -> DesignResult:
    """The results of a design with sized actuators.

    Args:
        space: of the problem.
        values: of the design.
        solve: the results of values with rated torques in place of margins, given those of the last round.
    """
    groups = {space.parameters[place].name: place for place in space.margins}
    rounds: list[DesignResult] = []
    demands: list[Demand] = []

    def demand(sizes: Mapping[str, float]) -> Mapping[str, float] | None:
        given = list(values)
        for name, place in groups.items():
            given[place] = sizes[name]
        rounds.append(solve(given, rounds[-1] if rounds else None))
        found = demand_of(space, rounds[-1])
        if isinstance(found, str):
            return None
        demands.append(found)
        return found.at(sizes)

    def predict(sizes: Mapping[str, float]) -> Mapping[str, float]:
        return demands[-1].at(sizes)

    sizing = sized(
        demand,
        start={name: values[place] * TYPICAL for name, place in groups.items()},
        margins={name: values[place] for name, place in groups.items()},
        bounds=dict.fromkeys(groups, BOUNDS),
        predict=predict,
    )
    return _ended(space, rounds[-1], sizing)


def _ended(space: DesignSpace, result: DesignResult, sizing: Sizing) -> DesignResult:
    """The last round's results, as failed ones where sizes are not met."""
    if sizing.status is Status.SOLVED or not all(each.solved for each in result.cases):
        return result
    found = demand_of(space, result)
    reason = found if isinstance(found, str) else sizing.reason
    failed = tuple(CaseSolution(each.case, sizing.status, reason) for each in result.cases)
    return replace(result, cases=failed)


@dataclass(frozen=True, slots=True)
class Demand:
    """What is asked of each sized group, and how it changes with the masses of all of them.

    Args:
        groups: names.
        members: of each group, the columns of its joints in `torques`.
        sizes: rated torques for which the postures were found [N m].
        torques: of every case, those of standing ones over the peak ratio [N m], shape (cases, joints).
        slopes: by the mass of one actuator of each group [N m/kg], shape (cases, joints, groups).
    """

    groups: tuple[str, ...]
    members: tuple[tuple[int, ...], ...]
    sizes: Mapping[str, float]
    torques: Array
    slopes: Array

    def at(self, sizes: Mapping[str, float]) -> dict[str, float]:
        """The largest |tau| of each group at other sizes [N m], in the same postures."""
        law = actuator_law()
        heavier = [
            float(law.at(sizes[name]).mass) - float(law.at(self.sizes[name]).mass) for name in self.groups
        ]
        torques = np.abs(self.torques + self.slopes @ np.array(heavier))
        pairs = zip(self.groups, self.members, strict=True)
        return {name: float(torques[:, list(columns)].max(initial=0.0)) for name, columns in pairs}


def demand_of(space: DesignSpace, result: DesignResult) -> Demand | str:
    """What a round asks of the sized groups; a reason where that is not known."""
    if not all(solution.solved for solution in result.cases):
        return "a height is not held"
    parameters = [space.parameters[place] for place in space.margins]
    if result.standing is None:
        return "the robot is not known"
    model, names = result.standing.with_tree(result.tree), result.robot.joints
    frames = [[result.tree.joint_by_name[joint].child for joint in each.joints] for each in parameters]
    torques, slopes = [], []
    for of_case, slope in _lifted(result, model, frames):
        torques.append(of_case)
        slopes.append(slope)
    alone = result.standing.torques(result.tree)
    for case, found in alone:
        if found.reason:
            return found.reason
        share = case.factor / float(actuator_law().peak(1.0))
        torques.append(share * np.array([found.torques[name] for name in names]))
        slopes.append(share * stance_slopes(model.body, case, found, frames))
    places = {name: place for place, name in enumerate(names)}
    return Demand(
        groups=tuple(each.name for each in parameters),
        members=tuple(
            tuple(places[joint] for joint in each.joints if joint in places) for each in parameters
        ),
        sizes={
            each.name: result.values[place] for each, place in zip(parameters, space.margins, strict=True)
        },
        torques=np.array(torques),
        slopes=np.array(slopes),
    )


def _lifted(
    result: DesignResult, model: AgentModel, frames: Sequence[Sequence[str]]
) -> Iterator[tuple[Array, Array]]:
    """Torques of the robot in every case of the lift, and their slopes by the groups' masses."""
    names = model.agent.joints
    for _, postures in result.every_case():
        posture = postures[ROBOT]
        yield np.array([posture.torques[name] for name in names]), _slopes(model, model.at(posture), frames)


def _slopes(model: AgentModel, state: BodyState, frames: Sequence[Sequence[str]]) -> Array:
    """[N m/kg], shape (joints, groups); the feet carry what is added by the least wrenches."""
    feet = np.vstack([state.jacobian_in_frame(sole) for sole in model.agent.soles.values()])
    columns = []
    for group in frames:
        rows = GRAVITY * np.sum([state.jacobian_in_world(frame)[2] for frame in group], axis=0)
        wrenches = np.linalg.lstsq(feet[:, :ROOT].T, rows[:ROOT], rcond=None)[0]
        columns.append(rows[ROOT:] - feet[:, ROOT:].T @ wrenches)
    return np.column_stack(columns)
