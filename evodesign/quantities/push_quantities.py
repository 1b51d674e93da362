"""Quantities of pushes on the robot's trunk, simulated under whole-body controllers (docs/control.md).

    push_margin         the largest impulse that is survived, the least of eight directions [N s]
    push_margin_alone   the same of the robot without load and people
    load_tracking       largest distance of the load from its path after the problem's push, any direction [m]
    torque_saturation   largest share of the time after it in which a motor is at its limit [1]
    recovery_seconds    longest time from it until everything is back [s], at most `WATCHED_SECONDS`

Moments are the lowest and highest hold with every person and load, and two of each lift. Simulations take
seconds: they are run for designs alone that keep every other constraint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from evodesign.control.gains import Feedback
from evodesign.control.limits import WATCHED_SECONDS
from evodesign.mechanics.agent import ROBOT
from evodesign.motion.solution import MotionCase
from evodesign.records import Constraint, Objective
from evodesign.tasks import Hold
from evodesign.tree.model import Tree

if TYPE_CHECKING:
    from evodesign.quantities.design_result import DesignResult
    from evodesign.simulation.push import PushOutcome, PushTest

MARGIN, ALONE, TRACKING = "push_margin", "push_margin_alone", "load_tracking"
SATURATION, RECOVERY = "torque_saturation", "recovery_seconds"

SIMULATED = (MARGIN, ALONE, TRACKING, SATURATION, RECOVERY)
"""Quantities that take simulations."""


Named = TypeVar("Named", Objective, Constraint)


def unsimulated(quantities: Sequence[Named]) -> tuple[Named, ...]:
    """Those among them that take no simulations."""
    return tuple(each for each in quantities if each.name not in SIMULATED)


@dataclass(frozen=True, slots=True)
class PushSettings:
    """What `[push]` of a problem says.

    Args:
        impulse: of the push after which the load is tracked [N s].
        feedback: of all controllers.
    """

    impulse: float
    feedback: Feedback


class DesignPushes:
    """Simulated pushes of one design; what was found of it is kept.

    Args:
        settings: of the problem.
    """

    def __init__(self, settings: PushSettings) -> None:
        self._settings = settings
        self._tree: Tree | None = None
        self._margins: dict[str, float | None] = {}
        self._outcomes: list[PushOutcome] = []

    def margin(self, result: DesignResult, *, alone: bool = False) -> float | None:
        """The least impulse [N s] of all moments and directions; None where a case is not solved."""
        self._of(result)
        name = ALONE if alone else MARGIN
        if name not in self._margins:
            from evodesign.simulation.push_margin import least_margin

            tests = self._tests(result, alone=alone)
            found = least_margin(tests, ROBOT, float(result.tree.mass))
            self._margins[name] = None if found is None else found.impulse
        return self._margins[name]

    def outcomes(self, result: DesignResult) -> list[PushOutcome]:
        """What the problem's push does in each direction at every moment."""
        self._of(result)
        if not self._outcomes:
            from evodesign.simulation.push import Push
            from evodesign.simulation.push_margin import DIRECTIONS

            self._outcomes = [
                test.pushed(Push(self._settings.impulse, direction))
                for test in self._tests(result).values()
                for direction in DIRECTIONS
            ]
        return self._outcomes

    def _of(self, result: DesignResult) -> None:
        """Forget another design."""
        if self._tree is not result.tree:
            self._tree, self._margins, self._outcomes = result.tree, {}, []

    def _tests(self, result: DesignResult, *, alone: bool = False) -> Mapping[str, PushTest]:
        from evodesign.simulation.pushed_plan import PushConditions, alone_test, hold_test, lift_tests

        conditions = PushConditions(self._settings.feedback)
        found: dict[str, PushTest] = {}
        for case in result.cases if all(each.solved for each in result.cases) else ():
            scene, task = result.scene_of(case.case).undisturbed, case.case.task
            trees = {each.name: result.tree if each.designed else each.tree for each in scene.agents}
            heights = [each.case.task.heights[0] for each in result.cases if each.case.pair == case.case.pair]
            if isinstance(task, Hold) and task.height_m in (min(heights), max(heights)):
                found[case.case.name] = (
                    alone_test(scene, trees, case.postures, conditions)
                    if alone
                    else hold_test(scene, trees, case.postures, task.height_m, conditions)
                )
            elif isinstance(case, MotionCase) and case.motion is not None and case.motion.course is not None:
                if alone:
                    found[case.case.name] = alone_test(scene, trees, case.instants[0].postures, conditions)
                    continue
                tests = lift_tests(scene, trees, case.motion.course, conditions)
                found |= {f"{case.case.name} after {time:.3g} s": test for time, test in tests.items()}
        return found


def push_margin(result: DesignResult) -> float | None:
    """The largest push that robot, people and load survive [N s]; None without `[push]` or a hold or lift."""
    return None if result.pushes is None else result.pushes.margin(result)


def push_margin_alone(result: DesignResult) -> float | None:
    """The largest push that the robot survives without load and people [N s], likewise."""
    return None if result.pushes is None else result.pushes.margin(result, alone=True)


def load_tracking(result: DesignResult) -> float | None:
    """Largest distance of the load from its path after the problem's push [m]."""
    return max((each.load_off for each in _outcomes(result)), default=None)


def torque_saturation(result: DesignResult) -> float | None:
    """Largest share of the time after the problem's push in which a motor is at its limit [1]."""
    return max((each.saturation for each in _outcomes(result)), default=None)


def recovery_seconds(result: DesignResult) -> float | None:
    """Longest time after the problem's push until everything is back, or for which that is awaited [s]."""
    times = [each.recovery for each in _outcomes(result)]
    return max((WATCHED_SECONDS if time is None else time for time in times), default=None)


def _outcomes(result: DesignResult) -> list[PushOutcome]:
    return [] if result.pushes is None else result.pushes.outcomes(result)
