"""Draws the assembly of a design's CAD files: `python -m docs.write_assembly DESIGN [PICTURE]`.

DESIGN is a folder that `evodesign export --cad` wrote. Its `cad/assembly.step` is read by cascadio and
trimesh and drawn by MuJoCo without a screen, from the front, the robot's right and obliquely: links as glass,
motors solid, no axes of joints. Without PICTURE, docs/pictures/assembly.png is written.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path
from typing import Any

os.environ.setdefault("MUJOCO_GL", "egl")

import cascadio
import mujoco
import numpy as np
import trimesh
from PIL import Image

PICTURE = Path(__file__).parent / "pictures" / "assembly.png"
WIDTH, HEIGHT = 400, 800
VIEWS = ((180.0, 0.0), (90.0, 0.0), (150.0, -20.0))
"""Azimuth and elevation of each view [deg]: front, right side, oblique."""

LINK, MOTOR = (0.55, 0.62, 0.72, 0.38), (0.85, 0.42, 0.05, 1.0)
CHORD_MM, ANGLE = 0.3, 0.2
COLORS = 96
"""Of the picture's palette, which keeps the file small."""


def main() -> None:
    """Draw one picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("design", type=Path)
    parser.add_argument("picture", type=Path, nargs="?", default=PICTURE)
    given = parser.parse_args()
    picture = drawn(assembly(given.design / "cad" / "assembly.step"))
    picture.quantize(COLORS).save(given.picture, optimize=True)


def assembly(step: Path) -> dict[str, trimesh.Trimesh]:
    """The parts of an assembly that have a volume, in the root link's frame [m], by name."""
    with tempfile.TemporaryDirectory() as place:
        glb = Path(place) / "assembly.glb"
        cascadio.step_to_glb(str(step), str(glb), CHORD_MM, ANGLE)
        scene: Any = trimesh.load(glb)
    found = {}
    for name in scene.graph.nodes_geometry:
        if not name.startswith("axis_"):
            place_of, geometry = scene.graph[name]
            found[name] = scene.geometry[geometry].copy().apply_transform(place_of)
    return found


def drawn(parts: dict[str, trimesh.Trimesh]) -> Image.Image:
    """All views beside each other."""
    model = _model(parts)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    corners = np.array([part.bounds for part in parts.values()])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    camera = mujoco.MjvCamera()
    camera.lookat, camera.distance = (low + high) / 2.0, 1.35 * float(high[2] - low[2])
    shown = []
    with mujoco.Renderer(model, 2 * HEIGHT, 2 * WIDTH) as renderer:
        for camera.azimuth, camera.elevation in VIEWS:
            renderer.update_scene(data, camera)
            picture = Image.fromarray(renderer.render())
            shown.append(np.asarray(picture.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)))
    return Image.fromarray(np.concatenate(shown, axis=1))


def _model(parts: dict[str, trimesh.Trimesh]) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 2 * WIDTH, 2 * HEIGHT
    spec.visual.global_.fovy = 45.0
    spec.visual.headlight.ambient, spec.visual.headlight.diffuse = [0.45] * 3, [0.55] * 3
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=[1.0] * 3,
        rgb2=[1.0] * 3,
        width=8,
        height=48,
    )
    for name, part in parts.items():
        spec.add_mesh(
            name=name,
            uservert=np.asarray(part.vertices, np.float64).ravel(),
            userface=np.asarray(part.faces, np.int32).ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
        color = MOTOR if name.startswith("motor_") else LINK
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, rgba=color)
    return spec.compile()


if __name__ == "__main__":
    main()
