"""Where a design's robot is pushed: in which holds and lifts, at which moments, with all or alone.

Pushed are the lowest and the highest hold with every person and load, and two moments of every lift. Alone a
robot holds nothing, stands as in the plan (of a lift: at its beginning), and brings its centre of mass above
the middle of its soles before it is pushed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from evodesign.control.gains import Feedback
from evodesign.control.moving_body import MovingBody
from evodesign.control.target import Target, lift_targets, target_of
from evodesign.errors import InputError, ModelError
from evodesign.mechanics.agent import ROBOT
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.motion.course import LiftCourse
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import PARALLEL, Form, symmetric_forms
from evodesign.records import Case
from evodesign.simulation.controlled import ControlledScene, Targets, Timing
from evodesign.simulation.engine import EngineMaker
from evodesign.simulation.mujoco_engine import MujocoEngine
from evodesign.simulation.push import PushTest
from evodesign.simulation.pushable import refuse_unpushable
from evodesign.tasks import Hold
from evodesign.tree.model import Tree

SETTLING = 0.1
"""Before a push in a hold [s]: contacts have taken the weight."""

SHIFTING = 3.0
"""Before a push on a robot alone at most [s]: it comes above its soles."""

ABOVE = 1e-3
"""Nearer than this is its capture point then [m]."""

LIFT_SHARES = (1.0 / 3.0, 2.0 / 3.0)
"""Of a lift's time at which it is pushed."""


@dataclass(frozen=True, slots=True)
class PushConditions:
    """How everything is that a plan does not say.

    Args:
        feedback: of the controllers.
        timing: of the controllers.
        friction: of the floor, as a factor.
        mass: of the load, as a factor; controllers know nothing of either.
        engine: that moves everything.
    """

    feedback: Feedback = field(default_factory=Feedback)
    timing: Timing = field(default_factory=Timing)
    friction: float = 1.0
    mass: float = 1.0
    engine: EngineMaker = MujocoEngine

    def changed(self, scene: Scene) -> Scene:
        """The scene as it is."""
        ground = replace(scene.ground, friction=self.friction * scene.ground.friction)
        payload = replace(scene.payload, mass=self.mass * scene.payload.mass)
        return replace(scene, ground=ground, payload=payload)


def pushed_cases(cases: Sequence[Case]) -> tuple[Case, ...]:
    """In which a robot is pushed: the lowest and highest hold of every person and load, and all lifts."""
    holds: dict[tuple[str, str], list[Case]] = {}
    for case in cases:
        if isinstance(case.task, Hold):
            holds.setdefault(case.pair, []).append(case)
    ends = [end(own, key=lambda case: case.task.heights[0]) for own in holds.values() for end in (min, max)]
    return tuple(case for case in cases if case in ends or not isinstance(case.task, Hold))


@dataclass(frozen=True, slots=True, eq=False)
class PushedPlan:
    """A hold or lift of a design in which its robot is pushed.

    Args:
        name: of the case.
        scene: undisturbed.
        trees: of agents by name, of a design.
        postures: by agent name, with which it begins.
        height: of the load's centre then [m].
        course: of a lift; None of a hold.
    """

    name: str
    scene: Scene
    trees: Mapping[str, Tree]
    postures: Mapping[str, AgentPosture]
    height: float
    course: LiftCourse | None = None

    @classmethod
    def hold(
        cls,
        scenes: Iterable[Scene],
        robot: Tree,
        case: Case,
        postures: Mapping[str, AgentPosture],
        height: float,
    ) -> PushedPlan:
        """A case with its postures.

        Args:
            scenes: of the problem.
            robot: the design's tree.
            case: of the problem.
            postures: by agent name, in the case or at its beginning.
            height: of the load's centre then [m].
        Raises:
            InputError: nobody can be pushed in it.
        """
        scene = scene_of(scenes, case.pair).undisturbed
        refuse_unpushable(scene)
        trees = {each.name: robot if each.designed else each.tree for each in scene.agents}
        return cls(case.name, scene, trees, postures, height)

    @classmethod
    def lift(cls, scenes: Iterable[Scene], robot: Tree, case: Case, course: LiftCourse) -> PushedPlan:
        """A case with its motion; arguments and errors as of a hold."""
        first = course.instants([0.0])[0].postures
        held = cls.hold(scenes, robot, case, first, float(course.heights(np.zeros(1))[0]))
        return replace(held, course=course)

    @property
    def is_symmetric(self) -> bool:
        """Whether everybody and the load are their own mirror images, in a lift at all moments of pushes."""
        agents = (replace(each, tree=self.trees[each.name]) for each in self.scene.agents)
        try:
            forms = symmetric_forms(self.scene.with_agents(*agents))
        except ModelError:
            return False
        moments = [self.postures]
        if self.course is not None:
            times = [share * self.course.lift.seconds for share in (*LIFT_SHARES, 1.0)]
            moments += [instant.postures for instant in self.course.instants(times)]
        return all(_mirrors(form, postures[form.agent.name]) for postures in moments for form in forms)

    def tests(self, conditions: PushConditions, *, alone: bool = False) -> dict[str, PushTest]:
        """Pushes at each of its moments, by name.

        Args:
            conditions: of everything else.
            alone: whether the first robot stands alone, with which it begins.
        """
        if alone:
            return {self.name: self._alone(conditions)}
        if self.course is None:
            return {self.name: self._held(conditions)}
        return self._lifted(self.course, conditions)

    def _held(self, conditions: PushConditions) -> PushTest:
        targets = {
            agent.name: target_of(MovingBody(agent, self.trees[agent.name]), self.postures[agent.name])
            for agent in self.scene.agents
        }
        controlled = self.controlled(lambda _: targets, conditions)
        _advance(controlled, SETTLING)
        return PushTest(
            controlled, np.array([self.height]), controlled.snapshot(), is_symmetric=self.is_symmetric
        )

    def _alone(self, conditions: PushConditions) -> PushTest:
        robot = replace(self.scene.robot, contacts=self.scene.robot.feet)
        body, own = MovingBody(robot, self.trees[robot.name]), self.postures[robot.name]
        posture = replace(own, wrenches={foot.name: own.wrenches[foot.name] for foot in robot.feet})
        target = target_of(body, posture)
        feet = body.at(target.coordinates, target.velocity).feet
        middle = np.mean([foot.place for foot in feet], axis=0)
        place = np.array([*middle[:2], target.center.place[2]])
        weight = np.array([0.0, 0.0, body.total * GRAVITY / len(feet), 0.0, 0.0, 0.0])
        center, wrenches = replace(target.center, place=place), np.tile(weight, (len(feet), 1))
        standing = {robot.name: replace(target, center=center, feet_wrenches=wrenches)}
        single = replace(self, scene=self.scene.only(robot), postures={robot.name: posture}, height=0.0)
        controlled = single.controlled(lambda _: standing, conditions)
        _advance(controlled, SETTLING)
        while controlled.number * conditions.timing.step < SHIFTING:
            if np.linalg.norm(controlled.advance()[robot.name].capture) < ABOVE:
                break
        return PushTest(controlled, None, controlled.snapshot(), is_symmetric=self.is_symmetric)

    def _lifted(self, course: LiftCourse, conditions: PushConditions) -> dict[str, PushTest]:
        step, seconds = conditions.timing.step, course.lift.seconds
        times = np.minimum(step * np.arange(int(np.ceil(seconds / step)) + 1), seconds)
        bodies = [MovingBody(agent, self.trees[agent.name]) for agent in self.scene.agents]
        planned, heights = lift_targets(bodies, course, times), course.heights(times)

        def targets(number: int) -> Mapping[str, Target]:
            return {name: each[min(number, len(times) - 1)] for name, each in planned.items()}

        tests: dict[str, PushTest] = {}
        controlled, mirrored = self.controlled(targets, conditions), self.is_symmetric
        for share in LIFT_SHARES:
            _advance(controlled, share * seconds - controlled.number * step)
            name = f"{self.name}, after {share * seconds:.2g} s"
            tests[name] = PushTest(controlled, heights, controlled.snapshot(), is_symmetric=mirrored)
        return tests

    def controlled(self, targets: Targets, conditions: PushConditions) -> ControlledScene:
        """Everything at the beginning, under controllers.

        Args:
            targets: of the controllers.
            conditions: of everything else.
        """
        return ControlledScene(
            conditions.changed(self.scene),
            self.trees,
            self.postures,
            self.height,
            targets,
            conditions.feedback,
            conditions.timing,
            planned=self.scene,
            engine=conditions.engine,
        )


@dataclass(frozen=True, slots=True)
class PushedDesign:
    """Everything in which the robot of a design is pushed.

    Args:
        plans: its holds and lifts.
        alone: whether the robot stands alone.
    """

    plans: tuple[PushedPlan, ...]
    alone: bool = False

    def __post_init__(self) -> None:
        """Refuse what has no moment.

        Raises:
            InputError: there is no plan.
        """
        if not self.plans:
            raise InputError("push", "", "a hold or a lift that was found", "none")

    @property
    def mass(self) -> float:
        """Of the robot [kg]."""
        return float(self.plans[0].trees[ROBOT].mass)

    def tests(self, conditions: PushConditions) -> dict[str, PushTest]:
        """Pushes at every moment, by its name."""
        return {
            name: test
            for plan in self.plans
            for name, test in plan.tests(conditions, alone=self.alone).items()
        }


def _mirrors(form: Form, posture: AgentPosture) -> bool:
    """Whether a posture, its torques and its wrenches are what their half says."""
    own, found = _numbers(form.expand(form.parts(posture))), _numbers(posture)
    return all(np.allclose(own[name], each, 0.0, PARALLEL) for name, each in found.items())


def _numbers(posture: AgentPosture) -> dict[str, Any]:
    torques = {f"torque of {joint}": torque for joint, torque in posture.torques.items()}
    base = np.concatenate([posture.base_position, posture.base_angles])
    return {"base": base, **posture.joints, **torques, **posture.wrenches}


def _advance(scene: ControlledScene, seconds: float) -> None:
    for _ in range(round(seconds / scene.timing.step)):
        scene.advance()
