"""Whom controllers can keep upright, asked before MuJoCo is imported."""

from __future__ import annotations

from evodesign.errors import InputError
from evodesign.mechanics.scene import Scene


def refuse_unpushable(scene: Scene, file: str = "push", key: str = "") -> None:
    """Refuse a scene in which nobody can be pushed.

    Args:
        scene: in which somebody shall be.
        file: that asks for it, or a command.
        key: in it.
    Raises:
        InputError: no robot, or an agent on anything but two feet.
    """
    if not scene.robots:
        raise InputError(file, key, "a robot in the problem", "people alone")
    wheeled = next((agent.name for agent in scene.agents if not agent.on_feet), None)
    if wheeled is not None:
        raise InputError(file, key, "agents on two feet", f"'{wheeled}', which stands on something else")
