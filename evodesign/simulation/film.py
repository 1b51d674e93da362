"""A film of simulations, drawn by MuJoCo without a screen, as an animated GIF."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence

import mujoco
from PIL import Image

from evodesign.errors import InputError
from evodesign.simulation.outcome import Rollout
from evodesign.simulation.rollout import FRAME

WIDTH, HEIGHT = 480, 360
EVERY = 2
"""Frames of a rollout per picture."""


def film(rollouts: Sequence[Rollout]) -> bytes:
    """Simulations one after another, as fast as they were.

    Raises:
        InputError: MuJoCo cannot draw here.
    """
    pictures = [picture for rollout in rollouts for picture in _pictures(rollout)]
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


def _pictures(rollout: Rollout) -> Iterator[Image.Image]:
    model = rollout.model
    data, camera = mujoco.MjData(model), mujoco.MjvCamera()
    camera.lookat, camera.distance, camera.azimuth, camera.elevation = [0.0, 0.0, 0.9], 3.2, 115.0, -12.0
    try:
        renderer = mujoco.Renderer(model, HEIGHT, WIDTH)
    except (ImportError, AttributeError, RuntimeError, Warning, mujoco.FatalError) as error:  # of OpenGL
        wanted = "a machine on which MuJoCo draws (MUJOCO_GL=egl or osmesa without a screen)"
        raise InputError("--video", "", wanted, f"{error}") from error
    with renderer:
        for state in rollout.states[::EVERY]:
            data.qpos = state
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera)
            yield Image.fromarray(renderer.render()).quantize(64)
