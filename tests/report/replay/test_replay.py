"""The replay, read back with the plain MCAP reader and the schemas that it carries."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessages
from mcap.reader import make_reader

from evodesign.body.shape import Box, Cylinder, Sphere
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.posture.check import AgentModel
from evodesign.problem.build import DesignProblem
from evodesign.records import Detail
from evodesign.report.replay.layout import layout_text
from evodesign.report.replay.messages import METRES_PER_NEWTON, METRES_PER_NEWTON_METRE
from evodesign.report.replay.recording import replay_frames, write_frames
from evodesign.report.scene_models import SceneModels, SceneSet, looks_of, placed_scene
from tests.report.scenes import random_cast, random_company, random_detail

CLASSES = {
    "foxglove.FrameTransforms": FrameTransforms,
    "foxglove.SceneUpdate": SceneUpdate,
    "foxglove.JointStates": JointStates,
}
TOPICS = {
    "/tf": "foxglove.FrameTransforms",
    "/scene/robot": "foxglove.SceneUpdate",
    "/scene/human": "foxglove.SceneUpdate",
    "/scene/load": "foxglove.SceneUpdate",
    "/scene/wrenches": "foxglove.SceneUpdate",
    "/joint_states/robot": "foxglove.JointStates",
    "/joint_states/human": "foxglove.JointStates",
}
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Replay:
    """A written replay and what it should hold."""

    models: SceneModels
    detail: Detail
    content: bytes
    messages: Mapping[tuple[str, int], object]

    def at(self, topic: str, height: float) -> object:
        return self.messages[topic, round(height * 1e10)]


@pytest.fixture(scope="module")
def replay(problem: DesignProblem) -> Replay:
    models, detail = random_cast(problem, 4), random_detail(problem, 4, (1.2, 0.8, 1.0))
    stream = io.BytesIO()
    company = SceneSet((models,))
    frames = replay_frames(company, detail.cases)
    write_frames(stream, company, frames, {"robot.urdf": "<robot/>"}, {"problem": "<script>"})
    content = stream.getvalue()
    messages = {}
    for schema, channel, message in make_reader(io.BytesIO(content), validate_crcs=True).iter_messages():
        assert schema is not None
        found = CLASSES[schema.name]()
        found.ParseFromString(message.data)
        messages[channel.topic, message.log_time] = found
    return Replay(models, detail, content, messages)


def test_channels_have_the_well_known_schemas(replay: Replay) -> None:
    summary = make_reader(io.BytesIO(replay.content)).get_summary()
    assert summary is not None
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        assert (channel.message_encoding, schema.encoding) == ("protobuf", "protobuf")
        assert TOPICS[channel.topic] == schema.name
    assert {channel.topic for channel in summary.channels.values()} == set(TOPICS)
    assert len(summary.schemas) == 3


def test_schemas_describe_their_messages_without_any_other_file(replay: Replay) -> None:
    for schema, _, message in make_reader(io.BytesIO(replay.content)).iter_messages():
        assert schema is not None
        files = FileDescriptorSet.FromString(schema.data)
        pool = DescriptorPool()
        for file in files.file:
            pool.Add(file)  # refuses a file whose imports are missing
        kind = GetMessages(list(files.file), pool=pool)[schema.name]
        assert str(kind.FromString(message.data)) == str(CLASSES[schema.name].FromString(message.data))


def test_heights_are_times_in_rising_order(replay: Replay) -> None:
    reader = make_reader(io.BytesIO(replay.content))
    times = [message.log_time for _, _, message in reader.iter_messages(log_time_order=False)]
    assert times == sorted(times)
    assert sorted(set(times)) == [8_000_000_000, 10_000_000_000, 12_000_000_000, 13_000_000_000]
    for topic in TOPICS:
        last, held = replay.at(topic, 1.2), replay.at(topic, 1.3)
        assert stripped(last) == stripped(held), "the last posture is held"


def stripped(message: object) -> str:
    return "\n".join(line for line in str(message).splitlines() if "seconds" not in line)


def test_frames_stand_where_pinocchio_puts_the_links(replay: Replay) -> None:
    for detail in replay.detail.cases:
        at = detail.case.task.height_m
        world_from = frames(replay.at("/tf", at))
        assert np.allclose(world_from["load"][:3, 3], [0.0, 0.0, at], rtol=0.0, atol=TOLERANCE)
        for agent in replay.models.agents:
            tree = replay.models.trees[agent.name]
            state = AgentModel.of(agent, tree).at(logged_posture(detail.agents[agent.name]))
            turn = agent.turn
            for link in tree.link_by_name:
                rotation, origin = state.pose(link)
                found = world_from[f"{agent.name}/{link}"]
                assert np.allclose(found[:3, :3], turn @ rotation, rtol=0.0, atol=TOLERANCE)
                assert np.allclose(found[:3, 3], turn @ origin, rtol=0.0, atol=TOLERANCE)


def frames(message: object) -> dict[str, np.ndarray]:
    """World from frame, by composing every transform with its parent's."""
    world_from = {"world": np.eye(4)}
    for transform in message.transforms:
        parent_from_child = matrix(transform.translation, transform.rotation)
        world_from[transform.child_frame_id] = world_from[transform.parent_frame_id] @ parent_from_child
    return world_from


def matrix(position: object, quaternion: object) -> np.ndarray:
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    assert x * x + y * y + z * z + w * w == pytest.approx(1.0, abs=1e-14)
    whole = np.eye(4)
    whole[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    whole[:3, 3] = [position.x, position.y, position.z]
    return whole


def test_scenes_hold_every_shape_at_its_place(replay: Replay) -> None:
    for detail in replay.detail.cases:
        at = detail.case.task.height_m
        world_from = frames(replay.at("/tf", at))
        expected = placed_scene(replay.models, detail).solids
        found = []
        for topic in ("/scene/robot", "/scene/human", "/scene/load"):
            for entity in replay.at(topic, at).entities:
                assert entity.frame_locked
                for primitive in (*entity.spheres, *entity.cylinders, *entity.cubes):
                    size = (primitive.size.x, primitive.size.y, primitive.size.z)
                    in_frame = matrix(primitive.pose.position, primitive.pose.orientation)
                    found.append((size, world_from[entity.frame_id] @ in_frame))
        assert len(found) == len(expected)
        for _, shape, place in expected:
            whole = np.eye(4)
            whole[:3, :3], whole[:3, 3] = place.rotation, place.translation
            assert any(
                size == pytest.approx(size_of(shape)) and np.allclose(pose, whole, rtol=0.0, atol=TOLERANCE)
                for size, pose in found
            )


def size_of(shape: Box | Cylinder | Sphere) -> tuple[float, float, float]:
    match shape:
        case Box():
            return shape.sides
        case Cylinder(radius, length):
            return (2 * radius, 2 * radius, length)
        case Sphere(radius):
            return (2 * radius,) * 3


def test_arrows_are_the_wrenches(replay: Replay) -> None:
    for detail in replay.detail.cases:
        at = detail.case.task.height_m
        entities = {entity.id: entity for entity in replay.at("/scene/wrenches", at).entities}
        assert len(entities) == 8
        for wrench in placed_scene(replay.models, detail).wrenches:
            entity = entities[f"{wrench.agent}/{wrench.contact}"]
            assert entity.frame_id == "world"
            force, moment = entity.arrows
            for arrow, vector, scale in (
                (force, wrench.force, METRES_PER_NEWTON[wrench.by_ground]),
                (moment, wrench.moment, METRES_PER_NEWTON_METRE),
            ):
                pose = matrix(arrow.pose.position, arrow.pose.orientation)
                assert np.allclose(pose[:3, 3], wrench.point, rtol=0.0, atol=TOLERANCE)
                way = pose[:3, 0] * (arrow.shaft_length + arrow.head_length) / scale
                assert np.allclose(way, vector, rtol=1e-9, atol=1e-9)
            told = {pair.key: [float(part) for part in pair.value.split()] for pair in entity.metadata}
            assert told == {"force_n": list(wrench.force), "moment_n_m": list(wrench.moment)}


def test_joint_states_are_the_posture(replay: Replay) -> None:
    for detail in replay.detail.cases:
        at = detail.case.task.height_m
        for agent in ("robot", "human"):
            posture = detail.agents[agent]
            joints = replay.at(f"/joint_states/{agent}", at).joints
            assert {joint.name: joint.position for joint in joints} == posture.joints_rad
            assert {joint.name: joint.effort for joint in joints} == posture.torques_n_m
            assert not any(joint.HasField("velocity") for joint in joints)


def test_models_are_attached_and_the_recording_says_of_what_it_is(replay: Replay) -> None:
    reader = make_reader(io.BytesIO(replay.content))
    attachments = {each.name: each.data for each in reader.iter_attachments()}
    assert attachments == {"robot.urdf": b"<robot/>"}
    assert [(each.name, each.metadata) for each in reader.iter_metadata()] == [
        ("evodesign", {"problem": "<script>"})
    ]


def test_one_height_gives_a_recording_with_a_length(problem: DesignProblem) -> None:
    stream = io.BytesIO()
    company = random_company(problem, 1)
    frames = replay_frames(company, random_detail(problem, 1, (1.0,)).cases)
    write_frames(stream, company, frames, {}, {})
    times = {message.log_time for _, _, message in make_reader(io.BytesIO(stream.getvalue())).iter_messages()}
    assert times == {10_000_000_000, 11_000_000_000}


def test_layout_shows_topics_frames_and_joints_that_exist(replay: Replay) -> None:
    layout = json.loads(layout_text(SceneSet((replay.models,)), replay.detail.cases))
    panels = layout["configById"]
    assert panels_of(layout["layout"]) == set(panels)
    scene = panels["3D!scene"]
    assert set(scene["topics"]) == {topic for topic in TOPICS if topic.startswith("/scene/")}
    known = {"world", *(t.child_frame_id for t in replay.at("/tf", 1.0).transforms)}
    assert {name.removeprefix("frame:") for name in scene["transforms"]} == known
    for agent in ("robot", "human"):
        torques = [detail.agents[agent].torques_n_m for detail in replay.detail.cases]
        largest = sorted(torques[0], key=lambda joint: -max(abs(at[joint]) for at in torques))[:6]
        labels = [path["label"] for path in panels[f"Plot!{agent}"]["paths"]]
        assert labels == largest
        for path in panels[f"Plot!{agent}"]["paths"]:
            expected = f'/joint_states/{agent}.joints[:]{{name=="{path["label"]}"}}.effort'
            assert path["value"] == expected


def panels_of(node: object) -> set[str]:
    if isinstance(node, str):
        return {node}
    return panels_of(node["first"]) | panels_of(node["second"])


def test_link_without_a_shape_has_a_frame_and_no_entity(replay: Replay) -> None:
    bare = [link.name for link in replay.models.trees["robot"].links if not looks_of(link)]
    assert "l_sole" in bare
    shown = {entity.id for entity in replay.at("/scene/robot", 1.0).entities}
    assert not shown & {f"robot/{name}" for name in bare}
