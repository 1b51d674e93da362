"""Whether what a simulation needs is there, looked at before MuJoCo is imported."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec

from evodesign.errors import InputError


def refuse_without_mujoco() -> None:
    """Refuse to simulate without MuJoCo.

    Raises:
        InputError: it is not installed.
    """
    if find_spec("mujoco") is None:
        wanted = "MuJoCo installed (pip install 'evodesign[simulate]')"
        raise InputError("simulate", "", wanted, "no package 'mujoco'")


def draw_without_a_screen() -> None:
    """Let MuJoCo draw by EGL on a machine without a screen, unless the user has said by what."""
    if sys.platform == "linux" and "DISPLAY" not in os.environ:
        os.environ.setdefault("MUJOCO_GL", "egl")
