"""Hollow links of a robot that stands alone: how near they are to giving way in a load case, and in a fall.

What falls (a payload into the hands, or the robot onto its feet) gives its energy to beams and gears, which
are linear springs without mass. With d the deflection under its weight W at rest, h the height of the fall,
and M the moments of the weight, carried by the feet alike,

    n = 1 + sqrt(1 + 2 h / d),      d = 1/W integral of M^2 / (E I) + ...    (virtual work of W along W / W)

and all that the weight asks at rest is asked n times at the lowest point. It is an upper bound: the mass of
what is struck, gears that turn back, soles and covers all soften the blow.

Source: Young and Budynas, Roark's Formulas for Stress and Strain, on impact and sudden loading.
"""

from __future__ import annotations

import math

import numpy as np

from evodesign.body.placement import Placement, transpose
from evodesign.errors import ModelError
from evodesign.mechanics.link_beams import Safety, Wrench, carried, link_safety, virtual_work, weights
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
    if found.reason:
        return {}
    base, joints, wrenches = standing(tree, case, found)
    if case.dropped:
        times, falling = impact(tree, case, found)
        wrenches += [
            (frame, (times - 1.0) * force, (times - 1.0) * moment) for frame, force, moment in falling
        ]
    return link_safety(tree, base, joints, wrenches)


def impact(tree: Tree, case: StanceCase, found: StanceTorques) -> tuple[float, list[Wrench]]:
    """How many times its weight what falls asks for, and that weight with what the feet answer.

    Raises:
        ModelError: nothing gives way, so that the blow would have no end.
    """
    base, joints, _ = standing(tree, case, found)
    places = link_frames(tree, base, joints)
    load = [(frame, np.array(force), np.zeros(3)) for frame, force in case.loads]
    load = load or list(weights(tree, places))
    whole = -sum(float(force[2]) for _, force, _ in load)
    unit = [(frame, force / whole, moment / whole) for frame, force, moment in load]
    deflection = virtual_work(tree, places, load, unit, case.soles).total
    if deflection <= 0.0:
        wanted = "links with walls or actuators that give way under what falls"
        raise ModelError(tree.name, f"load case '{case.name}'", wanted, "none")
    times = 1.0 + math.sqrt(1.0 + 2.0 * case.dropped / deflection)
    return times, [*load, *carried(places, load, case.soles)]


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
