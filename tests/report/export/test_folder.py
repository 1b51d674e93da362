"""An exported folder: every file opens, says what the log says, and has a safe name."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import mujoco
import pinocchio
import pytest
import yourdfpy
from mcap.reader import make_reader

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.mechanics.agent import ROBOT, SIDES
from evodesign.problem.build import DesignProblem
from evodesign.records import (
    FORMAT_VERSION,
    Assessment,
    Detail,
    Evaluation,
    ReachOutcome,
    RunHeader,
    Status,
)
from evodesign.report.export import readme
from evodesign.report.export.design import ExportedDesign
from evodesign.report.export.folder import export_design
from evodesign.report.scene_models import SceneModels, SceneSet
from evodesign.tree.model import Joint, JointKind, Link, Tree
from tests.report.scenes import hold_json, random_detail, random_values
from tests.tree.crane import crane

FILES = {
    "README.md",
    "robot.urdf",
    "robot.xml",
    "human.urdf",
    "postures.csv",
    "wrenches.csv",
    "postures.json",
    "replay.mcap",
    "layout.json",
}


def design_of(problem: DesignProblem, detail: Detail, seed: int = 2) -> ExportedDesign:
    values = random_values(problem, seed)
    tree = problem.space.resized(problem.scene.robot.tree, values)
    header = RunHeader(
        format_version=FORMAT_VERSION,
        problem=problem.source,
        problem_name="../x <script>`alert(1)`</script>\n# no heading",
        parameters=problem.space.records,
        objectives=problem.objectives,
        search=problem.settings("random", 4, 1),
        budget=4,
        versions={},
        git=None,
        started="2024-01-01T00:00:00+00:00",
    )
    assessment = Assessment(
        design=dict(problem.space.named(values)),
        objectives={"robot_torque": 11.25, "reach_height": 1.5},
        violation=0.0 if detail.cases else 0.25,
        status=Status.SOLVED,
        reason="solved" if detail.cases else "0.25 m <too> high",
        reach=ReachOutcome(lowest_m=0.1, highest_m=1.5, status=Status.SOLVED, reason=""),
    )
    evaluation = Evaluation(
        number=0,
        generation=0,
        genome=problem.space.genome(values),
        assessment=assessment,
        seconds=0.1,
        worker="here",
    )
    return ExportedDesign("runs/<b>", header, evaluation, SceneSet.of(problem.scenes, tree), detail.cases)


@pytest.fixture(scope="module")
def exported(problem: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> tuple[ExportedDesign, Path]:
    design = design_of(problem, random_detail(problem, 2))
    folder = tmp_path_factory.mktemp("export") / "new" / "folder"
    done = export_design(design, folder, on_front=True)
    assert not done.left_out
    assert {path.name for path in done.files} == FILES
    return design, folder


def test_folder_holds_the_files_that_its_readme_explains(exported: tuple[ExportedDesign, Path]) -> None:
    _, folder = exported
    assert {path.name for path in folder.iterdir()} == FILES
    readme = (folder / "README.md").read_text()
    for name in FILES - {"README.md"}:
        assert f"- `{name}`: " in readme


def test_readme_shows_names_as_text(exported: tuple[ExportedDesign, Path]) -> None:
    lines = (exported[1] / "README.md").read_text().splitlines()
    assert lines[0] == "# Design 0 of `../x <script>'alert(1)'</script>\\n# no heading`"
    assert "`runs/<b>`" in lines[2]
    assert "- `robot_torque` (minimise): 11.25 N m" in lines
    assert "- `human_torque` (minimise): none" in lines


def test_robot_files_open_with_the_mass_of_the_design(exported: tuple[ExportedDesign, Path]) -> None:
    design, folder = exported
    mass = sum(link.inertia.mass for link in design.scene_set.robot.links)
    urdf = folder / "robot.urdf"
    assert "package://" not in urdf.read_text()
    assert "<mesh" not in urdf.read_text()
    floating = pinocchio.buildModelFromUrdf(str(urdf), pinocchio.JointModelFreeFlyer())
    assert pinocchio.computeTotalMass(floating) == pytest.approx(mass, abs=1e-9)
    for path in (urdf, folder / "robot.xml"):
        assert float(mujoco.MjModel.from_xml_path(str(path)).body_mass.sum()) == pytest.approx(
            mass if path.suffix == ".xml" else mass - welded_root_mass(design), abs=1e-9
        )
    links = yourdfpy.URDF.load(str(urdf)).link_map.values()
    assert sum(link.inertial.mass for link in links if link.inertial) == pytest.approx(mass, abs=1e-9)
    pinocchio.buildModelFromUrdf(str(folder / "human.urdf"))


def welded_root_mass(design: ExportedDesign) -> float:
    """MuJoCo welds a URDF's root, and everything fixed to it, into its massless world."""
    tree = design.scene_set.robot
    return float(tree.link_by_name[tree.root].inertia.mass)


def test_keyframes_are_the_postures(exported: tuple[ExportedDesign, Path]) -> None:
    design, folder = exported
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    data = mujoco.MjData(model)
    assert model.nkey == 3
    for detail in design.cases:
        height = detail.case.task.height_m
        mujoco.mj_resetDataKeyframe(model, data, model.key(f"load at {height:g} m").id)
        posture = detail.agents[ROBOT]
        assert data.qpos[:3].tolist() == pytest.approx(posture.base_position_m)
        for joint, position in posture.joints_rad.items():
            assert data.joint(joint).qpos[0] == position


def test_tables_hold_the_logged_numbers(exported: tuple[ExportedDesign, Path]) -> None:
    design, folder = exported
    rows = list(csv.DictReader(io.StringIO((folder / "postures.csv").read_text())))
    wrenches = list(csv.DictReader(io.StringIO((folder / "wrenches.csv").read_text())))
    for detail in design.cases:
        height = detail.case.task.height_m
        for agent, posture in detail.agents.items():
            own = [row for row in rows if (float(row["height_m"]), row["agent"]) == (height, agent)]
            base = [float(row["position"]) for row in own if row["kind"] == "base"]
            assert base == [*posture.base_position_m, *posture.base_rpy_rad]
            joints = [row for row in own if row["kind"] != "base"]
            assert {row["name"]: float(row["position"]) for row in joints} == posture.joints_rad
            assert {row["name"]: float(row["torque"]) for row in joints} == posture.torques_n_m
            assert {row["position_unit"] for row in joints} == {"rad"}
            assert {*posture.wrenches} == {f"{side}_{part}" for side in SIDES for part in ("hand", "foot")}
            for name, wrench in posture.wrenches.items():
                (row,) = (
                    row
                    for row in wrenches
                    if (float(row["height_m"]), row["agent"], row["contact"]) == (height, agent, name)
                )
                numbers = [float(value) for key, value in row.items() if key.endswith(("_n", "_n_m"))]
                assert numbers == list(wrench)


def test_json_holds_the_logged_design(exported: tuple[ExportedDesign, Path]) -> None:
    design, folder = exported
    told = json.loads((folder / "postures.json").read_text())
    assert told["problem"] == design.header.problem_name
    assert told["parameters"] == design.evaluation.assessment.design
    assert told["objectives"] == design.evaluation.assessment.objectives
    assert told["on_front"] is True
    assert told["postures"] == [hold_json(detail) for detail in design.cases]


def test_replay_carries_both_models(exported: tuple[ExportedDesign, Path]) -> None:
    _, folder = exported
    with (folder / "replay.mcap").open("rb") as stream:
        attached = {each.name: each.data for each in make_reader(stream).iter_attachments()}
    assert attached == {name: (folder / name).read_bytes() for name in ("robot.urdf", "human.urdf")}


def test_design_without_a_posture_is_exported_without_a_replay(
    problem: DesignProblem, tmp_path: Path
) -> None:
    done = export_design(design_of(problem, Detail(evaluation=0, cases=())), tmp_path, on_front=False)
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"README.md", "robot.urdf", "robot.xml", "human.urdf", "postures.json"}
    assert {path.name for path in done.files} == written
    readme = (tmp_path / "README.md").read_text()
    assert "not feasible: `0.25 m <too> high`" in readme
    assert "- no `replay.mcap`: `no posture was found at any height`" in readme
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    assert model.nkey == 0


def test_robot_that_mujoco_cannot_hold_is_exported_as_urdf_only(
    problem: DesignProblem, tmp_path: Path
) -> None:
    design = design_of(problem, Detail(evaluation=0, cases=()))
    bare = crane()
    mast = Joint("mast", JointKind.REVOLUTE, bare.root, "pennant", Placement(), lower=-1.0, upper=1.0)
    robot = Tree("crane", (*bare.links, Link("pennant")), (*bare.joints, mast))
    trees = {ROBOT: robot, "human": bare}
    (only,) = design.scene_set.models
    scene_set = SceneSet((SceneModels(only.agents, trees, only.payload),))
    other = ExportedDesign(design.run, design.header, design.evaluation, scene_set, ())
    done = export_design(other, tmp_path, on_front=False)
    assert "mass, which MuJoCo asks of every link that moves" in done.left_out["robot.xml"]
    assert not (tmp_path / "robot.xml").exists()
    assert "- no `robot.xml`: " in (tmp_path / "README.md").read_text()


def test_folder_with_files_is_refused_and_left_alone(problem: DesignProblem, tmp_path: Path) -> None:
    design = design_of(problem, Detail(evaluation=0, cases=()))
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="a new or empty folder"):
        export_design(design, tmp_path, on_front=False)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    with pytest.raises(InputError, match="a new or empty folder"):
        export_design(design, tmp_path / "mine.txt", on_front=False)
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_equal_designs_give_equal_files(exported: tuple[ExportedDesign, Path], tmp_path: Path) -> None:
    design, folder = exported
    export_design(design, tmp_path, on_front=True)
    for path in folder.iterdir():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes(), path.name


def test_only_the_file_of_a_person_speaks_of_one() -> None:
    """A robot may hold the load alone."""
    for name, text in {**readme.FILES, "frames": readme.FRAMES}.items():
        assert ("person" in text.lower()) is (name == "human.urdf"), name
