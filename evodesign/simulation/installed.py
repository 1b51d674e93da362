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


def refuse_without_a_controller() -> None:
    """Refuse to push anybody without MuJoCo and DAQP.

    Raises:
        InputError: one of them is not installed.
    """
    missing = next((name for name in ("mujoco", "daqp") if find_spec(name) is None), None)
    if missing is not None:
        wanted = "MuJoCo and DAQP installed (pip install 'evodesign[control]')"
        raise InputError("push", "", wanted, f"no package '{missing}'")


def draw_without_a_screen() -> None:
    """Let MuJoCo draw by EGL on a machine without a screen, unless the user has said by what."""
    if sys.platform == "linux" and "DISPLAY" not in os.environ:
        os.environ.setdefault("MUJOCO_GL", "egl")
