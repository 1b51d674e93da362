"""The bodies of robot, person and load in one world, and those that overlap or are near each other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np

from evodesign.body.placement import Vector
from evodesign.body.shape import Box
from evodesign.collision.clearance import BodyDistance, Indices, Places, SolidBodies, places_of
from evodesign.collision.rules import FLOOR, LOAD, BodyPair
from evodesign.collision.shapes import Array, box_solid
from evodesign.tree.model import Tree

PosesOf = Callable[[Sequence[str]], Array]
"""Rotation and origin [m] of some links, as matrices of shape (n, 4, 4)."""


@dataclass(frozen=True, slots=True, eq=False)
class CheckedBodies:
    """An agent's solids, of one design, and which of them must not overlap.

    Args:
        bodies: the solids, by agent and link.
        own: places of pairs among them.
        beside_load: those that must not touch the load.
        above_floor: those that must not touch the floor.
    """

    bodies: SolidBodies
    own: Places
    beside_load: Indices
    above_floor: Indices

    @classmethod
    def of(cls, tree: Tree, pairs: Sequence[BodyPair]) -> CheckedBodies:
        """Those of a tree of numbers.

        Args:
            tree: of the agent.
            pairs: that must not overlap.
        """
        bodies = SolidBodies.of_tree(tree)
        links = set(bodies.names)
        own = places_of(bodies.names, (pair for pair in pairs if links.issuperset(pair)))
        load, floor = (_places(bodies, (a for a, b in pairs if b == other)) for other in (LOAD, FLOOR))
        return cls(bodies, own, load, floor)

    def resized(self, tree: Tree) -> CheckedBodies:
        """The same with the tree of another design."""
        return replace(self, bodies=SolidBodies.of_tree(tree))


class SceneBodies:
    """The bodies of some agents, each in a design, and of the load: what must not overlap.

    Nothing of one agent must overlap with anything of another. Bodies are named by agent and link.

    Args:
        agents: their bodies, by name.
        load: sides of its box [m].
    """

    def __init__(self, agents: Mapping[str, CheckedBodies], load: Vector) -> None:
        checked = list(agents.values())
        self._links = {name: each.bodies.links for name, each in agents.items()}
        first = np.cumsum([0, *(len(each.bodies.names) for each in checked)]).tolist()
        box = SolidBodies((LOAD,), (box_solid(Box(*load)),))
        parts = [_named(name, each.bodies) for name, each in agents.items()]
        self._bodies = parts[0].beside(*parts[1:], box)
        own = [each.own + start for each, start in zip(checked, first, strict=False)]
        own += [
            _all(each.beside_load + start, np.array(first[-1:]))
            for each, start in zip(checked, first, strict=False)
        ]
        whole = [np.arange(start, end) for start, end in pairwise(first)]
        self._pairs = np.concatenate([*own, *(_all(one, other) for one, other in combinations(whole, 2))])
        low = [each.above_floor + start for each, start in zip(checked, first, strict=False)]
        self._above_floor = np.concatenate(low)

    def near(
        self, poses: Mapping[str, tuple[Array, PosesOf]], load_height: float, within: float = 0.0
    ) -> list[BodyDistance]:
        """Bodies that must not overlap and are nearer to each other than a distance.

        Args:
            poses: of each agent by name: the rotation that takes its frame to the world, and the poses of its
                links in its own frame.
            load_height: of the load's centre [m].
            within: the distance [m].
        """
        turns, origins = [], []
        for name, (turn, of) in poses.items():
            links, places = self._links[name]
            found = of(links).reshape(-1, 4, 4)[places]
            turns.append(turn @ found[:, :3, :3])
            origins.append(found[:, :3, 3] @ turn.T)
        turns.append(np.eye(3)[None])
        origins.append(np.array([[0.0, 0.0, load_height]]))
        placed = self._bodies.placed_at(np.concatenate(turns), np.concatenate(origins))
        return placed.overlapping(self._pairs, within) + placed.near_floor(self._above_floor, within)


def _named(agent: str, bodies: SolidBodies) -> SolidBodies:
    return bodies.named(lambda link: f"{agent} {link}")


def _places(bodies: SolidBodies, links: Iterable[str]) -> Indices:
    wanted = set(links)
    return np.array([place for place, name in enumerate(bodies.names) if name in wanted], np.intp)


def _all(one: Indices, other: Indices) -> Places:
    return np.stack(np.meshgrid(one, other, indexing="ij"), axis=-1).reshape(-1, 2).astype(np.intp)
