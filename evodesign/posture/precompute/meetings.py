"""Which bodies come near each other in postures: the pairs that get rows in programs.

Some designs hold the load at the task's heights, and as high and as low as they can, with bodies that pass
through everything. What comes near has to be kept apart; pairs that never do would only cost time. A posture
in which another pair overlaps is refused by the check.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import islice, product

from evodesign.collision.rules import BodyPair, CollisionRules
from evodesign.design.spread import spread_designs
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import SolverCache
from evodesign.posture.check import AgentModel, Checker, near_bodies, own_pairs
from evodesign.posture.design_checkers import can_be_built, with_hardware
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form, forms_of
from evodesign.tasks import Task

_Met = tuple[str, BodyPair]
"""A pair, after whom it is of."""

_Values = tuple[float, ...]
"""What programs are given of a design."""

_Near = dict[_Met, float]
"""Pairs of a posture with their distances [m]."""

REACH = "reach"
"""Whose pairs are the robot's at extreme heights, beside those of the agents."""

DESIGNS, FEWEST = 8, 4
"""Whose postures are looked at: designs all over the space, with all people and loads together, and at least
with each; and as many at its corners, where searches end."""

LOOKED_AT = 8
"""How many times as many designs are looked at, at most, as many cannot be built."""

NEAR, APART = 0.03, 0.002
"""Distances [m] below which bodies are near each other, and hardly apart."""


def found_meetings(
    setting: Setting,
    tasks: Sequence[Task],
    *,
    symmetric: bool,
    extreme: bool = True,
    part: int = 0,
    parts: int = 1,
) -> dict[str, list[BodyPair]]:
    """Pairs that meet, by agent name or `REACH`, in the order of the check.

    Bodies pass through everything in the postures that are looked at. What is near each other there at the
    tasks' heights, or in each other, is kept apart, and what of the robot overlaps at the highest and the
    lowest load that are asked for.

    Args:
        setting: of one person and load.
        tasks: of the problem.
        symmetric: whether postures are.
        extreme: whether postures at extreme heights are looked at.
        part: of the designs that are looked at.
        parts: how many there are.
    """
    finder = _Finder(setting, symmetric, part, parts)
    scene = finder.scene
    met = finder.held(tasks) | (finder.at_extremes() if extreme and scene.robots else set())
    forms = {form.agent.name: form for form in finder.forms}
    agents = {agent.name: agent for agent in scene.agents}
    if scene.robots:
        agents = {REACH: scene.robot, **agents}
    return {
        name: _in_order(agent, {pair for of, pair in met if of == name}, forms[agent.name])
        for name, agent in agents.items()
    }


class _Finder:
    """Postures of some designs, and what is near in them."""

    def __init__(self, setting: Setting, symmetric: bool, part: int, parts: int) -> None:
        scene = setting.scene
        free = replace(
            scene.undisturbed,
            agents=tuple(replace(agent, collisions=None) for agent in scene.agents),
        )
        options = replace(setting.options, seldom=True)
        self.scene, self._free = scene, free
        self.forms = forms_of(free, symmetric=symmetric)
        self._setting, self._symmetric = replace(setting, scene=free, options=options), symmetric
        self._models = [AgentModel.of(agent, agent.tree) for agent in scene.agents]
        space = setting.space
        built = can_be_built(scene, space)

        def own(of: Callable[[float], float]) -> list[_Values]:
            def given(point: tuple[float, ...]) -> _Values:
                return space.given(space.values(tuple(map(of, point))), {})

            count = max(DESIGNS, FEWEST * parts)
            every = spread_designs(len(space.free), given, built, LOOKED_AT * count)
            return [*islice(every, count)][part::parts]

        self._designs = [*own(float), *own(lambda place: float(round(place)))]

    def held(self, tasks: Sequence[Task]) -> set[_Met]:
        """What is near in postures of the tasks."""
        name, scene, space = "symmetric" if self._symmetric else "whole", self._free, self._setting.space
        problem = JointPostures(name, self.forms, self._setting, SolverCache())
        models = [AgentModel.of(agent, agent.tree) for agent in scene.agents]
        found: set[_Met] = set()
        for values in self._designs:
            checker = Checker(scene, *with_hardware(models, space.resized(scene.designed_tree, values)))
            for task in tasks:
                best = problem.solve(values, task, problem.starts(task), checker).best
                for instant, height in zip(best.instants if best else (), task.heights, strict=False):
                    found |= self._near(values, instant.postures, height).keys()
        return found

    def at_extremes(self) -> set[_Met]:
        """What of the robot overlaps in each design's postures at the highest and the lowest load."""
        problem = ReachProblem(self._setting, symmetric=self._symmetric)
        found: set[_Met] = set()
        for values, sense in product(self._designs, (HIGHEST, LOWEST)):
            height, raw = problem.extreme(values, sense)
            if height is not None:
                parts = {name.partition(".")[2]: value for name, value in raw.values.items()}
                near = self._near(values, {ROBOT: self.forms[0].expand(parts)}, height)
                found |= {(REACH, pair) for (_, pair), apart in near.items() if apart < APART}
        return found

    def _near(self, values: tuple[float, ...], postures: Mapping[str, AgentPosture], height: float) -> _Near:
        """The pairs that are near, with their distances [m]."""
        models = with_hardware(self._models, self._setting.space.resized(self.scene.designed_tree, values))
        gaps = near_bodies(models, postures, self.scene.payload.size, height, NEAR)
        return {met: gap.distance for gap in gaps for met in own_pairs(gap)}


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

    return replace(scene, agents=tuple(parted(agent) for agent in scene.agents))
