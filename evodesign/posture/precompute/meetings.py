"""Which bodies come near each other in postures: the pairs that get rows in programs.

Some designs hold the load at the task's heights, and as high and as low as they can, with bodies that pass
through everything. What comes near has to be kept apart; pairs that never do would only cost time. A posture
in which another pair overlaps is refused by the check.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice

from evodesign.collision.clearance import BodyDistance
from evodesign.collision.rules import FLOOR, LOAD, PARTNER, BodyPair, CollisionRules
from evodesign.mechanics.scene import HUMAN, ROBOT, Agent, Scene
from evodesign.nlp.landscape import spread_designs
from evodesign.nlp.method import MethodName
from evodesign.nlp.solver import SolverCache
from evodesign.posture.check import AgentModel, Checker, near_bodies
from evodesign.posture.design_checkers import can_be_built
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form, symmetric_forms, whole
from evodesign.tasks import Task

_Met = tuple[str, BodyPair]
"""A pair, after whom it is of."""

_Values = tuple[float, ...]
"""What programs are given of a design."""

_Near = dict[_Met, float]
"""Pairs of a posture with their distances [m]."""

__all__ = ["REACH", "found_meetings", "with_meetings"]

REACH = "reach"
"""Whose pairs are the robot's at extreme heights, beside those of the agents."""

DESIGNS, AT_CORNERS, AT_REACH, FEWEST = 28, 28, 12, 4
"""Whose postures are looked at: designs all over the space at the tasks, those at its corners, where searches
end, and at extreme heights; with all people and loads together, and at least with each."""

LOOKED_AT = 8
"""How many times as many designs are looked at, at most, as many cannot be built."""

WHOLE_SHARE = 0.3
"""Of these where postures are whole: solves take ten times as long."""

NEAR, APART = 0.03, 0.002
"""Distances [m] below which bodies are near each other, and hardly apart."""

ROUNDS = 16
"""How often the pair that overlaps most in a posture is added."""


def found_meetings(
    setting: Setting, tasks: Sequence[Task], *, symmetric: bool, part: int = 0, parts: int = 1
) -> dict[str, list[BodyPair]]:
    """Pairs that meet, by agent name or `REACH`, in the order of the check.

    In a fold everything passes through everything, and a few rows part it all: the pair that overlaps most in
    each posture is kept apart, then the one that does so still, and so on. At the task's heights those that
    are near each other in the end are kept apart as well. Where solves are dear, what overlaps at corners of
    the space is added; elsewhere that took more from the quality of postures than it gave.

    Args:
        setting: of one person and load.
        tasks: of the problem.
        symmetric: whether postures are.
        part: of the designs that are looked at.
        parts: how many there are.
    """
    finder = _Finder(setting, symmetric, part, parts)
    scene = finder.scene
    held, near = _deepest_first(lambda kept, left: finder.held(finder.spread, tasks, kept, left))
    held |= near
    if scene.is_dear:
        held, _ = _deepest_first(lambda kept, left: finder.held(finder.corners, tasks, kept, left), held)
    highest = {met for pairs in finder.at_reach(HIGHEST, set()).values() for met in _overlapping(pairs)}
    lowest, _ = _deepest_first(lambda kept, left: finder.at_reach(LOWEST, kept), highest)
    met = {*held, *lowest}
    found = {name: {pair for of, pair in met if of == name} for name in (ROBOT, HUMAN, REACH)}
    return {
        ROBOT: _in_order(scene.robot, found[ROBOT], finder.forms[0]),
        REACH: _in_order(scene.robot, found[REACH], finder.forms[0]),
        HUMAN: _in_order(scene.human, found[HUMAN], finder.forms[1]),
    }


def _overlapping(pairs: _Near) -> list[_Met]:
    """Those that are hardly apart, the deepest overlap first."""
    return sorted((met for met in pairs if pairs[met] < APART), key=lambda met: (pairs[met], met))


def _deepest_first(
    looked_at: Callable[[Collection[_Met], Collection[Hashable] | None], Mapping[Hashable, _Near]],
    kept: Collection[_Met] = (),
) -> tuple[set[_Met], set[_Met]]:
    """Pairs, by whom they are of, that let none overlap when they are kept apart; and what is near then.

    Args:
        looked_at: what is near in each posture, from the pairs that are kept apart and the postures to look
            at; None for all.
        kept: pairs that are kept apart from the beginning.
    """
    found, latest = set(kept), dict[Hashable, _Near]()
    left: Collection[Hashable] | None = None
    for _ in range(ROUNDS):
        latest.update(looked_at(found, left))
        more: set[_Met] = set()
        for pairs in latest.values():
            deepest = {agent: (agent, pair) for agent, pair in reversed(_overlapping(pairs))}
            more.update(deepest.values())
        if not more - found:
            break
        found |= more
        left = [posture for posture, pairs in latest.items() if _overlapping(pairs)]
    return found, {met for pairs in latest.values() for met in pairs}


class _Finder:
    """Postures of some designs, and what is near in them."""

    def __init__(self, setting: Setting, symmetric: bool, part: int, parts: int) -> None:
        scene = setting.scene
        free = replace(
            scene.undisturbed,
            robot=replace(scene.robot, collisions=None),
            human=replace(scene.human, collisions=None),
        )
        options = replace(setting.options, compiled=False, method=MethodName.IPOPT)
        self.scene = scene
        self.forms = symmetric_forms(free) if symmetric else (whole(free.robot), whole(free.human))
        self._setting, self._symmetric = replace(setting, scene=free, options=options), symmetric
        self._robot, self._human = (AgentModel.of(agent, agent.tree) for agent in (scene.robot, scene.human))
        space = setting.space
        built = can_be_built(scene.robot, space)

        def given(genome: Sequence[float]) -> tuple[float, ...]:
            return space.given(space.values(tuple(genome)), {})

        def own(count: int, of: Callable[[Sequence[float]], Sequence[float]] = tuple) -> list[_Values]:
            all_together = max(int(count * (1.0 if symmetric else WHOLE_SHARE)), FEWEST * parts)
            dimension = len(space.parameters)
            looked_at = LOOKED_AT * all_together
            every = spread_designs(dimension, lambda point: given(of(point)), built, looked_at)
            return [*islice(every, all_together)][part::parts]

        self.spread, self._at_reach = own(DESIGNS), own(AT_REACH)
        self.corners = own(AT_CORNERS, lambda point: [float(round(each)) for each in point])

    def held(
        self,
        designs: Sequence[_Values],
        tasks: Sequence[Task],
        parted: Collection[_Met],
        left: Collection[Hashable] | None,
    ) -> dict[Hashable, _Near]:
        """What is near in postures of the tasks, by numbers of design and task.

        Args:
            designs: whose.
            tasks: of the problem.
            parted: pairs that are kept apart.
            left: the postures to look at; None for all.
        """
        name, space = "symmetric" if self._symmetric else "whole", self._setting.space
        free, scene = self._setting.scene, self._parting(parted)
        forms = symmetric_forms(scene) if self._symmetric else (whole(scene.robot), whole(scene.human))
        problem = JointPostures(name, forms, replace(self._setting, scene=scene), SolverCache())
        human = AgentModel.of(free.human, free.human.tree)
        found: dict[Hashable, _Near] = {}
        for number, values in enumerate(designs):
            robot = AgentModel.of(free.robot, space.resized(free.robot.tree, values))
            checker = Checker(free, robot, human)
            for place, task in enumerate(tasks):
                if left is not None and (number, place) not in left:
                    continue
                best = problem.solve(values, task, (), checker).best
                for instant, height in zip(best.instants if best else (), task.heights, strict=False):
                    near = self.near(values, instant.postures, height)
                    found.setdefault((number, place), {}).update(near)
        return found

    def at_reach(self, sense: float, parted: Collection[_Met]) -> dict[Hashable, _Near]:
        """What of the robot is near in the extreme posture of each design, by its number.

        Args:
            sense: of the reach problem.
            parted: pairs that are kept apart.
        """
        scene = self._parting(parted)
        problem = ReachProblem(replace(self._setting, scene=scene), symmetric=self._symmetric)
        found: dict[Hashable, _Near] = {}
        for number, values in enumerate(self._at_reach):
            height, raw = problem.extreme(values, sense)
            if height is not None:
                parts = {name.partition(".")[2]: value for name, value in raw.values.items()}
                near = self.near(values, {ROBOT: self.forms[0].expand(parts)}, height)
                found[number] = {(REACH, pair): distance for (_, pair), distance in near.items()}
        return found

    def _parting(self, pairs: Collection[_Met]) -> Scene:
        """The scene without collisions but for some pairs."""

        def parted(agent: Agent, form: Form) -> Agent:
            own, reach = (
                tuple(_in_order(agent, {pair for of, pair in pairs if of == name}, form))
                for name in (agent.name, REACH)
            )
            if agent.collisions is None or not (own or reach):
                return replace(agent, collisions=None)
            return replace(agent, collisions=replace(agent.collisions, parted=own, parted_at_reach=reach))

        robot, human = (
            parted(agent, form)
            for agent, form in zip((self.scene.robot, self.scene.human), self.forms, strict=True)
        )
        return replace(self._setting.scene, robot=robot, human=human)

    def near(self, values: tuple[float, ...], postures: Mapping[str, AgentPosture], height: float) -> _Near:
        """The pairs that are near, with their distances [m]."""
        robot = self._robot.resized(self._setting.space.resized(self.scene.robot.tree, values))
        gaps = near_bodies((robot, self._human), postures, self.scene.payload.size, height, NEAR)
        return {met: gap.distance for gap in gaps for met in _own_pairs(gap)}


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
