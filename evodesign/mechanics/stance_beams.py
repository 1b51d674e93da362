"""Hollow links of a robot that stands alone: how near they are to giving way in a load case."""

from __future__ import annotations

import numpy as np

from evodesign.body.placement import Placement, transpose
from evodesign.mechanics.link_beams import Safety, Wrench, link_safety
from evodesign.mechanics.stance_case import StanceCase, StanceTorques
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree


def stance_safety(tree: Tree, case: StanceCase, found: StanceTorques) -> dict[str, Safety]:
    """The safety of each of a tree's beams in a load case, by link.

    Args:
        tree: of a design, numbers.
        case: posture and loads; its factor is of actuators alone.
        found: what became of it; nothing is safe or not where the robot cannot stand.
    """
    return {} if found.reason else link_safety(tree, *standing(tree, case, found))


def standing(
    tree: Tree, case: StanceCase, found: StanceTorques
) -> tuple[Placement, dict[str, float], list[Wrench]]:
    """Where the root link is, positions of joints [rad], and what ground and loads pass to the robot.

    Axes are those of the first sole, the origin is the root link's.
    """
    joints = case.positions(found.offsets)
    sole = link_frames(tree, Placement(), joints)[case.soles[0]]
    feet = zip(case.soles, found.feet, strict=True)
    wrenches = [(frame, np.array(each[:3]), np.array([0.0, 0.0, sum(each[3:])])) for frame, each in feet]
    wrenches += [(frame, np.array(load), np.zeros(3)) for frame, load in case.loads]
    return Placement(rotation=transpose(sole.rotation)), joints, wrenches
