"""Where feet and trunk may be, as a file says or by the size of who stands."""

from __future__ import annotations

from dataclasses import replace

from evodesign.errors import InputError
from evodesign.human.stance import feet_apart, trunk_clearance
from evodesign.mechanics.agent import Agent, StanceLimits
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource


def stance_of(tables: ProblemFile, source: ProblemSource, person: Agent | None = None) -> StanceLimits:
    """Where feet and trunk may be.

    Args:
        tables: of the problem.
        source: likewise, for messages.
        person: a generated one, from whose size follows what the file leaves out.
    Raises:
        InputError: distances of the feet that do not rise.
    """
    limits, usual = tables.limits, StanceLimits()
    if person is not None:
        apart = feet_apart(person.tree, person.feet[0].sole.width)
        usual = replace(usual, feet_apart=apart, trunk_clearance=trunk_clearance(person.tree))
    least, most = apart = limits.feet_apart_m or usual.feet_apart
    clear = usual.trunk_clearance if limits.trunk_clearance_m is None else limits.trunk_clearance_m
    if least >= most:
        raise InputError(source.path, "limits.feet_apart_m", "a rising pair", f"[{least:g}, {most:g}]")
    return StanceLimits(
        trunk_clearance=clear,
        feet_apart=apart,
        feet_stagger=limits.feet_stagger_m,
        foot_yaw=limits.foot_yaw_rad,
        base_tilt=limits.base_tilt_rad,
        push=limits.push_n,
        feet_gap=limits.feet_gap_m,
    )
