"""Heights of the load that a robot as it is and the people of its problem hold.

    l, u     the lowest and the highest load that all of them can hold: at l they bend to the ground, at u
             somebody's arms are raised as far as they go
    h        where the hands of the tallest person hang who stands upright; below, people bend for their own
             weight
    heights  from max(l + 0.5 (u - l), h), but at most 0.65 of the way, to 0.75 of it, and their mean

Reach is solved for from fixed starts and without collisions, which takes a second or two.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, replace

import tomli_w

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.evaluation.inner import inner_problems
from evodesign.mechanics.agent import Agent
from evodesign.posture.formulations.reach import people_reach
from evodesign.posture.postures import Symmetry
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text
from evodesign.tree.welded import without_frames

FIRST, LAST_FIRST, LAST = 0.5, 0.65, 0.75
"""Of the way from the lowest to the highest load: where heights begin and end."""

STEP = 0.05
"""To which heights are rounded [m]."""

SHOULDER = "LeftUpperArm"
"""Link of a generated person that begins at the shoulder."""


@dataclass(frozen=True, slots=True)
class HeldHeights:
    """The lowest and the highest load that all hold, and where the tallest person's hands hang [m]."""

    lowest: float
    highest: float
    hanging: float

    @property
    def heights(self) -> tuple[float, ...]:
        """Each height once, lowest first."""
        first, latest, last = (
            self.lowest + share * (self.highest - self.lowest) for share in (FIRST, LAST_FIRST, LAST)
        )
        first = min(max(first, self.hanging), latest)
        steps = (round(height / STEP) for height in (first, (first + last) / 2.0, last))
        return tuple(round(STEP * step, 2) for step in dict.fromkeys(steps))


def held_heights(text: str, urdf: str, tree: Tree) -> HeldHeights | None:
    """What robot and people hold; None where the text is no problem yet, or somebody holds nothing.

    Args:
        text: of a problem file, whose own heights do not count.
        urdf: name of the robot's file in it.
        tree: the robot, of numbers.
    """
    tables = tomllib.loads(text)
    tables["robot"]["meshes"] = False
    tables["solver"] = {"start_portfolio": False}
    tables.pop("collisions", None)
    source = ProblemSource(path=urdf, text=tomli_w.dumps(tables), files={urdf: urdf_text(tree)})
    try:
        problem = build_problem(source)
    except InputError:
        return None
    problem = replace(problem, options=replace(problem.options, seldom=True))
    ends = _ends(problem)
    if not all(ends):
        return None
    lowest, highest = max(end[0] for end in ends if end), min(end[1] for end in ends if end)
    hanging = max(_hanging(scene.human) for scene in problem.scenes)
    return HeldHeights(lowest, highest, hanging) if lowest < highest else None


def _ends(problem: DesignProblem) -> list[tuple[float, float] | None]:
    """The lowest and the highest load of the robot and of each person; None for who holds nothing."""
    scenes, robot = problem.scenes, problem.scene.robot
    frames = (*(contact.frame for contact in robot.contacts), *robot.trunk)
    bare = replace(robot, tree=without_frames(robot.tree, frames))
    alone = replace(problem, scenes=tuple(scene.with_agents(bare) for scene in scenes), whole_reach=True)
    unscaled = problem.space.unscaled(robot.tree)
    symmetric = problem.symmetry is not Symmetry.OFF
    reaches = [each.solve(unscaled) for each in inner_problems(alone).reaches.values()]
    people = [people_reach(scene, problem.options, symmetric=symmetric) for scene in scenes]
    return [None if each is None else _both(each.lowest, each.highest) for each in (*reaches, *people)]


def _both(lowest: float | None, highest: float | None) -> tuple[float, float] | None:
    return None if lowest is None or highest is None else (lowest, highest)


def _hanging(person: Agent) -> float:
    """Height of a generated person's hands above the soles where the arms hang [m]."""
    frames = link_frames(person.tree, Placement(), {})
    hand, shoulder = (frames[name].translation for name in (person.frame("left_hand"), SHOULDER))
    return float(shoulder[2] - math.dist(shoulder, hand) - frames[person.frame("left_foot")].translation[2])
