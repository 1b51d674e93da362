"""Writing the folder of a design: all of its files, and a README about them.

File names are fixed, whatever the names in problem and robot are. Everything is made before anything is
written, and only into a folder that is empty or new.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import msgspec

from evodesign.errors import InputError, ModelError
from evodesign.evaluation.progress import SILENT, PrecomputeProgress
from evodesign.files import write_folder
from evodesign.mechanics.agent import ROBOT
from evodesign.mechanics.balance import GRAVITY
from evodesign.report.export.design import ExportedDesign, design_json, postures_csv, wrenches_csv
from evodesign.report.export.readme import CAD, MESHES, readme_text
from evodesign.report.opened_design import open_design
from evodesign.report.replay.layout import layout_text
from evodesign.report.replay.recording import replay_frames, time_scale, write_frames
from evodesign.runlog.run import RunLog
from evodesign.tree.mesh_write import mesh_files
from evodesign.tree.mjcf_write import KeyPosture, mjcf_text
from evodesign.tree.urdf_write import urdf_text


@dataclass(frozen=True, slots=True)
class Exported:
    """What came of an export.

    Args:
        files: what was written.
        left_out: why a file is missing, by its name.
    """

    files: tuple[Path, ...]
    left_out: dict[str, str]


def refuse_full(directory: Path) -> None:
    """Refuse a place where an export would mix with other files.

    Raises:
        InputError: it is a file, or a folder that holds something.
    """
    wanted = "a new or empty folder"
    try:
        if directory.exists() and not directory.is_dir():
            raise InputError("--to", "", wanted, f"the file '{directory}'")
        if directory.is_dir() and any(directory.iterdir()):
            raise InputError("--to", "", wanted, f"'{directory}', which holds files")
    except OSError as error:
        raise InputError("--to", "", wanted, f"'{directory}' ({error.strerror})") from error


def export_logged(
    run: RunLog,
    number: int,
    directory: Path,
    jobs: int = 1,
    progress: PrecomputeProgress = SILENT,
    *,
    cad: bool = False,
) -> Exported:
    """Write the folder of a design of a run; one without logged postures is solved anew.

    Args:
        run: that holds it.
        number: of the evaluation.
        directory: a new or empty folder.
        jobs: that may work out what a solve needs first.
        progress: is shown what is worked out.
        cad: whether CAD files of the robot are written, too (`refuse_without_cad` says whether they can be).
    Raises:
        RunError: the run holds no evaluation yet.
        InputError: it holds none of that number; or as `export_design`.
    """
    from evodesign.evaluation.bill import link_materials  # CasADi takes its time to load

    opened = open_design(run, number, jobs, progress)
    name = run.directory.resolve().name
    problem, scene_set = opened.rebuilt.problem, opened.scene_set()
    materials = link_materials(problem.space, scene_set.robot)
    notes = problem.symmetry_notes
    design = ExportedDesign(name, run.header, opened.evaluation, scene_set, opened.cases, notes, materials)
    return export_design(design, directory, on_front=opened.on_front, cad=cad)


def export_design(design: ExportedDesign, directory: Path, *, on_front: bool, cad: bool = False) -> Exported:
    """Write a design's folder.

    Args:
        design: what to write.
        directory: a new or empty folder.
        on_front: whether no design of the run dominates it.
        cad: whether CAD files of the robot are written, too.
    Raises:
        InputError: the folder holds files already, or cannot be written.
    """
    refuse_full(directory)
    contents, left_out = _contents(design, on_front=on_front)
    if cad:
        contents.update(_cad(design))
    names = [*contents]
    contents = {"README.md": readme_text(design, names, left_out).encode(), **contents}
    try:
        write_folder(directory, contents)
    except OSError as error:
        found = f"'{directory}' ({error.strerror})"
        raise InputError("--to", "", "a folder that can be written", found) from error
    return Exported(tuple(directory / name for name in contents), left_out)


def _contents(design: ExportedDesign, *, on_front: bool) -> tuple[dict[str, bytes], dict[str, str]]:
    """Bytes of each file by name, and why others are missing."""
    scene_set, cases = design.scene_set, design.cases
    people = {name: urdf_text(tree) for name, (_, tree) in scene_set.others_files.items()}
    names, meshes = mesh_files(scene_set.robot, MESHES)
    urdfs = {"robot.urdf": urdf_text(scene_set.robot, names), **people}
    told = design_json(design.header, design.evaluation, cases, on_front=on_front)
    contents = {"robot.urdf": urdfs["robot.urdf"].encode()}
    left_out = {}
    try:
        contents["robot.xml"] = mjcf_text(scene_set.robot, GRAVITY, _keys(design), names).encode()
    except ModelError as error:
        left_out["robot.xml"] = str(error)
    contents.update(meshes)
    contents.update({name: text.encode() for name, text in people.items()})
    contents["postures.json"] = msgspec.json.format(msgspec.json.encode(told), indent=2) + b"\n"
    if not cases:
        reason = "no posture was found at any height"
        return contents, {**left_out, "postures.csv": reason, "replay.mcap": reason}
    contents["postures.csv"] = postures_csv(scene_set, cases).encode()
    contents["wrenches.csv"] = wrenches_csv(scene_set, cases).encode()
    recording = io.BytesIO()
    write_frames(recording, scene_set, replay_frames(scene_set, cases), urdfs, _about(design))
    contents["replay.mcap"] = recording.getvalue()
    contents["layout.json"] = layout_text(scene_set, cases).encode()
    return contents, left_out


def _cad(design: ExportedDesign) -> dict[str, bytes]:
    """The CAD files of the robot, by name with their folder."""
    from evodesign.report.cad.folder import cad_files  # Open CASCADE is an extra, and takes a second to load

    evaluation, header = design.evaluation, design.header
    title = f"{header.problem_name}, design {evaluation.number}"
    files = cad_files(design.scene_set.robot, design.materials, title, header.started)
    return {f"{CAD}/{name}": content for name, content in files.items()}


def _keys(design: ExportedDesign) -> dict[str, KeyPosture]:
    """The robot's postures as keyframes, by person and load where there are several, and by height."""
    root = design.scene_set.robot.root
    keys = {}
    for detail in (moment for case in design.cases for moment in case.few_moments):
        name = ", ".join(part for part in (detail.case.label, f"load at {detail.place}") if part)
        frames = design.scene_set.placed_scene(detail).frames[ROBOT]
        keys[name] = KeyPosture(frames[root], detail.agents[ROBOT].joints_rad)
    return keys


def _about(design: ExportedDesign) -> dict[str, str]:
    evaluation = design.evaluation
    return {
        "problem": design.header.problem_name,
        "run": design.run,
        "design": str(evaluation.number),
        "time": time_scale(design.cases),
    }


def refuse_without_cad() -> None:
    """Refuse to write CAD files without Open CASCADE.

    Raises:
        InputError: it is not installed.
    """
    if find_spec("OCP") is None:
        wanted = "Open CASCADE installed (pip install 'evodesign[cad]')"
        raise InputError("--cad", "", wanted, "no package 'OCP'")
