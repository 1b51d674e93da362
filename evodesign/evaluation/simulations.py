"""Holds and lifts of a design, simulated: what each was to be, what was done, and how far apart both are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import msgspec

from evodesign.control.gains import Feedback
from evodesign.errors import InputError
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.motion.solution import LiftSolution
from evodesign.records import CaseDetail
from evodesign.simulation.model import STEP
from evodesign.simulation.outcome import Rollout, SimulationOutcome, outcome_of
from evodesign.simulation.plan import Plan, hold_plan, lift_plan
from evodesign.simulation.rollout import rolled_out
from evodesign.tasks import Hold, Lift, Task
from evodesign.tree.model import Tree

HOLD_SECONDS = 2.0
"""For which a hold is simulated [s], unless another time is asked for."""


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedCase:
    """A hold or a lift of one person with one load.

    Args:
        scene: undisturbed.
        name: person, load, and height or lift, where there are several.
        trees: of robot and person by name.
        plan: that was followed.
        rollout: what was done.
        outcome: how far both are apart.
    """

    scene: Scene
    name: str
    trees: Mapping[str, Tree]
    plan: Plan
    rollout: Rollout
    outcome: SimulationOutcome

    def __repr__(self) -> str:
        end = "stands" if self.outcome.stands else "falls"
        return f"<simulated {self.name}: {end}, load {1e3 * self.outcome.drift:.3g} mm off>"


def lifts_among(tasks: Sequence[Task], heights: Sequence[float], knots: int) -> list[Lift]:
    """The lifts of a problem's tasks, with so many knots; none where holds at some heights are wanted."""
    lifts = [task for task in tasks if isinstance(task, Lift) and not heights]
    return [msgspec.structs.replace(lift, knots=knots) for lift in lifts]


def picked_cases(
    cases: Sequence[CaseDetail], person: str | None, payload: str | None
) -> tuple[CaseDetail, ...]:
    """The cases of a person and of a load; of all of them where nothing is said.

    Raises:
        InputError: there is none of them.
    """
    people, loads = ([] if name is None else [name] for name in (person, payload))
    found = _picked("--person", tuple(cases), people, lambda detail: detail.case.person)
    return _picked("--payload", found, loads, lambda detail: detail.case.payload)


def picked_holds(cases: Sequence[CaseDetail], heights: Sequence[float]) -> tuple[CaseDetail, ...]:
    """The holds among them, at some heights [m] or at all.

    Raises:
        InputError: there is none of a height.
    """
    holds = tuple(detail for detail in cases if isinstance(detail.case.task, Hold))
    return _picked("--height", holds, heights, lambda detail: detail.height_m)


def _picked(
    key: str,
    cases: tuple[CaseDetail, ...],
    wanted: Sequence[float | str],
    value_of: Callable[[CaseDetail], float | str],
) -> tuple[CaseDetail, ...]:
    there = list(dict.fromkeys(map(value_of, cases)))
    missing = next((each for each in wanted if each not in there), None)
    if missing is not None:
        raise InputError(key, "", f"one of {', '.join(map(str, there))}", f"{missing}")
    return tuple(detail for detail in cases if not wanted or value_of(detail) in wanted)


def simulated_holds(
    scenes: Sequence[Scene], robot: Tree, cases: Sequence[CaseDetail], seconds: float, feedback: Feedback
) -> Iterator[SimulatedCase]:
    """Every case as a hold in time.

    Args:
        scenes: of the problem.
        robot: the design's tree.
        cases: their postures.
        seconds: for which each is held [s].
        feedback: of all joints.
    Raises:
        InputError: a time that is not positive.
        ModelError: MuJoCo cannot hold a tree.
    """
    if not seconds > 0.0:
        raise InputError("--seconds", "", "a positive number", f"{seconds}")
    for detail in cases:
        postures = {name: logged_posture(agent) for name, agent in detail.agents.items()}
        plan = hold_plan(postures, detail.height_m, seconds, STEP)
        yield _followed(scene_of(scenes, detail.case.pair), detail.case.name, robot, plan, feedback)


def simulated_lifts(
    scenes: Sequence[Scene],
    robot: Tree,
    solutions: Mapping[tuple[str, str], LiftSolution],
    feedback: Feedback,
) -> Iterator[SimulatedCase]:
    """Every lift that was found; arguments and errors as for holds."""
    for pair, solution in solutions.items():
        if solution.course is not None:
            name = ", ".join([*(part for part in pair if part), f"{_lift_name(solution.lift)}"])
            plan = lift_plan(solution.course, STEP)
            yield _followed(scene_of(scenes, pair), name, robot, plan, feedback)


def _lift_name(lift: Lift) -> str:
    return f"{lift} ({lift.knots} knots)"


def _followed(scene: Scene, name: str, robot: Tree, plan: Plan, feedback: Feedback) -> SimulatedCase:
    trees = {each.name: robot if each.designed else each.tree for each in scene.agents}
    rollout = rolled_out(scene.undisturbed, trees, plan, feedback)
    return SimulatedCase(scene, name, trees, plan, rollout, outcome_of(plan, rollout))
