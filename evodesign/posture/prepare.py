"""What is worked out once per person, load and height, before any robot is evaluated.

The result is plain numbers: it travels to workers as it is, and is kept in the user's cache under a digest of
everything it depends on. It is a function of that alone, so a score does not depend on a cache.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca
import msgspec
import numpy as np

from evodesign.posture.cache import Cache, digest_of
from evodesign.posture.form import symmetric_forms
from evodesign.posture.human_value import HumanProblem, HumanValue
from evodesign.posture.program import IpoptOptions
from evodesign.statics.scene import Grasp, Scene
from evodesign.tree.urdf_write import urdf_text

__all__ = ["human_values"]

RECIPE = b"human value 1"
"""Changes whenever `human_value` would find other numbers for the same person."""


class _Stored(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A value function on disk; `height_m` without coefficients means that there is none."""

    height_m: float
    push_n: float
    coefficients: tuple[float, ...]
    starts: tuple[tuple[float, dict[str, list[float]]], ...]
    error: float


def human_values(
    scene: Scene,
    weight: float,
    heights: Sequence[float],
    options: IpoptOptions,
    cache: Cache | None,
    say: Callable[[str], None],
) -> tuple[HumanValue, ...]:
    """The person's value functions of a symmetric scene, for the heights that have one.

    Args:
        scene: its own mirror image.
        weight: w_h of the person's squared torques.
        heights: of the load's centre [m].
        options: of the solver.
        cache: where they are kept; None to work them out anew.
        say: is told what is being worked out.
    """
    if scene.payload.grasp is not Grasp.POINT or scene.stance.push == 0.0:
        return ()
    form = symmetric_forms(scene)[1]
    problem = HumanProblem(form, scene, weight, options)
    found = []
    for height in heights:
        key = digest_of(*_ingredients(scene, weight, height, options))
        stored = _read(cache, key)
        if stored is None:
            say(f"working out the person's part at {height:g} m")
            stored = _stored(height, problem.value(height))
            if cache is not None:
                cache.store(key, msgspec.json.encode(stored))
        if stored.coefficients:
            found.append(_value(stored))
    return tuple(found)


def _ingredients(scene: Scene, weight: float, height: float, options: IpoptOptions) -> list[bytes]:
    """Everything a value function depends on."""
    human = scene.human
    named = (human.joints, human.hands, human.soles, human.sole_size, human.trunk)
    numbers = (scene.payload, scene.ground, scene.stance, weight, height, options)
    return [
        RECIPE,
        ca.__version__.encode(),
        urdf_text(human.tree).encode(),
        repr((named, numbers)).encode(),
    ]


def _read(cache: Cache | None, key: str) -> _Stored | None:
    content = cache.read(key) if cache is not None else None
    if content is None:
        return None
    try:
        return msgspec.json.decode(content, type=_Stored)
    except msgspec.DecodeError:
        return None


def _stored(height: float, value: HumanValue | None) -> _Stored:
    if value is None:
        return _Stored(height, 0.0, (), (), 0.0)
    starts = tuple(
        (push, {name: np.asarray(block).tolist() for name, block in start.items()})
        for push, start in value.starts
    )
    return _Stored(height, value.push, value.coefficients, starts, value.error)


def _value(stored: _Stored) -> HumanValue:
    starts = tuple(
        (push, {name: np.array(block) for name, block in start.items()}) for push, start in stored.starts
    )
    return HumanValue(stored.height_m, stored.push_n, stored.coefficients, starts, stored.error)
