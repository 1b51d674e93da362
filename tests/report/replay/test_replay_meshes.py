"""A recording of a robot of meshes holds their triangles once, in the frames of their links."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from mcap.reader import make_reader

from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.report.replay.layout import layout_text
from evodesign.report.replay.recording import replay_frames, write_frames
from evodesign.report.replay.surfaces import MESHES as TOPIC
from evodesign.tree.mesh_write import triangles_of, vertices_of
from tests.problem.mesh_robot import MESHES, write_mesh_problem
from tests.report.scenes import random_company, random_detail


def test_triangles_are_told_once_and_shapes_of_other_links_as_before(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    problem = build_problem(read_source(write_mesh_problem(tmp_path_factory.mktemp("clad"))))
    company, detail = random_company(problem, 5), random_detail(problem, 5, (1.2, 0.8))
    stream = io.BytesIO()
    write_frames(stream, company, replay_frames(company, detail.cases), {}, {})
    told = [
        (message.log_time, channel.topic, message.data)
        for _, channel, message in make_reader(io.BytesIO(stream.getvalue())).iter_messages()
    ]
    ((time, content),) = [(time, data) for time, topic, data in told if topic == TOPIC]
    assert time == told[0][0] == 8_000_000_000
    entities = SceneUpdate.FromString(content).entities
    assert {entity.frame_id for entity in entities} == {f"robot/{name}" for name in MESHES}
    for entity in entities:
        assert entity.frame_locked
        (mesh,) = company.robot.link_by_name[entity.frame_id.removeprefix("robot/")].meshes
        (triangles,) = entity.triangles
        points = np.array([(point.x, point.y, point.z) for point in triangles.points])
        np.testing.assert_allclose(points, vertices_of(mesh), atol=1e-12)
        assert list(triangles.indices) == triangles_of(mesh).reshape(-1).tolist()
        assert triangles.pose.orientation.w == 1.0
    shapes = SceneUpdate.FromString(next(data for _, topic, data in told if topic == "/scene/robot"))
    assert {entity.frame_id for entity in shapes.entities} == {
        f"robot/{link.name}" for link in company.robot.links if link.solids and not link.meshes
    }
    panels = json.loads(layout_text(company, detail.cases))["configById"]
    assert panels["3D!scene"]["topics"][TOPIC] == {"visible": True}
