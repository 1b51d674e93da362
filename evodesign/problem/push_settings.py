"""`[push]` of a problem file: pushes that are simulated for quantities such as `push_margin`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from evodesign.control.gains import Feedback
from evodesign.errors import InputError
from evodesign.mechanics.scene import Scene
from evodesign.problem.file import ProblemFile
from evodesign.quantities.push_quantities import SIMULATED, PushSettings
from evodesign.records import ProblemSource
from evodesign.simulation.pushable import refuse_unpushable


def pushes_of(
    tables: ProblemFile, source: ProblemSource, scenes: Sequence[Scene], asked: Iterable[str]
) -> PushSettings | None:
    """The settings of simulated pushes; None where nothing asks for them.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        scenes: of the problem.
        asked: names of objectives and of constrained quantities.
    Raises:
        InputError: a simulated quantity without `[push]`, or nobody whom controllers can keep upright.
    """
    name = next((each for each in asked if each in SIMULATED), None)
    if name is None:
        return None
    if tables.push is None:
        raise InputError(source.path, "push", f"a [push] for '{name}'", "none")
    for scene in scenes:
        refuse_unpushable(scene, source.path, "push")
    feedback = Feedback(tables.push.frequency_rad_s, tables.push.damping_ratio)
    return PushSettings(tables.push.impulse_n_s, feedback)
