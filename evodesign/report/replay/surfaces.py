"""The meshes of a recording's robot as triangles of a Foxglove scene, each in the frame of its link.

They are told once, on a topic of their own, as they move with their frames: a viewer that is sent to a later
time is given the last message of each topic.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.TriangleListPrimitive_pb2 import TriangleListPrimitive
from google.protobuf.timestamp_pb2 import Timestamp

from evodesign.body.placement import Placement
from evodesign.mechanics.agent import ROBOT
from evodesign.report.replay.messages import color_of, frame_id, pose_of, topics
from evodesign.report.scene_models import SceneSet
from evodesign.tree.mesh_write import triangles_of, vertices_of
from evodesign.tree.model import Link

MESHES: Final = "/scene/robot_meshes"
"""Their topic."""


def topics_of(scene_set: SceneSet) -> Mapping[str, Any]:
    """The class of each topic's messages in a recording."""
    found = topics(scene_set.models[0].trees)
    shown = any(link.shown for _, tree in scene_set.robots for link in tree.links)
    return {**found, MESHES: SceneUpdate} if shown else found


def mesh_message(scene_set: SceneSet, nanoseconds: int) -> Any:
    """A scene of the robots' meshes, an entity for each link that has some.

    Args:
        scene_set: with the robot of the design.
        nanoseconds: time of the message.
    """
    now = Timestamp()
    now.FromNanoseconds(nanoseconds)
    entities = [
        _entity(name, link, now) for name, tree in scene_set.robots for link in tree.links if link.shown
    ]
    return SceneUpdate(entities=entities)


def _entity(agent: str, link: Link, now: Timestamp) -> SceneEntity:
    frame = frame_id(agent, link.name)
    entity = SceneEntity(timestamp=now, frame_id=frame, id=f"{frame} meshes", frame_locked=True)
    for mesh in link.shown:
        triangles = TriangleListPrimitive(
            pose=pose_of(Placement()),
            points=[Point3(x=x, y=y, z=z) for x, y, z in vertices_of(mesh).tolist()],
            indices=triangles_of(mesh).reshape(-1).tolist(),
            color=color_of(ROBOT),
        )
        entity.triangles.append(triangles)
    return entity
