"""Cases of files of a problem, each spoilt by its number, and what must be true of what they become."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evodesign.errors import EvodesignError
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from tests.fuzz.mutations import ANY
from tests.fuzz.toml_mutations import TOML
from tests.fuzz.xml_mutations import XML

SEED = 20260101
PROBLEM, ROBOT, PERSON, POPULATION = "problem.toml", "robot.urdf", "person.urdf", "designs.toml"


def arm(side: str, y: float) -> str:
    return f"""
  <link name="{side}_arm">
    <inertial><mass value="2.0"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><origin xyz="0 0 -0.2"/><geometry><cylinder radius="0.04" length="0.4"/></geometry></visual>
    <visual><origin xyz="0 0 -0.4"/><geometry><sphere radius="0.05"/></geometry></visual>
  </link>
  <link name="{side}_leg">
    <inertial><mass value="4.0"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><origin xyz="0 0 -0.3"/><geometry><box size="0.1 0.1 0.6"/></geometry></collision>
    <visual><geometry><mesh filename="leg.obj"/></geometry></visual>
  </link>
  <link name="{side}_sole"/>
  <joint name="{side}_shoulder" type="revolute"><origin xyz="0 {y} 0.4" rpy="0 0.1 0"/>
    <parent link="root_link"/><child link="{side}_arm"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
  <joint name="{side}_lift" type="prismatic"><origin xyz="0 {y} 0"/><parent link="root_link"/>
    <child link="{side}_leg"/><axis xyz="0 0 1"/><limit lower="-0.1" upper="0.2"/></joint>
  <joint name="{side}_floor" type="fixed"><origin xyz="0 0 -0.6"/><parent link="{side}_leg"/>
    <child link="{side}_sole"/></joint>"""


BODY = f"""<?xml version="1.0"?>
<robot name="body">
  <link name="root_link">
    <inertial><origin xyz="0 0 0.2"/><mass value="10.0"/>
      <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.2"/></inertial>
    <visual><origin xyz="0 0 0.2"/><geometry><box size="0.2 0.3 0.4"/></geometry></visual>
  </link>
  <link name="claw"><inertial><mass value="0.5"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="spin" type="continuous"><origin xyz="0 0 0.5"/><parent link="root_link"/><child link="claw"/>
    <axis xyz="0 0 1"/></joint>
  {arm("l", 0.2)}{arm("r", -0.2)}
</robot>
"""
PARTS = """
hands = { left = "l_palm", right = "r_palm" }
soles = { left = "l_sole", right = "r_sole", size_m = [0.2, 0.1] }
trunk = ["root_link"]
frames = [
    { name = "l_palm", link = "l_arm", xyz_m = [0.0, 0.0, -0.45] },
    { name = "r_palm", link = "r_arm", xyz_m = [0.0, 0.0, -0.45], rpy_rad = [0.0, 0.1, 0.0] },
]"""
MESHES = {"leg.obj": "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"}
"""What the robot shows beside its shapes; it is not spoilt."""

TEXTS = {
    PROBLEM: f"""
name = "small"

[robot]
urdf = "{ROBOT}"{PARTS}
inertia = "shapes"
joints = ["l_shoulder", "r_shoulder", "l_lift", "r_lift", "spin"]

[human]
urdf = "{PERSON}"{PARTS}

[payload]
size_m = [0.5, 0.5, 0.025]
mass_kg = 5.0
center_of_mass_m = [0.01, 0.0, 0.0]
grasp = "point"
robot_grasps_m = {{ left = [-0.25, 0.2, 0.0], right = [-0.25, -0.2, 0.0] }}

[task]
heights_m = [0.8, 1.0]
effort_weights = {{ robot = 1.0, human = 2.0 }}

[objectives]
minimise = ["robot_torque", "human_torque"]
maximise = ["reach_height"]

[search]
algorithm = "nsga2"
population = 8
evaluations = 16
seed = 1
start = "{POPULATION}"

[limits]
friction = 0.5
feet_apart_m = [0.12, 0.5]

[[design.length]]
name = "arm"
links = ["l_arm", "r_arm"]
lower = 0.6
upper = 1.8

[[design.density]]
name = "leg"
links = ["l_leg", "r_leg"]
lower_kg_per_m3 = 500.0
upper_kg_per_m3 = 4000.0
""",
    ROBOT: BODY,
    PERSON: BODY,
    POPULATION: """
name = "some"

[[design]]
name = "long"
length = { arm = 1.5 }

[[design]]
name = "heavy"
length = { arm = 0.9 }
density_kg_per_m3 = { leg = 2000.0 }
""",
}
TARGETS = (PROBLEM, PROBLEM, ROBOT, ROBOT, PERSON, POPULATION)


@dataclass(frozen=True)
class Spoilt:
    """A case: which file is spoilt by what, and what it then holds."""

    target: str
    mutations: tuple[str, ...]
    content: bytes


def spoilt_files(number: int) -> Spoilt:
    """The case of a number: one file, changed once to three times."""
    chance = np.random.default_rng([SEED, number])
    target = TARGETS[int(chance.integers(len(TARGETS)))]
    content = TEXTS[target].encode()
    chosen = []
    for _ in range(int(chance.choice([1, 1, 1, 2, 3]))):
        kinds = ANY if chance.random() < 0.4 else (TOML if target.endswith(".toml") else XML)
        mutation = kinds[int(chance.integers(len(kinds)))]
        content = mutation(content.decode("utf-8", "replace"), chance)
        chosen.append(mutation.__name__)
    return Spoilt(target, tuple(chosen), content)


def complaint(folder: Path) -> tuple[bool, str]:
    """Whether the folder was read as a problem, and what is wrong with that or with the refusal."""
    try:
        problem = build_problem(read_source(folder / PROBLEM))
        return True, "" if sound(problem) else "loaded with figures that are not finite"
    except EvodesignError as error:
        return False, about_sentence(str(error))
    except (Exception, RecursionError) as error:  # noqa: BLE001 - the very thing that is looked for
        trace = error.__traceback__
        while trace is not None and trace.tb_next is not None:
            trace = trace.tb_next
        place = "" if trace is None else f"{trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}"
        return False, f"{type(error).__name__} at {place}: {str(error)[:200]}"


def about_sentence(sentence: str) -> str:
    """What is wrong with a sentence."""
    if not any(name in sentence for name in TEXTS):
        return f"no file named: {sentence[:300]}"
    return "" if sentence.isprintable() else f"not one line: {sentence[:300]!r}"


def sound(problem: DesignProblem) -> bool:
    """Whether a problem's robot is of finite figures, at a design in the middle and as it is."""
    space, tree = problem.space, problem.scene.robot.tree
    middle = space.resized(tree, space.values((0.5,) * len(space.parameters)))
    figures = [
        *space.unscaled(tree),
        *(height for task in problem.tasks for height in task.heights),
        *problem.scene.payload.size,
        problem.scene.payload.mass,
    ]
    for link in (*tree.links, *middle.links, *problem.scene.human.tree.links):
        inertia = link.inertia
        figures += [inertia.mass, *inertia.center, *(x for row in inertia.about_center for x in row)]
    for joint in (*middle.joints, *problem.scene.human.tree.joints):
        figures += [*joint.parent_from_child.translation, *joint.axis]
    return all(math.isfinite(figure) for figure in figures)
