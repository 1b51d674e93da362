"""The page of a robot of meshes: their triangles stand in it once, and move with the links of each design."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest

from evodesign.mechanics.agent import ROBOT
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.records import Detail
from evodesign.report.page import page_content, page_html
from evodesign.report.page.bodies import bodies, changes
from evodesign.report.scene_models import SceneModels, placed_scene
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from evodesign.tree.mesh_write import vertices_of
from tests.problem.mesh_robot import MESHES, write_mesh_problem
from tests.report.export.test_folder import design_of
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page
from tests.report.scenes import random_detail, random_values


@pytest.fixture(scope="module")
def clad(tmp_path_factory: pytest.TempPathFactory) -> DesignProblem:
    return build_problem(read_source(write_mesh_problem(tmp_path_factory.mktemp("clad"))))


@pytest.fixture(scope="module")
def run(clad: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    """One design in random postures, as if it had been found."""
    directory = tmp_path_factory.mktemp("page") / "clad"
    evaluation = design_of(clad, random_detail(clad, 2)).evaluation
    worth = {objective.name: 1.0 for objective in clad.objectives}
    assessment = msgspec.structs.replace(evaluation.assessment, objectives=worth)
    with RunWriter(directory, header_of(clad, clad.settings("random", 4, 1), 4)) as log:
        log.write(msgspec.structs.replace(evaluation, assessment=assessment))
        log.write(Detail(evaluation=0, cases=random_detail(clad, 2).cases))
    return read_run(directory)


def test_a_run_holds_its_meshes(run: RunLog, clad: DesignProblem) -> None:
    assert run.header.problem.files == clad.source.files
    assert build_problem(run.header.problem).scene.robot.tree == clad.scene.robot.tree


def test_triangles_are_told_once_and_a_design_tells_where_they_are(clad: DesignProblem) -> None:
    told = bodies(clad)
    assert len(told.surfaces) == len({name for name, _ in MESHES.values()})
    values = random_values(clad, 3)
    links, _ = changes(clad, values)
    tree = clad.space.resized(clad.scene.robot.tree, values)
    assert len(msgspec.json.encode(links)) < 8000
    for index, link in enumerate(tree.links):
        body = links.get(index, told.robot.links[index])
        assert len(body.meshes) == (link.name in MESHES)
        for mesh, drawn in zip(link.meshes, body.meshes, strict=True):
            surface = told.surfaces[drawn.surface]
            assert mesh.surface is not None
            assert (surface.points, surface.triangles) == (mesh.surface.points, mesh.surface.triangles)
            found = mesh.surface.vertices @ np.array(drawn.linear).reshape(3, 3).T + drawn.position
            np.testing.assert_allclose(found, vertices_of(mesh), atol=1e-12)
            assert body.shapes == ()


@pytest.mark.slow
@pytest.mark.needs_chromium
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_browser_draws_each_mesh_where_its_link_is(
    run: RunLog, clad: DesignProblem, chromium: Tab, tmp_path: Path, theme: str
) -> None:
    path = tmp_path / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    chromium.events.clear()
    open_page(chromium, path, theme)
    script = """(() => {
        const { content, sceneItems, shownCase, postureAt, verticesOf } = window.evodesign;
        const design = content.designs[0];
        const at = shownCase();
        return JSON.stringify(sceneItems(design, postureAt(design, at).agents, at)
            .filter(({ mesh }) => mesh.startsWith("surface "))
            .map(({ mesh, model }) => verticesOf(content.bodies.surfaces[Number(mesh.slice(8))])[0]
                .map(([x, y, z]) => [0, 1, 2].map((row) =>
                    model[row] * x + model[4 + row] * y + model[8 + row] * z + model[12 + row]))));
    })()"""
    drawn = [np.array(points) for points in json.loads(chromium.value(script))]
    height = chromium.value("window.evodesign.shownCase().height")
    design = run.evaluations[0].assessment.design
    values = [design[parameter.name] for parameter in clad.space.parameters]
    models = SceneModels.of(clad.scene, clad.space.resized(clad.scene.robot.tree, values))
    (detail,) = (each for each in run.details[0].cases if each.case.task.height_m == height)
    stage = placed_scene(models, detail)
    assert len(drawn) == len(stage.meshes) == len(MESHES)
    for points, (agent, mesh, frame) in zip(drawn, stage.meshes, strict=True):
        assert agent == ROBOT
        wanted = vertices_of(mesh) @ np.array(frame.rotation).T + frame.translation
        np.testing.assert_allclose(points, wanted, atol=1e-6)
    assert chromium.complaints() == []
    assert chromium.requests() == [path.as_uri()]
