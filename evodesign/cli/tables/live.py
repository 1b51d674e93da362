"""A running search as one screen, and as lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.progress_bar import ProgressBar
from rich.table import Column, Table
from rich.text import Text

from evodesign.analysis.decision_making import knees
from evodesign.analysis.hypervolume import best
from evodesign.cli.output import heading, markup, printable, rounded
from evodesign.cli.tables.table import FittedTable, designs_table
from evodesign.report.live.state import MOST_KNEES, LiveState, word

BARS = "▁▂▃▄▅▆▇█"
SPARKS = 30
"""Most signs of a sparkline."""


def screen(directory: Path, live_state: LiveState, *, ended: bool, now: float) -> Group:
    """Everything about a search on one screen.

    Args:
        directory: of the run.
        live_state: of the search.
        ended: whether the last session closed its log.
        now: seconds since 1970.
    """
    header = live_state.header
    search = header.search
    title = (
        f"[bold]{markup(header.problem_name)}[/bold]  {markup(search.algorithm)}, "
        f"population {search.population}, seed {search.seed}  {markup(str(directory))}"
    )
    parts: list[RenderableType] = [
        Text.from_markup(title),
        _bar(live_state.done, header.budget),
        Text(_pace(directory, live_state, word(live_state, ended=ended, now=now), now)),
        _numbers(live_state),
    ]
    if live_state.front:
        parts.append(_knees(live_state))
    return Group(*parts)


def _bar(done: int, budget: int) -> Table:
    """A line of its own with the bar."""
    line = Table.grid(expand=True)
    line.add_row(ProgressBar(total=max(budget, 1), completed=done))
    return line


def sparkline(values: Sequence[float], ends: tuple[float, float] | None = None) -> str:
    """Numbers as bars; many are thinned out, the last one stays.

    Args:
        values: in order.
        ends: what the lowest and the highest bar stand for; left out, the least and the greatest number.
    """
    step = -(-len(values) // SPARKS) or 1
    kept = list(values)[::-1][::step][::-1]
    low, high = (min(kept, default=0.0), max(kept, default=0.0)) if ends is None else ends
    if high <= low:
        return BARS[0] * len(kept)
    return "".join(BARS[round((value - low) / (high - low) * (len(BARS) - 1))] for value in kept)


def _pace(directory: Path, live_state: LiveState, state: str, now: float) -> str:
    """How far, how fast, and how long still."""
    count = f"{live_state.done} of {live_state.header.budget} evaluations"
    match state:
        case "finished":
            return f"{count}, finished"
        case "stopped":
            return f"{count}, stopped; go on with: evodesign resume {printable(str(directory))}"
        case "silent":
            silent = _span(now - (live_state.latest or now))
            return f"{count}, nothing new for {silent}: it was killed, or an evaluation takes long"
        case _:
            left = live_state.seconds_left
            rate = "-" if live_state.pace is None else f"{live_state.pace:.3g}"
            return f"{count}, {rate} per second, {'unknown time' if left is None else _span(left)} left"


def _span(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def _numbers(live_state: LiveState) -> Table:
    generations = live_state.generations
    volumes = [each.hypervolume for each in generations if each.hypervolume is not None]
    share = f"{live_state.feasible / live_state.done:.0%}" if live_state.done else "-"
    columns = (Column(), Column(justify="right", no_wrap=True), Column(style="cyan", no_wrap=True))
    table = Table(*columns, box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_row("generations", str(len(generations)), "")
    table.add_row("feasible", share, sparkline([each.feasible_share for each in generations], (0.0, 1.0)))
    table.add_row("hypervolume", rounded(volumes[-1] if volumes else None), sparkline(volumes))
    if live_state.growth is not None:
        table.add_row("a doubling may add", f"{live_state.growth.expected:.1%}", "")
    table.add_row("on the front", str(len(live_state.front)), "")
    for status, count in live_state.causes.items():
        table.add_row(escape(str(status)), str(count), "")
    for bounds, count in live_state.exceeded.items():
        table.add_row(markup(bounds), str(count), "")
    for objective in live_state.header.objectives:
        history = [each.best[objective.name] for each in generations if objective.name in each.best]
        latest = best(live_state.header.objectives, live_state.front).get(objective.name)
        table.add_row(markup(f"best {heading(objective)}"), rounded(latest), sparkline(history))
    return table


def _knees(live_state: LiveState) -> FittedTable:
    found = knees(live_state.header.objectives, live_state.front)
    title = f"Knees of the front, {len(found[:MOST_KNEES])} of {len(found)}"
    return designs_table(title, live_state.header, found[:MOST_KNEES])
