"""Progress on standard error: of a search, and of what its problem needs before the first evaluation.

On a terminal something is redrawn in place; elsewhere there is a plain line per generation or piece.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager

from rich.console import Group
from rich.live import Live
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from evodesign.analysis.failures import causes, failures
from evodesign.analysis.growth import growth
from evodesign.api.progress_lines import PrecomputeLines, SearchLines
from evodesign.cli.output import console, heading, rounded, show_notes
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.records import Evaluation, Generation, Objective, RunHeader, Sense, Status
from evodesign.runlog.session_log import Observer


@contextmanager
def search_progress() -> Iterator[Observer]:
    """The observer that suits standard error; the terminal is given back however the search ends."""
    if not sys.stderr.isatty():
        yield SearchLines(sys.stderr)
        return
    panel = SearchPanel()
    try:
        yield panel
    finally:
        panel.close()


@contextmanager
def precompute_progress() -> Iterator[PrecomputeProgress]:
    """What suits standard error for a problem's pieces; it shows nothing until one is missing."""
    if not sys.stderr.isatty():
        yield PrecomputeLines(sys.stderr)
        return
    bar = PrecomputeBar()
    try:
        yield bar
    finally:
        bar.close()


@contextmanager
def counted(what: str, total: int) -> Iterator[Callable[[], None]]:
    """A bar on a terminal, which each call moves by one of so many; it is gone at the end."""
    if not sys.stderr.isatty():
        yield lambda: None
        return
    parts = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*parts, console=console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)


class SearchPanel(Observer):
    """A bar and the state of the search, redrawn in place."""

    def __init__(self) -> None:
        self._console = console(stderr=True)
        self._progress = Progress(
            TextColumn("[bold]{task.description}"),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=self._console,
            expand=True,
        )
        self._live = Live(console=self._console, refresh_per_second=4, transient=False)
        self._task = self._progress.add_task("search", total=None)
        self._tally = _Tally(())
        self._generations: list[Generation] = []

    def started(self, header: RunHeader, evaluations_done: int) -> None:
        """Draw the panel."""
        self._tally = _Tally(header.objectives)
        description = f"{escape(header.problem_name)} {escape(header.search.algorithm)}"
        self._progress.update(
            self._task, description=description, total=header.budget, completed=evaluations_done
        )
        self._live.start()
        self._draw()

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        """Move the bar."""
        self._tally.count(evaluation)
        self._progress.update(self._task, completed=done, total=budget)
        self._draw()

    def generation_done(self, generation: Generation) -> None:
        """Show the new hypervolume and best values."""
        self._generations.append(generation)
        self._tally.learn(generation.best)
        self._draw()

    def close(self) -> None:
        """Give the terminal back, also after a stop."""
        self._live.stop()

    def _draw(self) -> None:
        self._live.update(Group(self._progress, self._state()))

    def _state(self) -> Table:
        tally, generation = self._tally, self._generations[-1] if self._generations else None
        known = growth(self._generations)
        table = Table(box=None, show_header=False, padding=(0, 2))
        table.add_row("feasible", tally.feasible_share, "failed", causes(tally.failures))
        number = "-" if generation is None else str(generation.number)
        volume = rounded(None if generation is None else generation.hypervolume)
        table.add_row("generation", number, "hypervolume", volume)
        if known is not None:
            table.add_row("grew", f"{known.last:.1%}", "a doubling may add", f"{known.expected:.1%}")
        for objective in tally.objectives:
            table.add_row("best", rounded(tally.best.get(objective.name)), escape(heading(objective)), "")
        return table


class _Tally:
    """Counts and best values of a session, kept up to date one evaluation at a time."""

    def __init__(self, objectives: Sequence[Objective]) -> None:
        self.objectives = tuple(objectives)
        self.best: dict[str, float] = {}
        self.failures: Counter[Status] = Counter()
        self._seen = 0
        self._feasible = 0

    @property
    def feasible_share(self) -> str:
        return f"{self._feasible / self._seen:.0%}" if self._seen else "-"

    def count(self, evaluation: Evaluation) -> None:
        self._seen += 1
        self.failures += failures([evaluation])
        if evaluation.feasible:
            self._feasible += 1
            self.learn(evaluation.assessment.objectives)

    def learn(self, values: Mapping[str, float]) -> None:
        for objective in self.objectives:
            if objective.name in values:
                better = min if objective.sense == Sense.MINIMISE else max
                value = values[objective.name]
                self.best[objective.name] = better(value, self.best.get(objective.name, value))


class PrecomputeBar(PrecomputeProgress):
    """A bar over all pieces, and below it the piece that was done last."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("[bold]making ready, once"),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=console(stderr=True),
            expand=True,
        )
        self._live = Live(console=self._progress.console, refresh_per_second=4)
        self._task = self._progress.add_task("", total=0)
        self._pieces = 0

    def missing(self, pieces: int) -> None:
        """Draw the bar, longer by so many pieces."""
        self._pieces += pieces
        self._progress.update(self._task, total=self._pieces)
        self._live.start()
        self._live.update(self._progress, refresh=True)

    def done(self, piece: str) -> None:
        """Move the bar."""
        self._progress.update(self._task, advance=1)
        self._live.update(Group(self._progress, escape(piece)), refresh=True)

    def note(self, sentence: str) -> None:
        """Say it."""
        show_notes([sentence])

    def close(self) -> None:
        """Give the terminal back."""
        self._live.stop()
