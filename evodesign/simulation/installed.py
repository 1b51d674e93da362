"""Whether what a simulation needs is there, looked at before MuJoCo is imported."""

from __future__ import annotations

import os
import sys
from enum import StrEnum
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


class EngineName(StrEnum):
    """What moves those who are pushed."""

    MUJOCO = "mujoco"
    DRAKE = "drake"

    @property
    def label(self) -> str:
        """As it writes itself."""
        return {EngineName.MUJOCO: "MuJoCo", EngineName.DRAKE: "Drake"}[self]


def refuse_without_a_controller(engine: EngineName = EngineName.MUJOCO) -> None:
    """Refuse to push anybody without MuJoCo, DAQP and the engine.

    Raises:
        InputError: one of them is not installed.
    """
    second = engine is EngineName.DRAKE
    needed = ("mujoco", "daqp", *(["pydrake"] if second else []))
    missing = next((name for name in needed if find_spec(name) is None), None)
    if missing is not None:
        wanted, extra = ("MuJoCo, DAQP and Drake", "drake") if second else ("MuJoCo and DAQP", "control")
        raise InputError(
            "push", "", f"{wanted} installed (pip install 'evodesign[{extra}]')", f"no package '{missing}'"
        )


def draw_without_a_screen() -> None:
    """Let MuJoCo draw by EGL on a machine without a screen, unless the user has said by what."""
    if sys.platform == "linux" and "DISPLAY" not in os.environ:
        os.environ.setdefault("MUJOCO_GL", "egl")
