"""Lifts, simulations, pushes and walks with the load as tables for people."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from evodesign.cli.output import rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.control.gains import Feedback
from evodesign.motion.solution import LiftSolution
from evodesign.simulation.outcome import SETTLED

if TYPE_CHECKING:
    from evodesign.evaluation.carries import CarriedCase
    from evodesign.evaluation.pushes import FoundMargins
    from evodesign.evaluation.simulations import SimulatedCase
    from evodesign.simulation.push import PushOutcome


def simulation_table(title: str, simulations: Sequence[SimulatedCase], feedback: Feedback) -> FittedTable:
    """How far robot, person and load were from their plan in each case."""
    columns = numbers("load off [mm]", "joints off [mrad]", "torques off [%]", "slip [mm]")
    keys = names("case", "agent")
    caption = (
        f"torques after {SETTLED:g} s, relative to the largest planned torque of a joint; feedback of "
        f"{feedback.frequency:g} rad/s, damping ratio {feedback.damping:g}"
    )
    table = titled(title, [*keys, *columns, *names("fell")], keys=2, caption=caption)
    for each in simulations:
        for name, agent in each.outcome.agents.items():
            table.add_row(
                each.name,
                name,
                _hundredths(1e3 * each.outcome.drift),
                _hundredths(1e3 * agent.tracking),
                _hundredths(100.0 * agent.torque_share),
                _hundredths(1e3 * agent.slip),
                f"after {each.outcome.seconds:.2f} s" if agent.fell else "no",
            )
    return table


def _hundredths(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "-"


def margins_table(title: str, found: FoundMargins) -> FittedTable:
    """The margin at each moment in each direction, and the least."""
    turns = sorted({round(float(np.degrees(each.direction)), 3) for each in found.margins})
    least = found.least
    caption = (
        "impulses [N s] by direction [deg], from forwards to the left; the least is "
        f"{least.impulse:.3g} N s: beyond it {least.reason or 'nothing larger was tried'}"
    )
    if found.spread:
        changes = ", ".join(f"{name} {change:+.2g}" for name, change in found.spread.items())
        caption += f"; it changes with {changes} N s"
    table = titled(
        title, [*names("moment"), *numbers(*(f"{turn:g}" for turn in turns))], keys=1, caption=caption
    )
    for moment in dict.fromkeys(each.moment for each in found.margins):
        own = {
            round(float(np.degrees(each.direction)), 3): each
            for each in found.margins
            if each.moment == moment
        }
        table.add_row(moment, *(f"{own[turn].impulse:.1f}" for turn in turns))
    return table


def pushes_table(title: str, outcomes: Mapping[str, PushOutcome]) -> FittedTable:
    """What came of one push at each moment."""
    columns = numbers("recovery [s]", "load off [mm]", "capture point off [mm]", "torque saturation [%]")
    rows = (
        (
            moment,
            "-" if each.recovery is None else f"{each.recovery:.2f}",
            *(f"{1e3 * each.load_off:.1f}", f"{1e3 * each.capture:.1f}", f"{100.0 * each.saturation:.0f}"),
            each.reason or "no",
        )
        for moment, each in outcomes.items()
    )
    return titled(title, [*names("moment"), *columns, *names("lost")], rows)


def carries_table(title: str, cases: Sequence[CarriedCase]) -> FittedTable:
    """What each walk takes of whom, and how it ends."""
    columns = numbers(
        "distance [m]", "tilt [deg]", "torque [N m]", "saturation [%]", "energy [J]", "back [N]"
    )
    caption = (
        "tilt: of the load, at most; torque: the largest of any joint; saturation: time with a motor at its "
        "limit; back: compression of L5/S1, at most"
    )
    keys = names("hold", "agent")
    table = titled(title, [*keys, *columns, *names("ends")], keys=2, caption=caption)
    for case in cases:
        outcome = case.outcome
        if not outcome.agents:
            table.add_row(case.name, *["-"] * 7, outcome.reason)
        for name, agent in outcome.agents.items():
            back = case.compression.get(name)
            table.add_row(
                case.name,
                name,
                f"{outcome.distance:.2f}",
                f"{math.degrees(outcome.tilt):.1f}",
                f"{agent.torque:.0f} ({agent.joint})",
                f"{100.0 * agent.saturation:.0f}",
                f"{case.energy[name]:.0f}" if name in case.energy else "-",
                "-" if back is None else f"{back:.0f}",
                outcome.reason or f"stands after {outcome.seconds:.1f} s",
            )
    return table


def lift_tables(title: str, solutions: Mapping[tuple[str, str], LiftSolution]) -> Iterator[FittedTable]:
    """What a lift takes of robot and person, then torques over time.

    Args:
        title: of the design.
        solutions: by names of person and load.
    """
    for pair, solution in solutions.items():
        words = [title, *(name for name in pair if name), f"{solution.lift}"]
        yield _efforts(", ".join(words), solution)
        if solution.course is not None:
            yield _over_time(solution)


def _efforts(title: str, solution: LiftSolution) -> FittedTable:
    if not solution.efforts:
        table = titled(title, [*names("status", "reason")])
        table.add_row(f"{solution.status}", solution.reason)
        return table
    headers = ["mean torque [N m]", "peak torque [N m]", "static share", "work [J]", "peak power [W]"]
    disturbances = {name: None for effort in solution.efforts.values() for name in effort.disturbed}
    headers += [f"peak torque, {name} [N m]" for name in disturbances]
    table = titled(title, [*names("agent"), *numbers(*headers)], caption=_caption(solution))
    for name, effort in solution.efforts.items():
        found = [effort.mean_torque, effort.peak_torque, effort.static_share, effort.work, effort.power.max()]
        found += [effort.disturbed[disturbance].max() for disturbance in disturbances]
        table.add_row(name, *found)
    return table


def _caption(solution: LiftSolution) -> str:
    if solution.checked is None:
        return f"{solution.status}: {solution.reason}"
    checked = solution.checked
    largest = max(checked.between, key=lambda name: checked.between[name])
    residuals = f"largest residual {max(checked.knots.values()):.1e} at {solution.lift.knots} knots"
    residuals += f", {checked.between[largest]:.1e} between them ({largest})"
    energy = f"energy gained {checked.energy:.4g} J, work off by {100.0 * checked.energy_error:.2g} %"
    why = "" if solution.solved else f": {solution.reason}"
    least = "" if solution.least is None else f"; least time {solution.least.seconds:.4g} s"
    return f"{solution.status}{why}; {residuals}; {energy}{least}"


def _over_time(solution: LiftSolution) -> FittedTable:
    headers = [f"{name} torque [N m]" for name in solution.efforts]
    table = titled("over time", [*numbers("time [s]", "height [m]", *headers)])
    course, every = solution.course, max(1, (len(solution.times) - 1) // 11)
    heights = () if course is None else tuple(course.heights(solution.times))
    for place in range(0, len(heights), every):
        torques = [rounded(effort.torques[place]) for effort in solution.efforts.values()]
        table.add_row(f"{solution.times[place]:.2f}", f"{heights[place]:.3f}", *torques)
    return table
