"""The `[collisions]` table: which bodies of robot and people keep clear of each other."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import combinations

from evodesign.collision.clearance import SolidBodies
from evodesign.collision.margins import fitted_margins, narrow_margins
from evodesign.collision.pairs import built_in_pairs, checked_pairs, exempt_pairs, feet_pairs
from evodesign.collision.rules import LOAD, PLANES, BodyPair, CollisionRules
from evodesign.design.space import DesignSpace
from evodesign.design.spread import spread_designs
from evodesign.errors import InputError
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.scene import Scene
from evodesign.problem.file import ProblemFile
from evodesign.problem.task_tables import CollisionsTable
from evodesign.problem.unknown_names import refuse_unlisted
from evodesign.records import ProblemSource
from evodesign.tree.model import Tree

DESIGNS = 16
"""Of which it is asked what their build brings together, beside the least and the largest one."""

OTHERWISE = "ignored by the file, or exempt in another person"


def with_collisions(
    tables: ProblemFile, source: ProblemSource, scenes: tuple[Scene, ...], space: DesignSpace
) -> tuple[Scene, ...]:
    """The scenes with what their agents' bodies keep clear of; as they are where nothing is asked for.

    Raises:
        InputError: a pair of unknown names, or one that is ignored and parted.
    """
    table = tables.collisions
    if table is None:
        return scenes
    known: dict[int, Agent] = {}
    for scene in scenes:
        for agent in scene.agents:
            if id(agent) not in known:
                frames = tuple(agent.hand_frames), tuple(agent.foot_frames)
                designed = space if agent.designed else None
                rules = _rules(table, agent.tree, tuple(agent.joints), *frames, designed)
                known[id(agent)] = replace(agent, collisions=rules)
    _refuse_unknown(table, source, [*known.values()])
    known = {key: _as_everyone(agent, known.values()) for key, agent in known.items()}
    return tuple(replace(scene, agents=tuple(known[id(agent)] for agent in scene.agents)) for scene in scenes)


def may_overlap(agent: Agent) -> Mapping[BodyPair, str]:
    """Pairs of an agent's links that may overlap where bodies keep clear of each other, with the reason."""
    kept = {frozenset(pair) for pair in agent.collisions.checked} if agent.collisions else set()
    reasons = exempt_pairs(agent.tree, agent.joints)
    links = dict.fromkeys(SolidBodies.of_tree(agent.tree).names)
    return {
        pair: reasons.get(pair, OTHERWISE) for pair in combinations(links, 2) if frozenset(pair) not in kept
    }


@lru_cache(maxsize=32)  # whoever builds a problem again, or another one with the same people, asks again
def _rules(
    table: CollisionsTable,
    tree: Tree,
    joints: tuple[str, ...],
    hands: tuple[str, ...],
    soles: tuple[str, ...],
    space: DesignSpace | None,
) -> CollisionRules:
    """What an agent keeps clear of; it has no space if it is not designed."""
    ignored = {frozenset(pair) for pair in table.ignore}
    checked = [pair for pair in checked_pairs(tree, joints, hands, soles) if frozenset(pair) not in ignored]
    resized = (space.resized(tree, values) for values in _designs(space)) if space else ()
    built_in = built_in_pairs(tree, joints, checked, resized, table.margin_m)
    built_in = tuple(pair for pair in built_in if frozenset(pair) not in ignored)
    own = {frozenset(pair): pair for pair in checked}
    names = {*tree.link_by_name}
    for pair in table.part:
        if pair[0] in names and (pair[1] in names or pair[1] == LOAD or pair[1] in PLANES):
            own.setdefault(frozenset(pair), pair)
    feet = feet_pairs(tree, joints, soles, checked)
    parted = (*feet, *(own[frozenset(pair)] for pair in table.part if frozenset(pair) in own))
    parted = tuple(dict.fromkeys(parted))
    narrow = {
        **narrow_margins(tree, [*own.values(), *built_in], table.margin_m),
        **fitted_margins(tree, joints, [pair for pair in own.values() if pair not in parted], table.margin_m),
    }
    return CollisionRules(table.margin_m, tuple(own.values()), parted, built_in=built_in, narrow=narrow)


def _as_everyone(agent: Agent, agents: Collection[Agent]) -> Agent:
    """Keeps clear of what all agents with the same links keep clear of: so starts of one fit the others."""
    own, links = agent.collisions, agent.tree.link_by_name.keys()
    others = [each.collisions for each in agents if each.tree.link_by_name.keys() == links]
    if own is None:
        return agent

    def shared(pairs: Sequence[BodyPair]) -> tuple[BodyPair, ...]:
        return tuple(pair for pair in pairs if all(pair in rules.checked for rules in others if rules))

    return replace(agent, collisions=replace(own, checked=shared(own.checked), parted=shared(own.parted)))


def _designs(space: DesignSpace) -> Iterator[tuple[float, ...]]:
    """Some designs, with the least and the largest one of all."""
    count = len(space.free)

    def given(genome: tuple[float, ...]) -> tuple[float, ...]:
        return space.given(space.values(genome), {})

    yield given((0.0,) * count)
    yield given((1.0,) * count)
    yield from spread_designs(count, given, lambda _: True, DESIGNS)


def _refuse_unknown(table: CollisionsTable, source: ProblemSource, agents: list[Agent]) -> None:
    """Refuse a pair that no agent has."""
    links = {link.name for agent in agents for link in agent.tree.links}
    for key, pairs in (("ignore", table.ignore), ("part", table.part)):
        for number, pair in enumerate(pairs):
            where = f"collisions.{key}[{number}]"
            for place, name in enumerate(pair):
                others, more = ({LOAD, *PLANES}, ", load, floor or partner") if place else (set(), "")
                wanted = f"a link of the robot or of a person{more}"
                refuse_unlisted(source.path, where, name, [*links, *others], wanted)
            if not any(_has(agent, pair) for agent in agents):
                wanted = "two links of one agent"
                raise InputError(source.path, where, wanted, f"'{pair[0]}' and '{pair[1]}'")
            if key == "part" and frozenset(pair) in {frozenset(each) for each in table.ignore}:
                found = f"'{pair[0]}' and '{pair[1]}' among those ignored"
                raise InputError(source.path, where, "a pair that is not ignored", found)


def _has(agent: Agent, pair: BodyPair) -> bool:
    names = agent.tree.link_by_name
    return pair[0] in names and (pair[1] in names or pair[1] == LOAD or pair[1] in PLANES)
