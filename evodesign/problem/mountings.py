"""On which side of its joint an actuator sits that is a body (`mount` of a `[[design.actuator]]`).

One that is `inline` has its middle in the joint. One that is `offset` ends in the joint and lies

    away from what the joint moves      where that lies on one side of it
    outwards                            where not, and the axis is level, across, and beside the middle plane
    backwards                           where not, and the axis points ahead

of the robot as its file has it, all joints at zero, x ahead and y to the left in the frame of its root link.
So mirror images are mounted as mirror images.
"""

from __future__ import annotations

from collections.abc import Iterator

from evodesign.body.inertia import total
from evodesign.body.placement import Placement, Vector, add, dot, rotate, scale
from evodesign.errors import InputError
from evodesign.hardware.mounting import Mount, Mounting
from evodesign.problem.design_table import ActuatorTable
from evodesign.records import ProblemSource
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree

ASIDE = 0.01
"""Distance [m] from which on something lies on one side."""

MOSTLY = 0.7
"""Share of an axis along a direction from which on it points there."""

AXES: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def mountings_of(table: ActuatorTable, key: str, source: ProblemSource, tree: Tree) -> tuple[Mounting, ...]:
    """How a table's actuator is mounted at each of its joints; none where it is no body.

    Args:
        table: with joints of the tree.
        key: of the table, for messages.
        source: of the problem.
        tree: of the robot, unscaled.
    Raises:
        InputError: a joint with nothing to tell on which side its actuator sits.
    """
    if table.mount is None:
        return ()
    found = []
    for place, name in enumerate(table.joints):
        axis, side = tree.joint_by_name[name].axis, 0.0
        if table.mount is Mount.OFFSET:
            side = _side(tree, name)
            if side == 0.0:
                wanted = f"'{Mount.INLINE}' of '{name}', in a table of its own"
                reason = f"'{Mount.OFFSET}', though what it moves is on neither side of joints[{place}]"
                raise InputError(source.path, f"{key}.mount", wanted, reason)
        across = AXES[min(range(3), key=lambda number: abs(axis[number]))]
        found.append(Mounting(side / 2.0, across))
    return tuple(found)


def _side(tree: Tree, name: str) -> float:
    """Along (1) or against (-1) a joint's axis; 0 where nothing tells."""
    frames, joint = link_frames(tree, Placement(), {}), tree.joint_by_name[name]
    place = frames[joint.child]
    axis = rotate(place.rotation, joint.axis)
    moved = total([tree.link_by_name[link].inertia.moved(frames[link]) for link in _below(tree, joint.child)])
    aside = dot(axis, add(moved.center, scale(-1.0, place.translation)))
    if abs(aside) > ASIDE:
        return -1.0 if aside > 0.0 else 1.0
    if abs(axis[1]) > MOSTLY and abs(place.translation[1]) > ASIDE:
        return 1.0 if axis[1] * place.translation[1] > 0.0 else -1.0
    if abs(axis[0]) > MOSTLY:
        return -1.0 if axis[0] > 0.0 else 1.0
    return 0.0


def _below(tree: Tree, link: str) -> Iterator[str]:
    yield link
    for joint in tree.child_joints[link]:
        yield from _below(tree, joint.child)
