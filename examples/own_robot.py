"""A robot of your own: its URDF from a table of boxes, and a problem from a dictionary. Half a minute.

python examples/own_robot.py [EVALUATIONS]
"""

import sys
from pathlib import Path

import evodesign

ONE_SIDE = [  # name, parent, where the joint is in the parent [m], axis of the joint, size of the box [m]
    ("hip", "pelvis", (0.0, 0.09, 0.0), "1 0 0", (0.06, 0.06, 0.06)),
    ("thigh", "hip", (0.0, 0.0, -0.03), "0 1 0", (0.09, 0.09, 0.34)),
    ("shank", "thigh", (0.0, 0.0, -0.34), "0 1 0", (0.07, 0.07, 0.34)),
    ("ankle", "shank", (0.0, 0.0, -0.34), "0 1 0", (0.05, 0.05, 0.05)),
    ("foot", "ankle", (0.0, 0.0, -0.05), "1 0 0", (0.22, 0.1, 0.04)),
    ("shoulder", "chest", (0.0, 0.17, 0.36), "0 1 0", (0.07, 0.07, 0.07)),
    ("upper_arm", "shoulder", (0.0, 0.0, -0.07), "1 0 0", (0.06, 0.06, 0.22)),
    ("forearm", "upper_arm", (0.0, 0.0, -0.22), "0 1 0", (0.05, 0.05, 0.24)),
]
LINKS = [("chest", "pelvis", (0.0, 0.0, 0.1), "0 1 0", (0.14, 0.26, 0.4))]  # its box goes upwards
for side, sign in (("l", 1.0), ("r", -1.0)):
    LINKS += [
        (
            f"{side}_{name}",
            parent if parent in ("pelvis", "chest") else f"{side}_{parent}",
            (x, sign * y, z),
            axis,
            size,
        )
        for name, parent, (x, y, z), axis, size in ONE_SIDE
    ]


def link(name, size, up):
    """A box of 900 kg/m^3 that hangs from the origin of its link, or stands on it."""
    x, y, z = size
    mass = 900.0 * x * y * z
    xx, yy, zz = (mass * (a * a + b * b) / 12.0 for a, b in ((y, z), (x, z), (x, y)))
    at = f'<origin xyz="0 0 {z / 2 if up else -z / 2}" rpy="0 0 0"/>'
    box = f'{at}<geometry><box size="{x} {y} {z}"/></geometry>'
    inertia = f'<inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/>'
    return (
        f'<link name="{name}"><inertial>{at}<mass value="{mass}"/>{inertia}</inertial>'
        f"<visual>{box}</visual><collision>{box}</collision></link>"
    )


def joint(name, parent, place, axis):
    x, y, z = place
    limit = '<limit lower="-2.4" upper="2.4" effort="80" velocity="5"/>'
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{name}"/>'
        f'<origin xyz="{x} {y} {z}" rpy="0 0 0"/><axis xyz="{axis}"/>{limit}</joint>'
    )


def frame(name, parent, z):
    return (
        f'<link name="{name}"/><joint name="{name}" type="fixed"><parent link="{parent}"/>'
        f'<child link="{name}"/><origin xyz="0 0 {z}" rpy="0 0 0"/></joint>'
    )


PARTS = [link("pelvis", (0.14, 0.22, 0.1), up=True)]
PARTS += [link(name, size, name == "chest") + joint(name, *where) for name, *where, size in LINKS]
PARTS += [frame(f"{s}_hand", f"{s}_forearm", -0.24) + frame(f"{s}_sole", f"{s}_foot", -0.04) for s in "lr"]

if __name__ == "__main__":
    evaluations = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    Path("boxes.urdf").write_text(f'<robot name="boxes">{"".join(PARTS)}</robot>')
    sides = ("left", "l"), ("right", "r")
    tables = {
        "name": "boxes",
        "robot": {
            "urdf": "boxes.urdf",
            "hands": {name: f"{side}_hand" for name, side in sides},
            "soles": {name: f"{side}_sole" for name, side in sides} | {"size_m": [0.22, 0.1]},
            "trunk": ["pelvis", "chest"],
        },
        "human": {"stature_m": 1.7, "mass_kg": 65.0, "sex": "female"},
        "payload": {"size_m": [0.4, 0.4, 0.05], "mass_kg": 3.0, "grasp": "point"},
        "task": {"heights_m": [0.9]},
        "design": {
            "length": [
                {"name": name, "links": [f"l_{name}", f"r_{name}"], "lower": 0.7, "upper": 1.5}
                for name in ("thigh", "shank", "upper_arm", "forearm")
            ]
        },
        "objectives": {"minimise": ["robot_torque"], "maximise": ["reach_height"]},
        "solver": {"start_portfolio": False, "compile": False},  # no preparation: slower evaluations
    }
    problem = evodesign.Problem.from_dict(tables)
    print(problem.evaluate({}).reason)
    run = evodesign.search(problem, "runs/boxes", evaluations=evaluations, population=6, jobs=2)
    for design in run.front:
        print(design.number, {name: round(value, 2) for name, value in design.objectives.items()})
