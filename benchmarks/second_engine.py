"""The same designs, plans, controllers and pushes in MuJoCo and in Drake: who survives, and how.

For each design the first hold is pushed in some directions. MuJoCo's margin is found by bisection, and with
--margins Drake's too; then both are given the same pushes, of shares of MuJoCo's margin. Of the weakest of
these pushes the load's largest distance from its path, the robot's peak torque, and the difference of its
torques over time (root mean square, relative to the peak) stand side by side.

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
from evodesign.simulation.drake_engine import DrakeEngine
from evodesign.simulation.push import Push, PushOutcome, PushTest
from evodesign.simulation.push_margin import Margin, margin_in
from evodesign.simulation.pushed_plan import PushConditions

SHARES = (0.8, 0.95, 1.05, 1.2)
"""Of MuJoCo's margin."""


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
    """One design pushed in one direction in MuJoCo and in Drake."""

    margins: tuple[Margin, ...]
    pushes: tuple[tuple[Pushed, Pushed], ...]

    def __str__(self) -> str:
        """A row of the table."""
        weakest = self.pushes[0]
        off = " / ".join(f"{1e3 * each.outcome.load_off:.1f}" for each in weakest)
        peak = " / ".join(f"{np.abs(each.torques).max():.1f}" for each in weakest)
        ends = " | ".join(f"{first} {second}" for first, second in self.pushes)
        margins = " / ".join(f"{margin.impulse:.1f}" for margin in self.margins)
        beyond = " / ".join(each.outcome.reason or "survived" for each in self.pushes[-1])
        return f"{margins} | {ends} | {off} | {peak} | {100.0 * torques_apart(*weakest):.1f} | {beyond} |"


def compared(
    run: Path, design: int, directions: Sequence[float], *, margins: bool
) -> Iterator[tuple[float, Compared]]:
    """The rows of a design, by direction [degrees]; with Drake's margins or without."""
    where = first_hold(run, design)
    ((name, mujoco),) = where.tests(PushConditions()).items()
    (drake,) = where.tests(PushConditions(engine=DrakeEngine)).values()
    for degrees in directions:
        push = Push(0.0, math.radians(degrees))
        asked = (mujoco, drake) if margins else (mujoco,)
        found = tuple(margin_in(test, name, push, where.mass) for test in asked)
        given = [replace(push, impulse=share * found[0].impulse) for share in SHARES]
        yield degrees, Compared(found, tuple((pushed(mujoco, each), pushed(drake, each)) for each in given))


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
    for place, share in enumerate(SHARES):
        alike = sum(len({f"{each}" for each in row.pushes[place]}) == 1 for row in rows)
        print(f"at {share:g} of MuJoCo's margin both agree in {alike} of {len(rows)}")
    if given.margins:
        ratio = [row.margins[1].impulse / row.margins[0].impulse for row in rows]
        print(f"Drake's margin over MuJoCo's: {min(ratio):.2f} to {max(ratio):.2f}, {np.median(ratio):.2f}")


if __name__ == "__main__":
    main()
