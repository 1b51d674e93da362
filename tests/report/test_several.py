"""Several people and loads, seen from outside: every case has its own person, load, numbers and name."""

from __future__ import annotations

import csv
import io
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np
import pandas as pd
import pinocchio
import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from mcap.reader import make_reader

import evodesign
from evodesign.analysis.conditions import conditions, meeting, quantities
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.evaluation.progress import SILENT
from evodesign.human.body import human_tree
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.posture.check import AgentModel
from evodesign.problem.build import DesignProblem
from evodesign.records import Detail
from evodesign.report.export.design import ExportedDesign
from evodesign.report.export.folder import export_design
from evodesign.report.figures.posture_figure import posture_figure
from evodesign.report.opened_design import open_design
from evodesign.report.page import page_content, postures
from evodesign.runlog.run import RunLog
from evodesign.tree.urdf_write import urdf_text
from tests.report.page.reading import check_to_seven_digits, leaves
from tests.report.replay.test_replay import frames
from tests.report.scenes import random_company
from tests.report.several import CASES, LOADS, PEOPLE, problem_of_several, write_several


@pytest.fixture(scope="module")
def several(problem: DesignProblem) -> DesignProblem:
    return problem_of_several(problem)


@pytest.fixture(scope="module")
def run(several: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    return write_several(several, tmp_path_factory.mktemp("several") / "run")


@pytest.fixture(scope="module")
def folder(run: RunLog, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("export") / "design"
    opened = open_design(run, 1, 1, SILENT)
    design = ExportedDesign("run", run.header, opened.evaluation, opened.scene_set(), opened.cases)
    export_design(design, place, on_front=opened.on_front)
    return place


def test_each_persons_file_has_the_persons_stature_and_mass(folder: Path) -> None:
    assert not (folder / "human.urdf").exists()
    for number, (name, person) in enumerate(PEOPLE.items(), 1):
        path = folder / f"human_{number}.urdf"
        model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
        assert pinocchio.computeTotalMass(model) == pytest.approx(person.mass)
        data = model.createData()
        pinocchio.framesForwardKinematics(model, data, pinocchio.neutral(model))
        head, sole = (data.oMf[model.getFrameId(link)].translation[2] for link in ("Head", "LeftSole"))
        sphere = ET.parse(path).find("./link[@name='Head']//sphere")
        assert sphere is not None
        assert head + 2.0 * float(sphere.attrib["radius"]) - sole == pytest.approx(person.stature)
        assert f"- `human_{number}.urdf`: The person `{name}`" in (folder / "README.md").read_text()


def test_tables_say_who_holds_what(folder: Path, run: RunLog) -> None:
    for name in ("postures.csv", "wrenches.csv"):
        rows = list(csv.DictReader(io.StringIO((folder / name).read_text())))
        assert list(rows[0])[:3] == ["human", "payload", "height_m"]
        found = dict.fromkeys((row["human"], row["payload"], float(row["height_m"])) for row in rows)
        assert [*found] == CASES
    table = pd.DataFrame(csv.DictReader(io.StringIO((folder / "postures.csv").read_text())))
    for (human, payload, height), detail in zip(CASES, run.details[1].cases, strict=True):
        own = table[(table.human == human) & (table.payload == payload) & (table.height_m == f"{height}")]
        joints = own[(own.agent == HUMAN) & (own.kind != "base")]
        told = {name: float(torque) for name, torque in zip(joints.name, joints.torque, strict=True)}
        assert told == detail.agents[HUMAN].torques_n_m


def test_keyframes_are_named_by_case(folder: Path, run: RunLog) -> None:
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    data = mujoco.MjData(model)
    assert model.nkey == len(CASES)
    for (human, payload, height), detail in zip(CASES, run.details[1].cases, strict=True):
        key = model.key(f"{human}, {payload}, load at {height:g} m")
        mujoco.mj_resetDataKeyframe(model, data, key.id)
        for joint, position in detail.agents[ROBOT].joints_rad.items():
            assert data.joint(joint).qpos[0] == position


def test_recording_shows_each_case_with_its_own_person_and_load(
    folder: Path, run: RunLog, several: DesignProblem
) -> None:
    """Link frames are compared with pinocchio with persons that are generated anew."""
    readme = (folder / "README.md").read_text()
    seen = {}
    with (folder / "replay.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        attached = {each.name: each.data for each in reader.iter_attachments()}
        for _, channel, message in reader.iter_messages():
            kind = {"/tf": FrameTransforms}.get(channel.topic, SceneUpdate)
            if not channel.topic.startswith("/joint_states"):
                seen[channel.topic, message.log_time] = kind.FromString(message.data)
    assert attached == {name: (folder / name).read_bytes() for name in attached}
    assert set(attached) == {"robot.urdf", "human_1.urdf", "human_2.urdf"}
    for number, (human, payload, height) in enumerate(CASES):
        time = 2_000_000_000 * number
        scene = next(s for s in several.scenes if (s.human.label, s.payload.label) == (human, payload))
        tree = human_tree(PEOPLE[human])
        posture = logged_posture(run.details[1].cases[number].agents[HUMAN])
        state = AgentModel.of(scene.human, tree).at(posture)
        world_from = frames(seen["/tf", time])
        for link in ("LeftPalm", "RightPalm", "Head", "LeftSole"):
            _, origin = state.pose(link)
            expected = np.diag([-1.0, -1.0, 1.0]) @ origin
            assert np.allclose(world_from[f"human/{link}"][:3, 3], expected, rtol=0.0, atol=1e-9)
        (load,) = seen["/scene/load", time].entities
        assert load.cubes[0].size.x == scene.payload.size[0]
        assert [text.text for text in load.texts] == [f"{human}, {payload}, {height:g} m"]
        assert world_from["load"][2, 3] == pytest.approx(height)
        (cleared,) = seen["/scene/human", time].deletions
        assert cleared.type == type(cleared).ALL
        file = f"human_{[*PEOPLE].index(human) + 1}.urdf"
        assert f"| {2 * number} s | `{human}` | `{file}` | `{payload}` | {height:g} m |" in readme
        assert attached[file].decode() == urdf_text(tree)
    assert max(time for _, time in seen) == 2_000_000_000 * (len(CASES) - 1) + 1_000_000_000


def test_layout_says_what_time_means(folder: Path) -> None:
    panels = json.loads((folder / "layout.json").read_text())["configById"]
    assert panels["3D!scene"]["scene"]["labelScaleFactor"] == 1.0
    assert "2 s per case" in panels["Plot!human"]["title"]


def test_page_holds_everyone_and_every_case(run: RunLog) -> None:
    content = page_content(run)
    assert (content.people, content.payloads) == (tuple(PEOPLE), tuple(LOADS))
    assert content.bodies is not None
    masses = {
        name: sum(link.mass_kg for link in body.links)
        for name, body in ((label, each["human"]) for label, each in content.bodies.others.items())
    }
    assert masses == pytest.approx({name: person.mass for name, person in PEOPLE.items()})
    assert {name: load.mass_kg for name, load in content.bodies.payloads.items()} == LOADS
    for number, design in content.designs.items():
        check_to_seven_digits(design.postures, run.details[number].cases)


@pytest.mark.slow
def test_every_design_of_a_front_has_its_robot_with_everyone(several: DesignProblem, tmp_path: Path) -> None:
    many = write_several(several, tmp_path / "run", designs=80)
    content = page_content(many)
    assert content.facts.front == 80
    assert {number: len(design.postures) for number, design in content.designs.items()} == dict.fromkeys(
        range(80), len(CASES)
    )
    assert not any("postures" in note for note in content.notes)


def numbers_of(detail: Detail) -> int:
    """How many numbers of postures a design has: every leaf but those of cases and times."""
    agents = [
        agent for case in detail.cases for instant in case.instants for agent in instant.agents.values()
    ]
    return sum(len(leaves(agent)) for agent in agents)


def test_page_keeps_as_many_designs_as_have_room_with_all_their_pairs(
    several: DesignProblem, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    many = write_several(several, tmp_path / "run", designs=12)
    monkeypatch.setattr(postures, "MOST_NUMBERS", 8 * numbers_of(many.details[0]))
    content = page_content(many)
    assert sum(bool(design.postures) for design in content.designs.values()) == 8
    assert any(note.startswith("postures of 8 of 12 designs") for note in content.notes)


def test_figure_has_a_row_for_each_pair_and_a_column_for_each_height(
    run: RunLog, several: DesignProblem
) -> None:
    scene_set = random_company(several, 1)
    stages = [scene_set.placed_scene(run.details[1].cases[number]) for number in (0, 1, 3)]
    names = ["{}, {}\nload at {:g} m".format(*CASES[number]) if number != 2 else "" for number in range(4)]
    assert [axes.get_title() for axes in posture_figure(stages, "all but the third").axes] == names


def test_a_height_means_its_worst_case_and_a_case_has_a_name_of_its_own(run: RunLog) -> None:
    known = quantities(run.header, run.evaluations[0])
    for evaluation in run.evaluations:
        outcomes = evaluation.assessment.cases
        norms = [one.robot_torque_norm for one in outcomes if one.case.task.height_m == 0.8]
        assert len(norms) == 4
        assert known["robot_torque@0.8"](evaluation) == max(each for each in norms if each is not None)
        assert known["human_torque@tall@[crate]@1"](evaluation) == outcomes[-1].human_torque_norm
    bound = run.evaluations[0].assessment.cases[-1].human_torque_norm
    wanted = conditions(f"human_torque@tall@[crate]@1 <= {bound!r}", known, "--where")
    assert run.evaluations[0] in meeting(run.evaluations, wanted)


def test_cases_are_a_data_frame_with_people_and_loads(run: RunLog) -> None:
    opened = evodesign.open_run(run.directory)
    table = pd.DataFrame(opened.cases())
    assert len(table) == len(run.evaluations) * len(CASES)
    for number, own in table.groupby("number"):
        assert [*zip(own.human, own.payload, own.height, strict=True)] == CASES
        outcomes = run.evaluations[int(str(number))].assessment.cases
        assert [*own.robot_torque] == [one.robot_torque_norm for one in outcomes]
        assert [*own.human_torque] == [one.human_torque_norm for one in outcomes]
    assert opened.cases(opened.designs[:1])["number"].tolist() == [0] * len(CASES)
