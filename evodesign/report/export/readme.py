"""The README of an exported folder: what each file is, frames, units and scales."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from evodesign.errors import on_one_line
from evodesign.records import Constraint, Objective, materials_of
from evodesign.report.export.design import ExportedDesign
from evodesign.report.replay.messages import METRES_PER_NEWTON, METRES_PER_NEWTON_METRE
from evodesign.report.replay.recording import SECONDS_PER_CASE, several, timed
from evodesign.violations import bounds_text, reason_of_infeasibility

MESHES: Final = "meshes"
"""The folder of mesh files."""

CAD: Final = "cad"
"""The folder of CAD files."""

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
Coordinates of the root links, joint positions and joint torques of each agent, one joint per row.""",
    "wrenches.csv": """\
Force and moment on each hand (about the grasp point, in the agent's own frame) and foot (about the sole's
origin, in the sole's frame).""",
    "postures.json": """\
All that is known of this design: parameters, objectives, reach, outcome and postures by height.""",
    "replay.mcap": """\
The postures as a recording, heights as time: ten seconds per metre, so a load at 1.2 m is at 12 s, and the
last posture stays a second. Open it in Foxglove or Lichtblick with "Open local file". `/tf` holds all frames,
`/scene/...` shapes and arrows, `/joint_states/...` positions, and torques as efforts; the URDF files are
attached.""",
    "layout.json": """\
Panels for the recording. In Foxglove or Lichtblick: the layout menu, "Import from file".""",
    CAD: """\
The robot for CAD programs and workshops, in millimetres: STEP and STL of each link, an assembly, a drawing,
and how their masses and inertias agree with `robot.urdf`; `cad/README.md` says what they are.""",
}
"""What each file is."""

WITH_MESHES: Final[Mapping[str, str]] = {
    "robot.urdf": """\
The robot of this design, shown by the files in `meshes`, which have to stay beside it. Any URDF viewer opens
it, `yourdfpy robot.urdf`, and in Python
`pinocchio.buildModelsFromUrdf("robot.urdf", ".", pinocchio.JointModelFreeFlyer())`. MuJoCo opens it, too, but
fixes its root and shows no meshes: take the next file there.""",
    "meshes": """\
What the robot looks like, as binary STL [m], each in the axes of its `<origin>` in `robot.urdf`: scale and
the stretch of longer links are in the vertices. These are not the original files but what the run keeps of
them, the same forms in fewer triangles, at most 2,000 each.""",
}
"""What it says instead where meshes show the robot."""

HEIGHTS_AS_TIME: Final = "heights as time: ten seconds per metre, so a load at 1.2 m is at 12 s"
CASES_AS_TIME: Final = f"one case after the other, {SECONDS_PER_CASE} seconds each"

FRAMES: Final = """\
SI units throughout. World: origin on the ground under the load, x from the robot towards the load, z up. An
agent's own frame is the world turned about z so that it looks along +x at the load. Roll, pitch and yaw are
those of URDF. Joints that are not listed stand at zero.
"""


def readme_text(design: ExportedDesign, files: Sequence[str], left_out: Mapping[str, str]) -> str:
    """The README as Markdown.

    Args:
        design: what was exported.
        files: names of the files that were written, of `FILES`, or in `MESHES` or `CAD`.
        left_out: why a file is missing, by its name.
    """
    evaluation = design.evaluation
    values, constrained = evaluation.assessment.objectives, evaluation.assessment.constrained
    objectives = (_quantity(each, each.sense, values) for each in design.header.objectives)
    bounds = (_quantity(each, bounds_text(each), constrained) for each in design.header.constrained)
    materials = materials_of(design.header.parameters, evaluation.assessment.design)
    made_of = (f"- {_code(name)}: {_code(material)}" for name, material in materials.items())
    missing = (f"- no `{name}`: {_code(reason)}" for name, reason in left_out.items())
    texts = {name: text.replace("\n", "\n  ") for name, text in _texts(design, files).items()}
    shown = dict.fromkeys(name.partition("/")[0] for name in files)
    parts = [
        f"# Design {evaluation.number} of {_code(design.header.problem_name)}",
        f"From the run {_code(design.run)}, generation {evaluation.generation}; {_outcome(design)}.",
        "\n".join((*objectives, *bounds, *made_of)),
        *(f"Note: {_code(note)}" for note in design.notes),
        "## Files",
        "\n".join((*(f"- `{name}`: {texts[name]}" for name in shown), *missing)),
        *_cases(design),
        "## Frames and units",
        FRAMES + _scales(),
    ]
    return "\n\n".join(parts) + "\n"


def _texts(design: ExportedDesign, files: Sequence[str]) -> dict[str, str]:
    """What each file is, also where there are several people or loads."""
    texts = dict(FILES)
    if any(name.startswith(f"{MESHES}/") for name in files):
        texts |= WITH_MESHES
    for name, (label, _) in design.scene_set.others_files.items():
        if name not in texts:
            who = (
                f"The robot {_code(label)}, which no design changes"
                if "robot" in name
                else f"The person {_code(label)}"
            )
            texts[name] = f"{who}, for kinematics and viewing."
    if several(design.cases):
        texts["robot.xml"] = FILES["robot.xml"].replace("per load height", "per case")
        texts["replay.mcap"] = FILES["replay.mcap"].replace(HEIGHTS_AS_TIME, CASES_AS_TIME)
    return texts


def _cases(design: ExportedDesign) -> tuple[str, ...]:
    """The cases that were solved with their times in the recording, of several people or loads."""
    if not several(design.cases):
        return ()
    scene_set = design.scene_set
    named = {label: name for name, (label, _) in scene_set.others_files.items()}
    files = {
        models.pair[0]: ", ".join(f"`{named[person.label]}`" for person in models.people)
        for models in scene_set.models
    }
    rows = [
        f"| {time / 1e9:g} s | {_cell(case.person)} | {files[case.person]} "
        f"| {_cell(case.payload)} | {case.task} |"
        for case, time in {detail.case: time for time, detail in reversed(timed(design.cases))}.items()
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


def _quantity(each: Objective | Constraint, wanted: str, values: Mapping[str, float]) -> str:
    value = values.get(each.name)
    shown = "none" if value is None else f"{value!r} {each.unit}"
    return f"- {_code(each.name)} ({wanted}): {shown}"


def _code(text: str) -> str:
    """A name as a code span on one line, which Markdown shows letter by letter."""
    return f"`{on_one_line(text).replace('`', chr(39))}`"
