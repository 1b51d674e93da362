"""Writing the folder of a design, with a README: what each file is and how to open it.

File names are fixed, whatever the names in problem and robot are. Everything is made before anything is
written, and only into a folder that is empty or new.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import msgspec

from evodesign.errors import InputError, ModelError, on_one_line
from evodesign.files import write_folder
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.scene import ROBOT
from evodesign.problem.progress import SILENT, PrecomputeProgress
from evodesign.records import Constraint, Objective, materials_of
from evodesign.report.export.design import ExportedDesign, design_json, postures_csv, wrenches_csv
from evodesign.report.opened_design import open_design
from evodesign.report.replay.layout import layout_text
from evodesign.report.replay.messages import METRES_PER_NEWTON, METRES_PER_NEWTON_METRE
from evodesign.report.replay.recording import SECONDS_PER_CASE, several, time_scale, timed, write_replay
from evodesign.runlog.run import RunLog
from evodesign.tree.mjcf_write import KeyPosture, mjcf_text
from evodesign.tree.urdf_write import urdf_text
from evodesign.violations import bounds_text, reason_of_infeasibility

__all__ = ["FILES", "Exported", "export_design", "export_logged", "readme_text", "refuse_full"]

FILES: Final[Mapping[str, str]] = {
    "robot.urdf": """\
The robot of this design, made of spheres, cylinders and boxes; it needs no other file. Any URDF viewer opens
it, `yourdfpy robot.urdf`, and in Python
`pinocchio.buildModelFromUrdf("robot.urdf", pinocchio.JointModelFreeFlyer())`. MuJoCo opens it, too, but
fixes its root: take the next file there.""",
    "robot.xml": """\
The same robot for MuJoCo, floating over a ground plane, with a keyframe per load height:
`python -m mujoco.viewer --mjcf=robot.xml`, there Simulation, Key, Load key. Nothing drives the joints and
there is no load, so pause it first.""",
    "human.urdf": """\
The person, for kinematics and viewing; MuJoCo refuses links that move and have no mass.""",
    "postures.csv": """\
Coordinates of the root links, joint positions and joint torques of robot and person, one joint per row.""",
    "wrenches.csv": """\
Force and moment on each hand (about the grasp point, in the agent's own frame) and foot (about the sole's
origin, in the sole's frame).""",
    "postures.json": """\
All that is known of this design: parameters, objectives, reach, outcome and postures by height.""",
    "replay.mcap": """\
The postures as a recording, heights as time: ten seconds per metre, so a load at 1.2 m is at 12 s, and the
last posture stays a second. Open it in Foxglove or Lichtblick with "Open local file". `/tf` holds all frames,
`/scene/...` shapes and arrows, `/joint_states/...` positions, and torques as efforts; both URDF files are
attached.""",
    "layout.json": """\
Panels for the recording. In Foxglove or Lichtblick: the layout menu, "Import from file".""",
}
"""What each file is."""

HEIGHTS_AS_TIME: Final = "heights as time: ten seconds per metre, so a load at 1.2 m is at 12 s"
CASES_AS_TIME: Final = f"one case after the other, {SECONDS_PER_CASE} seconds each"

FRAMES: Final = """\
SI units throughout. World: origin on the ground under the load, x from the robot towards the person, z up. An
agent's own frame is the world turned about z so that it looks along +x at the load. Roll, pitch and yaw are
those of URDF. Joints that are not listed stand at zero.
"""


def readme_text(design: ExportedDesign, files: Sequence[str], left_out: Mapping[str, str]) -> str:
    """The README as Markdown.

    Args:
        design: what was exported.
        files: names of the files that were written, of `FILES`.
        left_out: why a file is missing, by its name.
    """
    evaluation = design.evaluation
    objectives = (_objective(each, evaluation.assessment.objectives) for each in design.header.objectives)
    bounds = (_constraint(each, evaluation.assessment.constrained) for each in design.header.constrained)
    materials = materials_of(design.header.parameters, evaluation.assessment.design)
    made_of = (f"- {_code(name)}: {_code(material)}" for name, material in materials.items())
    missing = (f"- no `{name}`: {_code(reason)}" for name, reason in left_out.items())
    texts = _texts(design)
    parts = [
        f"# Design {evaluation.number} of {_code(design.header.problem_name)}",
        f"From the run {_code(design.run)}, generation {evaluation.generation}; {_outcome(design)}.",
        "\n".join((*objectives, *bounds, *made_of)),
        "## Files",
        "\n".join((*(f"- `{name}`: {_indented(texts[name])}" for name in files), *missing)),
        *_cases(design),
        "## Frames and units",
        FRAMES + _scales(),
    ]
    return "\n\n".join(parts) + "\n"


def _texts(design: ExportedDesign) -> dict[str, str]:
    """What each file is, also where there are several people or loads."""
    texts = dict(FILES)
    if len(design.people) > 1:
        for name, (label, _) in design.people.items():
            texts[name] = f"The person {_code(label)}, for kinematics and viewing."
    if several(design.cases):
        texts["robot.xml"] = FILES["robot.xml"].replace("per load height", "per case")
        replay = FILES["replay.mcap"].replace(HEIGHTS_AS_TIME, CASES_AS_TIME)
        texts["replay.mcap"] = replay.replace("both URDF files", "all URDF files")
    return texts


def _cases(design: ExportedDesign) -> tuple[str, ...]:
    """The cases that were solved with their times in the recording, of several people or loads."""
    if not several(design.cases):
        return ()
    files = {label: name for name, (label, _) in design.people.items()}
    rows = [
        f"| {time / 1e9:g} s | {_cell(case.person)} | `{files[case.person]}` "
        f"| {_cell(case.payload)} | {case.task} |"
        for time, case in ((time, detail.case) for time, detail in timed(design.cases))
    ]
    heads = ("| time in the recording | person | file | load | height |", "|---|---|---|---|---|")
    return ("## Cases", "\n".join((*heads, *rows)))


def _cell(name: str) -> str:
    """A name in a table; a dash where there is only one."""
    return _code(name).replace("|", "\\|") if name else "-"


def _scales() -> str:
    ground, load = (1.0 / METRES_PER_NEWTON[by_ground] for by_ground in (True, False))
    moment = 1.0 / METRES_PER_NEWTON_METRE
    return (
        f"In the recording 1 m of arrow is {ground:g} N from the ground (orange, at the centre of\n"
        f"pressure), {load:g} N from the load (violet), {moment:g} N m of moment (green)."
    )


def _outcome(design: ExportedDesign) -> str:
    evaluation = design.evaluation
    if evaluation.feasible:
        return "it is feasible"
    why = reason_of_infeasibility(design.header.constrained, evaluation.assessment)
    return f"it is not feasible: {_code(why)}"


def _objective(objective: Objective, values: Mapping[str, float]) -> str:
    value = values.get(objective.name)
    shown = "none" if value is None else f"{value!r} {objective.unit}"
    return f"- {_code(objective.name)} ({objective.sense}): {shown}"


def _constraint(constraint: Constraint, values: Mapping[str, float]) -> str:
    value = values.get(constraint.name)
    shown = "none" if value is None else f"{value!r} {constraint.unit}"
    return f"- {_code(constraint.name)} ({bounds_text(constraint)}): {shown}"


def _indented(text: str) -> str:
    return text.replace("\n", "\n  ")


def _code(text: str) -> str:
    """A name as a code span on one line, which Markdown shows letter by letter."""
    return f"`{on_one_line(text).replace('`', chr(39))}`"


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
    run: RunLog, number: int, directory: Path, jobs: int = 1, progress: PrecomputeProgress = SILENT
) -> Exported:
    """Write the folder of a design of a run; one without logged postures is solved anew.

    Args:
        run: that holds it.
        number: of the evaluation.
        directory: a new or empty folder.
        jobs: that may work out what a solve needs first.
        progress: is shown what is worked out.
    Raises:
        RunError: the run holds no evaluation yet.
        InputError: it holds none of that number; or as `export_design`.
    """
    opened = open_design(run, number, jobs, progress)
    name = run.directory.resolve().name
    design = ExportedDesign(name, run.header, opened.evaluation, opened.scene_set(), opened.cases)
    return export_design(design, directory, on_front=opened.on_front)


def export_design(design: ExportedDesign, directory: Path, *, on_front: bool) -> Exported:
    """Write a design's folder.

    Args:
        design: what to write.
        directory: a new or empty folder.
        on_front: whether no design of the run dominates it.
    Raises:
        InputError: the folder holds files already, or cannot be written.
    """
    refuse_full(directory)
    contents, left_out = _contents(design, on_front=on_front)
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
    people = {name: urdf_text(tree) for name, (_, tree) in design.people.items()}
    urdfs = {"robot.urdf": urdf_text(scene_set.robot), **people}
    told = design_json(design.header, design.evaluation, cases, on_front=on_front)
    contents = {"robot.urdf": urdfs["robot.urdf"].encode()}
    left_out = {}
    try:
        contents["robot.xml"] = mjcf_text(scene_set.robot, GRAVITY, _keys(design)).encode()
    except ModelError as error:
        left_out["robot.xml"] = str(error)
    contents.update({name: text.encode() for name, text in people.items()})
    contents["postures.json"] = msgspec.json.format(msgspec.json.encode(told), indent=2) + b"\n"
    if not cases:
        reason = "no posture was found at any height"
        return contents, {**left_out, "postures.csv": reason, "replay.mcap": reason}
    contents["postures.csv"] = postures_csv(scene_set, cases).encode()
    contents["wrenches.csv"] = wrenches_csv(scene_set, cases).encode()
    recording = io.BytesIO()
    write_replay(recording, scene_set, cases, urdfs, _about(design))
    contents["replay.mcap"] = recording.getvalue()
    contents["layout.json"] = layout_text(scene_set, cases).encode()
    return contents, left_out


def _keys(design: ExportedDesign) -> dict[str, KeyPosture]:
    """The robot's postures as keyframes, by person and load where there are several, and by height."""
    root = design.scene_set.robot.root
    keys = {}
    for detail in design.cases:
        name = ", ".join(part for part in (detail.case.label, f"load at {detail.case.task}") if part)
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
