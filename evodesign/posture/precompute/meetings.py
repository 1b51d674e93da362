"""Which bodies come near each other in postures: the pairs that get rows in programs.

Some designs hold the load at the task's heights, and as high and as low as they can, with bodies that pass
through everything. What comes near has to be kept apart; pairs that never do would only cost time. A posture
in which another pair overlaps is refused by the check.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from evodesign.collision.clearance import BodyDistance
from evodesign.collision.rules import FLOOR, LOAD, PARTNER, BodyPair, CollisionRules
from evodesign.collision.scene_bodies import SceneBodies
from evodesign.mechanics.disturbance import Disturbances
from evodesign.mechanics.scene import HUMAN, ROBOT, Agent, Scene
from evodesign.nlp.method import MethodName
from evodesign.nlp.solver import SolverCache
from evodesign.nlp.start_portfolio import spread_designs
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.tasks import Task

_Posed = tuple[tuple[float, ...], Mapping[str, AgentPosture], float]
"""A design, its postures and the load's height [m]."""

__all__ = ["REACH", "found_meetings", "with_meetings"]

REACH = "reach"
"""Whose pairs are the robot's at extreme heights, beside those of the agents."""

DESIGNS = 16
"""Whose postures are looked at."""

NEAR, AT_REACH = 0.03, 0.002
"""Distances [m] below which bodies are near, at the task's heights and at extreme ones."""

ROUNDS = 16
"""How often the pair that overlaps most in the lowest posture of each design is added."""


def found_meetings(setting: Setting, tasks: Sequence[Task], *, symmetric: bool) -> dict[str, list[BodyPair]]:
    """Pairs that come near each other, by agent name or `REACH`, in the order of the check.

    In the full fold of the lowest loads everything passes through everything, and a few rows part it all:
    there the pair that overlaps most is kept apart, then the one that does so still, and so on.
    """
    finder = _Finder(setting, symmetric=symmetric)
    scene = finder.scene
    found: dict[str, set[BodyPair]] = {ROBOT: set(), HUMAN: set()}
    for values, postures, height in finder.held(tasks):
        for agent, pair, _ in finder.near(values, postures, height, NEAR):
            found[agent].add(pair)
    kept = {pair for near in finder.at_reach(HIGHEST, set()) for pair in near}
    for _ in range(ROUNDS):
        near = finder.at_reach(LOWEST, kept)
        more = {min(pairs, key=lambda pair: (pairs[pair], pair)) for pairs in near if pairs} - kept
        if not more:
            break
        kept |= more
    return {
        ROBOT: _in_order(scene.robot, found[ROBOT], finder.forms[0]),
        REACH: _in_order(scene.robot, kept, finder.forms[0]),
        HUMAN: _in_order(scene.human, found[HUMAN], finder.forms[1]),
    }


class _Finder:
    """Postures of some designs, and what is near in them."""

    def __init__(self, setting: Setting, *, symmetric: bool) -> None:
        scene = setting.scene
        free = replace(
            scene,
            robot=replace(scene.robot, collisions=None),
            human=replace(scene.human, collisions=None),
            disturbances=Disturbances(),
        )
        options = replace(setting.options, compiled=False, method=MethodName.IPOPT)
        self.scene = scene
        self.forms = symmetric_forms(free) if symmetric else (whole(free.robot), whole(free.human))
        self._setting, self._symmetric = replace(setting, scene=free, options=options), symmetric
        self._robot, self._human = (AgentModel.of(agent, agent.tree) for agent in (scene.robot, scene.human))
        space = setting.space

        def given(genome: tuple[float, ...]) -> tuple[float, ...]:
            return space.given(space.values(genome), {})

        self._designs = [*spread_designs(len(space.parameters), given, lambda _: True, DESIGNS)]

    def held(self, tasks: Sequence[Task]) -> Iterator[_Posed]:
        """Of the tasks."""
        name, space = "symmetric" if self._symmetric else "whole", self._setting.space
        scene = self._setting.scene
        problem = JointPostures(name, self.forms, self._setting, SolverCache())
        human = AgentModel.of(scene.human, scene.human.tree)
        for values in self._designs:
            robot = AgentModel.of(scene.robot, space.resized(scene.robot.tree, values))
            checker = Checker(scene, robot, human)
            for task in tasks:
                best = problem.solve(values, task, (), checker).best
                for instant, height in zip(best.instants if best else (), task.heights, strict=False):
                    yield values, instant.postures, height

    def at_reach(self, sense: float, parted: Collection[BodyPair]) -> list[dict[BodyPair, float]]:
        """The robot's pairs that are near in the extreme posture of each design, with their distances [m].

        Args:
            sense: of the reach problem.
            parted: pairs that are kept apart.
        """
        scene, rules = self._setting.scene, self.scene.robot.collisions
        if rules is not None:
            pairs = _in_order(self.scene.robot, set(parted), self.forms[0])
            rules = replace(rules, parted_at_reach=tuple(pairs))
            scene = replace(scene, robot=replace(scene.robot, collisions=rules))
        problem = ReachProblem(replace(self._setting, scene=scene), symmetric=self._symmetric)
        found: list[dict[BodyPair, float]] = []
        for values in self._designs:
            height, raw = problem.extreme(values, sense)
            if height is not None:
                parts = {name.partition(".")[2]: value for name, value in raw.values.items()}
                near = self.near(values, {ROBOT: self.forms[0].expand(parts)}, height, AT_REACH)
                found.append({pair: distance for _, pair, distance in near})
        return found

    def near(
        self, values: tuple[float, ...], postures: Mapping[str, AgentPosture], height: float, within: float
    ) -> Iterator[tuple[str, BodyPair, float]]:
        """Agent, pair and distance [m] of those that are nearer than a distance [m]."""
        robot = self._robot.resized(self._setting.space.resized(self.scene.robot.tree, values))
        models = {name: {ROBOT: robot, HUMAN: self._human}[name] for name in postures}
        solids = {name: model.solid for name, model in models.items() if model.solid is not None}
        poses = {
            name: (models[name].agent.sign, models[name].at(each).pose) for name, each in postures.items()
        }
        for gap in SceneBodies(solids, self.scene.payload.size).near(poses, height, within):
            for agent, pair in _own_pairs(gap):
                yield agent, pair, gap.distance


def _own_pairs(gap: BodyDistance) -> Iterator[tuple[str, BodyPair]]:
    """The pair as those see it whom it is of, by agent: who is near the other one keeps to its own side."""
    agent, _, link = gap.first.partition(" ")
    if gap.second in (LOAD, FLOOR):
        yield agent, (link, gap.second)
        return
    other, _, second = gap.second.partition(" ")
    if other == agent:
        yield agent, (link, second)
    else:
        yield agent, (link, PARTNER)
        yield other, (second, PARTNER)


def _in_order(agent: Agent, found: set[BodyPair], form: Form) -> list[BodyPair]:
    """Pairs and their mirror images, as they are checked."""
    checked = agent.collisions.checked if agent.collisions else ()
    if form.mirror is not None:
        links = form.mirror.links
        found = found | {(links.get(one, one), links.get(other, other)) for one, other in found}
    return [pair for pair in checked if pair in found or pair[::-1] in found]


def with_meetings(scene: Scene, found: Mapping[tuple[str, str], Sequence[BodyPair]]) -> Scene:
    """A scene whose agents part the pairs that were found, by agent name and label.

    Everyone parts the pairs of all people, so that starts of one fit the others.
    """

    def rows(rules: CollisionRules, name: str) -> tuple[BodyPair, ...]:
        near = {
            *rules.parted,
            *(pair for (agent, _), pairs in found.items() if agent == name for pair in pairs),
        }
        return tuple(pair for pair in rules.checked if pair in near)

    def parted(agent: Agent) -> Agent:
        rules = agent.collisions
        if rules is None:
            return agent
        return replace(
            agent,
            collisions=replace(rules, parted=rows(rules, agent.name), parted_at_reach=rows(rules, REACH)),
        )

    return replace(scene, robot=parted(scene.robot), human=parted(scene.human))
