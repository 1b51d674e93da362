"""Whether bodies pass through each other in a posture: the smallest clearance of all pairs that must not.

Postures are solved with bodies that may pass through anything but where a limit says otherwise (the feet, the
trunk and the load); this tells by how much they do. Checked are an agent's own pairs (`collision.pairs`), all
links and the load but for those that hold it, and all links of robot and person against each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations, product
from typing import Any

from evodesign.body.placement import Placement
from evodesign.body.shape import Box
from evodesign.collision.clearance import BodyDistance, PlacedSolids, Places, SolidBodies, places_of
from evodesign.collision.pairs import checked_pairs
from evodesign.collision.rules import LOAD
from evodesign.collision.shapes import box_solid
from evodesign.errors import RunError, on_one_line
from evodesign.evaluation.evaluate import detail_of
from evodesign.mechanics.agent import HUMAN, Agent
from evodesign.mechanics.scene import Scene
from evodesign.quantities.design_result import DesignResult
from evodesign.records import AgentDetail, Case, CaseDetail
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

WHO: Mapping[str, str] = {HUMAN: "person"}
"""What agents are called where it is not their name."""

Pairs = tuple[tuple[str, str], ...]

OVERLAP = 1e-4
"""Depth [m] from which an overlap is told."""


class Clearances:
    """The smallest clearance in any posture of a problem.

    Args:
        scenes: every person with every load, all with the same robot.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self._scenes = {scene.pair: scene for scene in scenes}
        self._own: dict[int, Pairs] = {}
        self._places: dict[tuple[str, str], Places] = {}
        self._people = {
            id(agent.tree): SolidBodies.of_tree(agent.tree)
            for scene in scenes
            for agent in scene.agents
            if not agent.designed
        }

    def of(self, robot: Tree, cases: Sequence[CaseDetail]) -> list[BodyDistance]:
        """The nearest two bodies in each case, undisturbed; in a lift at some of its moments.

        Args:
            robot: the design's tree.
            cases: its postures.
        Raises:
            RunError: the problem has not a case's person or load.
        """
        solids = SolidBodies.of_tree(robot)
        moments = [[self._nearest(robot, solids, each) for each in case.few_moments] for case in cases]
        return [min(found, key=lambda gap: gap.distance) for found in moments]

    def _nearest(self, robot: Tree, solids: SolidBodies, case: CaseDetail) -> BodyDistance:
        scene = self._scenes.get(case.case.pair)
        if scene is None or case.agents.keys() != {agent.name for agent in scene.agents}:
            name = on_one_line(case.case.name)
            raise RunError(f"the logged postures of case '{name}' are not those of the run's problem")
        trees = {agent.name: robot if agent.designed else agent.tree for agent in scene.agents}
        own = {name: self._people.get(id(tree), solids) for name, tree in trees.items()}
        load = SolidBodies((LOAD,), (box_solid(Box(*scene.payload.size)),))
        middle = Placement(translation=(0.0, 0.0, case.height_m))
        first, *others = [
            _placed(agent, trees[agent.name], own[agent.name], case.agents[agent.name])
            for agent in scene.agents
        ]
        placed = first.beside(*others, load.placed({LOAD: middle}))
        if scene.pair not in self._places:
            self._places[scene.pair] = places_of(placed.names, self._collision_pairs(scene, own))
        return placed.nearest(self._places[scene.pair])

    def _collision_pairs(self, scene: Scene, own: Mapping[str, SolidBodies]) -> Iterator[tuple[str, str]]:
        """All pairs of a scene, of the bodies of agents by name."""
        links = {name: dict.fromkeys(solids.names) for name, solids in own.items()}
        for one, other in combinations(links, 2):
            yield from ((_name(one, a), _name(other, b)) for a, b in product(links[one], links[other]))
        for agent in scene.agents:
            for link, other in self._of_agent(agent):
                if other == LOAD:
                    yield _name(agent.name, link), LOAD
                elif other in links[agent.name]:
                    yield _name(agent.name, link), _name(agent.name, other)

    def _of_agent(self, agent: Agent) -> Pairs:
        """Those of its links, and of these with load, floor and partner."""
        if agent.collisions is not None:
            return agent.collisions.checked
        if id(agent.tree) not in self._own:
            ends = agent.hand_frames, agent.foot_frames
            self._own[id(agent.tree)] = checked_pairs(agent.tree, agent.joints, *ends)
        return self._own[id(agent.tree)]


def solved_distances(result: DesignResult) -> dict[Case, BodyDistance]:
    """The nearest two bodies of each solved case of a design."""
    cases = [detail_of(solution) for solution in result.cases if solution.solved]
    gaps = Clearances(result.scenes).of(result.tree, cases)
    return {case.case: gap for case, gap in zip(cases, gaps, strict=True)}


def distance_json(gap: BodyDistance) -> dict[str, Any]:
    """A gap as it is told to other programs."""
    return {"bodies": [gap.first, gap.second], "distance_m": gap.distance}


def overlaps(gaps: Iterable[tuple[Case, BodyDistance]]) -> list[str]:
    """A sentence for each case in which bodies pass through each other."""
    return [
        f"at {case.name}, {gap.first} and {gap.second} overlap by {-1e3 * gap.distance:.1f} mm"
        for case, gap in gaps
        if gap.distance < -OVERLAP
    ]


def _placed(agent: Agent, tree: Tree, solids: SolidBodies, posture: AgentDetail) -> PlacedSolids:
    """An agent's solids in the world."""
    world_from_agent = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, agent.facing))
    base = Placement.from_xyz_rpy(posture.base_position_m, posture.base_rpy_rad)
    placed = solids.placed(link_frames(tree, world_from_agent @ base, posture.joints_rad))
    return placed.named(lambda link: _name(agent.name, link))


def _name(agent: str, link: str) -> str:
    return f"{WHO.get(agent, agent)} {link}"
