"""A running search as one screen, and as lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from evodesign.analysis.hypervolume import best
from evodesign.analysis.knees import knees
from evodesign.analysis.watched import Standing
from evodesign.cli.output import figure, shown, visible
from evodesign.cli.tables import heading
from evodesign.records import Generation
from evodesign.report.live.state import MOST_KNEES, word

__all__ = ["generation_line", "screen", "sparkline"]

BARS = "▁▂▃▄▅▆▇█"
SPARKS = 40
"""Most signs of a sparkline."""


def screen(directory: Path, standing: Standing, *, ended: bool, now: float) -> Group:
    """Everything about a search on one screen.

    Args:
        directory: of the run.
        standing: of the search.
        ended: whether the last session closed its log.
        now: seconds since 1970.
    """
    header = standing.header
    search = header.search
    title = (
        f"[bold]{shown(header.problem_name)}[/bold]  {shown(search.algorithm)}, "
        f"population {search.population}, seed {search.seed}  {shown(str(directory))}"
    )
    parts: list[RenderableType] = [
        Text.from_markup(title),
        _bar(standing.done, header.budget),
        Text(_pace(directory, standing, word(standing, ended=ended, now=now), now)),
        _numbers(standing),
    ]
    if standing.front:
        parts.append(_knees(standing))
    return Group(*parts)


def _bar(done: int, budget: int) -> Table:
    """A line of its own with the bar."""
    line = Table.grid(expand=True)
    line.add_row(ProgressBar(total=max(budget, 1), completed=done))
    return line


def generation_line(standing: Standing, generation: Generation) -> str:
    """One generation as a line of text."""
    best = " ".join(f"{visible(name)} {figure(value)}" for name, value in generation.best.items())
    return (
        f"generation {generation.number}: {generation.evaluations}/{standing.header.budget} evaluations, "
        f"feasible {generation.feasible_share:.0%}, hypervolume {figure(generation.hypervolume)}, "
        f"best {best or '-'}"
    )


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


def _pace(directory: Path, standing: Standing, state: str, now: float) -> str:
    """How far, how fast, and how long still."""
    count = f"{standing.done} of {standing.header.budget} evaluations"
    match state:
        case "finished":
            return f"{count}, finished"
        case "stopped":
            return f"{count}, stopped; go on with: evodesign resume {visible(str(directory))}"
        case "silent":
            silent = _span(now - (standing.latest or now))
            return f"{count}, nothing new for {silent}: it was killed, or an evaluation takes long"
        case _:
            left = standing.seconds_left
            rate = "-" if standing.pace is None else f"{standing.pace:.3g}"
            return f"{count}, {rate} per second, {'unknown time' if left is None else _span(left)} left"


def _span(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def _numbers(standing: Standing) -> Table:
    generations = standing.generations
    volumes = [each.hypervolume for each in generations if each.hypervolume is not None]
    share = f"{standing.feasible / standing.done:.0%}" if standing.done else "-"
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    table.add_column(overflow="fold")
    table.add_column(justify="right")
    table.add_column(style="cyan", no_wrap=True)
    table.add_row("generations", str(len(generations)), "")
    table.add_row("feasible", share, sparkline([each.feasible_share for each in generations], (0.0, 1.0)))
    table.add_row("hypervolume", figure(volumes[-1] if volumes else None), sparkline(volumes))
    table.add_row("on the front", str(len(standing.front)), "")
    for status, count in standing.causes.items():
        table.add_row(escape(str(status)), str(count), "")
    for objective in standing.header.objectives:
        history = [each.best[objective.name] for each in generations if objective.name in each.best]
        latest = best(standing.header.objectives, standing.front).get(objective.name)
        table.add_row(shown(f"best {heading(objective)}"), figure(latest), sparkline(history))
    return table


def _knees(standing: Standing) -> Table:
    objectives = standing.header.objectives
    found = knees(objectives, standing.front)
    table = Table(
        title=f"Knees of the front, {len(found[:MOST_KNEES])} of {len(found)}", title_justify="left"
    )
    table.add_column("design", justify="right")
    for objective in objectives:
        table.add_column(shown(heading(objective)), justify="right")
    for each in found[:MOST_KNEES]:
        values = each.assessment.objectives
        table.add_row(str(each.number), *(figure(values[objective.name]) for objective in objectives))
    return table
