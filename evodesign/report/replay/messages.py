"""One case as messages: transforms, scenes of robot, person, load and wrenches, and joint states.

Frames: `world`; `load`; `robot/LINK` and `human/LINK`, each a child of its parent link as in the tree, the
root a child of `world`. Shapes are given in their link's frame, so that a scene stands where its frames do.
Where a problem has several people or loads, each case first clears the person of the one before, whose links
may be others, and its name stands above the load.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointState_pb2 import JointState
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.timestamp_pb2 import Timestamp

from evodesign.analysis.cases import case_name, pair_name
from evodesign.body.placement import Placement, scale
from evodesign.body.shape import Box
from evodesign.records import AgentDetail, HeightDetail
from evodesign.report.replay.shapes import add_arrow, add_shape, add_text, orientation, vector
from evodesign.report.scene_models import LOAD, PlacedScene, looks_of
from evodesign.tree.frames import parent_from_child
from evodesign.tree.model import Tree

__all__ = ["METRES_PER_NEWTON", "METRES_PER_NEWTON_METRE", "TOPICS", "WORLD", "frame_id", "messages"]

WORLD: Final = "world"

METRES_PER_NEWTON: Final = {True: 0.001, False: 0.02}
"""Length of a force's arrow: of the ground's (True) and of the load's (False), which are far smaller."""

ABOVE_LOAD: Final = (0.0, 0.0, 0.25)
"""Where a case's name stands, in the load's frame [m]."""

METRES_PER_NEWTON_METRE: Final = 0.02
"""Length of a moment's arrow."""

TOPICS: Final[Mapping[str, Any]] = {
    "/tf": FrameTransforms,
    "/scene/robot": SceneUpdate,
    "/scene/human": SceneUpdate,
    "/scene/load": SceneUpdate,
    "/scene/wrenches": SceneUpdate,
    "/joint_states/robot": JointStates,
    "/joint_states/human": JointStates,
}
"""The class of each topic's messages."""


def frame_id(agent: str, link: str) -> str:
    """Name of a link's frame."""
    return f"{agent}/{link}"


def messages(stage: PlacedScene, detail: HeightDetail, nanoseconds: int) -> Iterator[tuple[str, Any]]:
    """Topic and message of everything that is to be seen in one case.

    Args:
        stage: of that case.
        detail: its postures, as logged.
        nanoseconds: time of the messages.
    """
    now = Timestamp()
    now.FromNanoseconds(nanoseconds)
    case = pair_name(detail)
    yield "/tf", FrameTransforms(transforms=list(_transforms(stage, detail, now)))
    for name, tree in stage.models.trees.items():
        entities = [_entity(name, tree, link, now) for link in tree.link_by_name]
        yield (
            f"/scene/{name}",
            SceneUpdate(
                deletions=[SceneEntityDeletion(timestamp=now, type=SceneEntityDeletion.ALL)] if case else [],
                entities=[entity for entity in entities if entity is not None],
            ),
        )
        yield f"/joint_states/{name}", _joint_states(detail.agents[name], now)
    load = SceneEntity(timestamp=now, frame_id=LOAD, id=LOAD, frame_locked=True)
    add_shape(load, Box(*stage.models.payload.size), Placement(), LOAD)
    if case:
        add_text(load, ABOVE_LOAD, case_name(detail))
    yield "/scene/load", SceneUpdate(entities=[load])
    yield "/scene/wrenches", SceneUpdate(entities=list(_wrenches(stage, now)))


def _transforms(stage: PlacedScene, detail: HeightDetail, now: Timestamp) -> Iterator[FrameTransform]:
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
        JointState(name=name, position=position, effort=posture.torques_n_m[name])
        for name, position in posture.joints_rad.items()
    ]
    return JointStates(timestamp=now, joints=joints)
