"""The same designs, plans, controllers and pushes in MuJoCo and in Drake: who survives, and how.

For each design the first hold is pushed in some directions. MuJoCo's margin is found by bisection, and with
--margins the others' too; then all are given the same pushes, of shares of MuJoCo's margin. Of the weakest of
these pushes the load's largest distance from its path, the robot's peak torque, and the difference of its
torques over time (root mean square, relative to the peak) stand side by side. A third column is MuJoCo with a
quarter of its step, whose contacts are stiffer: where it is with Drake, the step is what both differ by.

    python -m benchmarks.second_engine RUN --designs 71 72 ... [--directions 0 90 180] [--margins]
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.push import first_hold
from evodesign.control.controller import Command
from evodesign.mechanics.agent import ROBOT
from evodesign.posture.results import Array
from evodesign.simulation.controlled import Timing
from evodesign.simulation.drake_engine import DrakeEngine
from evodesign.simulation.push import Push, PushOutcome, PushTest
from evodesign.simulation.push_margin import Margin, margin_in
from evodesign.simulation.pushed_plan import PushConditions

SHARES = (0.8, 0.95, 1.05, 1.2)
"""Of MuJoCo's margin."""

ENGINES = {
    "MuJoCo": PushConditions(),
    "Drake": PushConditions(engine=DrakeEngine),
    "MuJoCo, a quarter of the step": PushConditions(timing=Timing(substeps=4 * Timing().substeps)),
}
"""What everything is simulated by, the reference first."""


@dataclass(frozen=True, eq=False)
class Pushed:
    """What a push does, and the robot's torques at every answer, shape (n, j)."""

    outcome: PushOutcome
    torques: Array

    def __str__(self) -> str:
        """Whether it is survived."""
        return "+" if self.outcome.survived else "-"


def pushed(test: PushTest, push: Push) -> Pushed:
    """A push with the torques that the robot's controller asks for."""
    torques, advance = [], test.scene.advance

    def kept() -> dict[str, Command]:
        commands = advance()
        torques.append(commands[ROBOT].torques)
        return commands

    test.scene.advance = kept  # type: ignore[method-assign]
    outcome = test.pushed(push)
    test.scene.advance = advance  # type: ignore[method-assign]
    return Pushed(outcome, np.array(torques))


def torques_apart(first: Pushed, second: Pushed) -> float:
    """Root mean square over time and joints of what torques differ by, relative to the first one's peak."""
    count = min(len(first.torques), len(second.torques))
    off = first.torques[:count] - second.torques[:count]
    return float(np.sqrt(np.mean(off**2)) / np.abs(first.torques).max())


@dataclass(frozen=True)
class Compared:
    """One design pushed in one direction: margins, and for each share what comes of it in every engine."""

    margins: tuple[Margin, ...]
    pushes: tuple[tuple[Pushed, ...], ...]

    def __str__(self) -> str:
        """A row of the table."""
        weakest = self.pushes[0]
        off = " / ".join(f"{1e3 * each.outcome.load_off:.1f}" for each in weakest)
        peak = " / ".join(f"{np.abs(each.torques).max():.1f}" for each in weakest)
        apart = " / ".join(f"{100.0 * torques_apart(weakest[0], other):.1f}" for other in weakest[1:])
        ends = " | ".join(" ".join(map(str, each)) for each in self.pushes)
        margins = " / ".join(f"{margin.impulse:.1f}" for margin in self.margins)
        beyond = " / ".join(each.outcome.reason or "survived" for each in self.pushes[-1])
        return f"{margins} | {ends} | {off} | {peak} | {apart} | {beyond} |"


def compared(
    run: Path, design: int, directions: Sequence[float], *, margins: bool
) -> Iterator[tuple[float, Compared]]:
    """The rows of a design, by direction [degrees]; with all margins or MuJoCo's alone."""
    where = first_hold(run, design)
    tests = [next(iter(where.tests(conditions).values())) for conditions in ENGINES.values()]
    for degrees in directions:
        push = Push(0.0, math.radians(degrees))
        found = tuple(margin_in(test, "", push, where.mass) for test in tests[: None if margins else 1])
        given = [replace(push, impulse=share * found[0].impulse) for share in SHARES]
        yield degrees, Compared(found, tuple(tuple(pushed(test, each) for test in tests) for each in given))


def main() -> None:
    """Parse and run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path)
    parser.add_argument("--designs", type=int, nargs="+", required=True)
    parser.add_argument("--directions", type=float, nargs="+", default=[0.0, 90.0, 180.0])
    parser.add_argument("--margins", action="store_true")
    given = parser.parse_args()
    shares = " | ".join(f"{share:g}" for share in SHARES)
    print(
        f"| design | to [deg] | margin [N s] | {shares} | load off [mm] | peak torque [N m] "
        f"| torques apart [%] | at {SHARES[-1]:g} |"
    )
    rows: list[Compared] = []
    for design in given.designs:
        for degrees, row in compared(given.run, design, given.directions, margins=given.margins):
            rows.append(row)
            print(f"| {design} | {degrees:g} | {row}", flush=True)
    names = list(ENGINES)
    for place, share in enumerate(SHARES):
        for other, name in enumerate(names[1:], 1):
            alike = sum(f"{row.pushes[place][0]}" == f"{row.pushes[place][other]}" for row in rows)
            print(f"at {share:g} of MuJoCo's margin {name} agrees in {alike} of {len(rows)}")
    for other, name in enumerate(names[1 : len(rows[0].margins)], 1):
        ratio = [row.margins[other].impulse / row.margins[0].impulse for row in rows]
        print(f"{name}'s margin is {min(ratio):.2f} to {max(ratio):.2f} of MuJoCo's, {np.median(ratio):.2f}")


if __name__ == "__main__":
    main()
