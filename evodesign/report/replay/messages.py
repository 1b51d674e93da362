"""One case as messages: transforms, scenes of robot, person, load and wrenches, and joint states.

Frames: `world`; `load`; `robot/LINK`, `human/LINK` and so on, each a child of its parent link as in the tree,
the root a child of `world`. Shapes and wrenches are primitives of a Foxglove scene, given in their link's
frame, so that a scene stands where its frames do. Where a problem has several people or loads, each case
first clears the person of the one before, whose links may be others, and its name stands above the load.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from foxglove_schemas_protobuf.ArrowPrimitive_pb2 import ArrowPrimitive
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CubePrimitive_pb2 import CubePrimitive
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointState_pb2 import JointState
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
from foxglove_schemas_protobuf.TextPrimitive_pb2 import TextPrimitive
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.timestamp_pb2 import Timestamp

from evodesign.body.placement import Matrix, Placement, Vector, cross, dot, quaternion_wxyz, scale
from evodesign.body.shape import Box, Cylinder, Shape, Sphere
from evodesign.records import AgentDetail, CaseDetail
from evodesign.report.scene_models import LOAD, PlacedScene, looks_of
from evodesign.tree.frames import parent_from_child
from evodesign.tree.model import Tree

WORLD: Final = "world"

METRES_PER_NEWTON: Final = {True: 0.001, False: 0.02}
"""Length of a force's arrow: of the ground's (True) and of the load's (False), which are far smaller."""

ABOVE_LOAD: Final = (0.0, 0.0, 0.25)
"""Where a case's name stands, in the load's frame [m]."""

METRES_PER_NEWTON_METRE: Final = 0.02
"""Length of a moment's arrow."""


def topics(agents: Iterable[str]) -> dict[str, Any]:
    """The class of each topic's messages.

    Args:
        agents: names of all of them.
    """
    names = [*agents]
    return {
        "/tf": FrameTransforms,
        **{f"/scene/{name}": SceneUpdate for name in (*names, "load", "wrenches")},
        **{f"/joint_states/{name}": JointStates for name in names},
    }


Rgba = tuple[float, float, float, float]

COLORS: Final[Mapping[str, Rgba]] = {
    "robot": (0.23, 0.43, 0.65, 1.0),
    "human": (0.79, 0.55, 0.39, 1.0),
    "load": (0.55, 0.45, 0.33, 1.0),
    "ground force": (0.88, 0.48, 0.00, 1.0),
    "hand force": (0.48, 0.18, 0.55, 1.0),
    "moment": (0.10, 0.55, 0.45, 1.0),
    "text": (0.13, 0.15, 0.18, 1.0),
}

SHAFT, HEAD = 0.015, 0.04
"""Diameters of an arrow [m]; its head is as long as it is wide, or a third of a short arrow."""

LETTERS = 0.07
"""Height of letters [m]."""


def frame_id(agent: str, link: str) -> str:
    """Name of a link's frame."""
    return f"{agent}/{link}"


def messages(stage: PlacedScene, detail: CaseDetail, nanoseconds: int) -> Iterator[tuple[str, Any]]:
    """Topic and message of everything that is to be seen in one case.

    Args:
        stage: of that case.
        detail: its postures, as logged.
        nanoseconds: time of the messages.
    """
    now = Timestamp()
    now.FromNanoseconds(nanoseconds)
    pair = detail.case.label
    yield "/tf", FrameTransforms(transforms=list(_transforms(stage, detail, now)))
    for name, tree in stage.models.trees.items():
        entities = [_entity(name, tree, link, now) for link in tree.link_by_name]
        yield (
            f"/scene/{name}",
            SceneUpdate(
                deletions=[SceneEntityDeletion(timestamp=now, type=SceneEntityDeletion.ALL)] if pair else [],
                entities=[entity for entity in entities if entity is not None],
            ),
        )
        yield f"/joint_states/{name}", _joint_states(detail.agents[name], now)
    load = SceneEntity(timestamp=now, frame_id=LOAD, id=LOAD, frame_locked=True)
    add_shape(load, Box(*stage.models.payload.size), Placement(), LOAD)
    if pair:
        add_text(load, ABOVE_LOAD, detail.case.name)
    yield "/scene/load", SceneUpdate(entities=[load])
    yield "/scene/wrenches", SceneUpdate(entities=list(_wrenches(stage, now)))


def _transforms(stage: PlacedScene, detail: CaseDetail, now: Timestamp) -> Iterator[FrameTransform]:
    yield _transform(WORLD, LOAD, stage.world_from_load, now)
    for name, tree in stage.models.trees.items():
        yield _transform(WORLD, frame_id(name, tree.root), stage.frames[name][tree.root], now)
        positions = detail.agents[name].joints_rad
        for joint in tree.joints:
            place = parent_from_child(joint, positions.get(joint.name, 0.0))
            yield _transform(frame_id(name, joint.parent), frame_id(name, joint.child), place, now)


def _transform(parent: str, child: str, place: Placement, now: Timestamp) -> FrameTransform:
    return FrameTransform(
        timestamp=now,
        parent_frame_id=parent,
        child_frame_id=child,
        translation=vector(place.translation),
        rotation=orientation(place.rotation),
    )


def _entity(agent: str, tree: Tree, link: str, now: Timestamp) -> SceneEntity | None:
    looks = looks_of(tree.link_by_name[link])
    if not looks:
        return None
    frame = frame_id(agent, link)
    entity = SceneEntity(timestamp=now, frame_id=frame, id=frame, frame_locked=True)
    for shape, place in looks:
        add_shape(entity, shape, place, agent)
    return entity


def _wrenches(stage: PlacedScene, now: Timestamp) -> Iterator[SceneEntity]:
    for wrench in stage.wrenches:
        name = f"{wrench.agent}/{wrench.contact}"
        entity = SceneEntity(timestamp=now, frame_id=WORLD, id=name, frame_locked=True)
        force = scale(METRES_PER_NEWTON[wrench.by_ground], wrench.force)
        add_arrow(entity, wrench.point, force, "ground force" if wrench.by_ground else "hand force")
        add_arrow(entity, wrench.point, scale(METRES_PER_NEWTON_METRE, wrench.moment), "moment")
        for key, value in (("force_n", wrench.force), ("moment_n_m", wrench.moment)):
            entity.metadata.add(key=key, value=" ".join(repr(float(part)) for part in value))
        yield entity


def _joint_states(posture: AgentDetail, now: Timestamp) -> JointStates:
    joints = [
        JointState(
            name=name,
            position=position,
            velocity=posture.speeds_rad_s.get(name),
            effort=posture.torques_n_m[name],
        )
        for name, position in posture.joints_rad.items()
    ]
    return JointStates(timestamp=now, joints=joints)


def vector(triple: Vector) -> Any:
    """Three numbers as a message."""
    return Vector3(x=triple[0], y=triple[1], z=triple[2])


def orientation(rotation: Matrix) -> Any:
    """A rotation as a message."""
    w, x, y, z = quaternion_wxyz(rotation)
    return Quaternion(x=x, y=y, z=z, w=w)


def add_shape(entity: SceneEntity, shape: Shape, place: Placement, color: str) -> None:
    """Add a shape, placed in the entity's frame."""
    pose, paint = pose_of(place), color_of(color)
    match shape:
        case Sphere(radius):
            entity.spheres.append(SpherePrimitive(pose=pose, size=vector((2.0 * radius,) * 3), color=paint))
        case Cylinder(radius, length):
            size = vector((2.0 * radius, 2.0 * radius, length))
            straight = {"bottom_scale": 1.0, "top_scale": 1.0}
            entity.cylinders.append(CylinderPrimitive(pose=pose, size=size, color=paint, **straight))
        case Box():
            entity.cubes.append(CubePrimitive(pose=pose, size=vector(shape.sides), color=paint))


def add_arrow(entity: SceneEntity, tail: Vector, way: Vector, color: str) -> None:
    """Add an arrow from a point along a vector [m], both in the entity's frame; none without a length."""
    length = math.hypot(*way)
    if length == 0.0:
        return
    head = min(HEAD, length / 3.0)
    arrow = ArrowPrimitive(
        pose=pose_of(Placement(_towards(scale(1.0 / length, way)), tail)),
        shaft_length=length - head,
        shaft_diameter=SHAFT,
        head_length=head,
        head_diameter=HEAD,
        color=color_of(color),
    )
    entity.arrows.append(arrow)


def add_text(entity: SceneEntity, place: Vector, text: str) -> None:
    """Add words that face the viewer, at a point of the entity's frame."""
    words = TextPrimitive(
        pose=pose_of(Placement(translation=place)),
        billboard=True,
        font_size=LETTERS,
        color=color_of("text"),
        text=text,
    )
    entity.texts.append(words)


def _towards(way: Vector) -> Matrix:
    """A rotation that takes x to a unit vector: its columns are the vector and two across."""
    aside: Vector = (0.0, 0.0, 1.0) if abs(way[2]) < 0.9 else (0.0, 1.0, 0.0)
    up = cross(way, cross(aside, way))
    up = scale(1.0 / math.sqrt(dot(up, up)), up)
    left = cross(up, way)
    return tuple(zip(way, left, up, strict=True))  # type: ignore[return-value]


def pose_of(place: Placement) -> Any:
    """A placement as a message."""
    return Pose(position=vector(place.translation), orientation=orientation(place.rotation))


def color_of(name: str) -> Any:
    """A colour of `COLORS`, or of an agent by the role that its name begins with, as a message."""
    red, green, blue, opacity = COLORS[name.partition("_")[0]]
    return Color(r=red, g=green, b=blue, a=opacity)
