"""A film of simulations, drawn by MuJoCo without a screen, as an animated GIF; pushes are arrows."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
from PIL import Image

from evodesign.errors import InputError
from evodesign.posture.results import Array
from evodesign.simulation.carry import CarryOutcome
from evodesign.simulation.mujoco_engine import MujocoEngine
from evodesign.simulation.push import PushOutcome, PushTest
from evodesign.simulation.rollout import FRAME

WIDTH, HEIGHT = 480, 360
EVERY = 2
"""Frames of a rollout per picture."""

ARROW = 1e-3
"""Length of an arrow per force [m/N]."""

BONE = 0.02
"""Radius of what is drawn for links that are meshes, from joint to joint [m]."""

SEEN = 2
"""Groups of shapes that MuJoCo draws, at most."""

RED, GREY = (0.85, 0.1, 0.1, 1.0), (0.45, 0.5, 0.6, 1.0)
_ARROW, _CAPSULE = mujoco.mjtGeom.mjGEOM_ARROW, mujoco.mjtGeom.mjGEOM_CAPSULE


@dataclass(frozen=True, slots=True, eq=False)
class Filmed:
    """What a film shows.

    Args:
        model: MuJoCo's.
        states: `qpos` at frames, shape (f, q).
        forces: on a body at frames, in the world [N], shape (f, 3); none for no arrows.
        body: its number.
        followed: number of the body that the camera follows over the floor; None: it stays.
        azimuth: from where the camera looks, about z [deg].
    """

    model: Any
    states: Array
    forces: Array = field(default_factory=lambda: np.zeros((0, 3)))
    body: int = 0
    followed: int | None = None
    azimuth: float = 115.0


def carried_film(outcome: CarryOutcome) -> Filmed:
    """A walk with the load, seen from beside the robot and whom it faces.

    Raises:
        InputError: nobody began to walk.
    """
    if outcome.scene is None or not isinstance(outcome.scene.engine, MujocoEngine):
        raise InputError("--video", "", "a walk to be shown", outcome.reason)
    found = outcome.scene.engine.found
    return Filmed(found.model, outcome.states, followed=found.load, azimuth=100.0)


def pushed_film(test: PushTest, outcome: PushOutcome) -> Filmed:
    """A push whose states were kept.

    Raises:
        InputError: another engine than MuJoCo moved everything.
    """
    agent = test.scene.controllers[outcome.push.agent].body.agent
    if not isinstance(test.scene.engine, MujocoEngine):
        raise InputError("--video", "", "a push in MuJoCo, which draws films", "one in another engine")
    model = test.scene.engine.found.model
    body = int(model.body(f"{agent.name}/{agent.pushed_frame}").id)
    return Filmed(model, outcome.states, outcome.forces, body)


def film(shown: Sequence[Filmed]) -> bytes:
    """Simulations one after another, as fast as they were.

    Raises:
        InputError: MuJoCo cannot draw here.
    """
    pictures = [picture for each in shown for picture in _pictures(each)]
    if not pictures:
        raise InputError("--video", "", "a simulation to be shown", "none")
    content = io.BytesIO()
    pictures[0].save(
        content,
        format="GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=round(1000 * EVERY * FRAME),
        loop=0,
    )
    return content.getvalue()


def _pictures(shown: Filmed) -> Iterator[Image.Image]:
    data, camera = mujoco.MjData(shown.model), mujoco.MjvCamera()
    camera.lookat, camera.distance = [0.0, 0.0, 0.9], 3.2
    camera.azimuth, camera.elevation = shown.azimuth, -12.0
    try:
        renderer = mujoco.Renderer(shown.model, HEIGHT, WIDTH)
    except (ImportError, AttributeError, RuntimeError, Warning, mujoco.FatalError) as error:  # of OpenGL
        wanted = "a machine on which MuJoCo draws (MUJOCO_GL=egl or osmesa without a screen)"
        raise InputError("--video", "", wanted, f"{error}") from error
    unseen = _unseen(shown.model)
    with renderer:
        for number in range(0, len(shown.states), EVERY):
            data.qpos = shown.states[number]
            mujoco.mj_forward(shown.model, data)
            if shown.followed is not None:
                camera.lookat[:2] = data.xpos[shown.followed][:2]
            renderer.update_scene(data, camera)
            for link in unseen:
                parent = shown.model.body_parentid[link]
                _draw(renderer.scene, _CAPSULE, BONE, GREY, data.xpos[parent], data.xpos[link])
            if number < len(shown.forces) and shown.forces[number].any():
                end = data.xipos[shown.body]
                _draw(renderer.scene, _ARROW, 0.03, RED, end - ARROW * shown.forces[number], end)
            yield Image.fromarray(renderer.render()).quantize(64)


def _unseen(model: Any) -> list[int]:
    """Bodies on links of which nothing is drawn, since their shapes are meshes."""
    seen = {int(model.geom_bodyid[geom]) for geom in range(model.ngeom) if model.geom_group[geom] <= SEEN}
    parents = enumerate(model.body_parentid.tolist())
    return [link for link, parent in parents if parent and parent not in seen]


def _draw(scene: Any, kind: Any, width: float, colour: tuple[float, ...], start: Array, end: Array) -> None:
    """A shape from one point to another."""
    geom, still = scene.geoms[scene.ngeom], (np.zeros(3), np.zeros(3), np.eye(3).ravel())
    mujoco.mjv_initGeom(geom, kind, *still, np.array(colour, np.float32))
    mujoco.mjv_connector(geom, kind, width, start, end)
    scene.ngeom += 1
