"""How long what a problem needs before its first evaluation will still take: a forecast that learns.

The pieces that are done say how many seconds a unit of work takes, each kind for itself as soon as one of it
is done. What is still missing is laid out over the processes that share it, stage after stage; the last one
to end is the forecast. There is none while too little is done, or while a piece takes far longer than
expected: no number is better than a wrong one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from heapq import heapify, heapreplace
from itertools import groupby

LATER = 0.5
"""Work of a piece as a share of the first ones of its kind, one in each process, which wait for the compiler
too; 0.2 to 0.7 with four public robots."""

GROUND = 0.1
"""Share of the work that has to be done before there is a forecast."""

AT_LEAST = 0.15
"""Share of the time that a piece at work has taken which it is taken to need still."""

LATE = 3.0
"""From so many times its expected time a piece at work makes the forecast void."""


@dataclass(frozen=True, slots=True)
class PendingPiece:
    """Something to be worked out.

    Args:
        name: as it is told.
        kind: pieces of one kind take about as long as each other.
        work: that it is, with those of other kinds; the unit is arbitrary.
        stage: it begins when all pieces of smaller stages are done.
    """

    name: str
    kind: str
    work: float
    stage: int


@dataclass(frozen=True, slots=True)
class _AtWork:
    """A piece that a process is at, since a moment, and the work that it is."""

    piece: PendingPiece
    since: float
    work: float


@dataclass(frozen=True, slots=True)
class _Done:
    """A piece of a kind that is done: the work that it was, and the seconds that it took."""

    kind: str
    work: float
    seconds: float


@dataclass(frozen=True, slots=True)
class TimeLeft:
    """What is missing, at work and done, at the last event.

    Moments are seconds on any clock that runs forward.

    Args:
        processes: that share the pieces.
        waiting: missing pieces that no process is at, in the order in which they are begun.
        at_work: those that a process is at, with the moment of their beginning.
        done: with the seconds that they took.
    """

    processes: int = 1
    waiting: tuple[PendingPiece, ...] = ()
    at_work: tuple[_AtWork, ...] = ()
    done: tuple[_Done, ...] = ()

    def with_missing(self, pieces: Iterable[PendingPiece], processes: int, now: float) -> TimeLeft:
        """More pieces are missing, for so many processes."""
        waiting = sorted((*self.waiting, *pieces), key=lambda piece: piece.stage)
        return replace(self, processes=processes, waiting=tuple(waiting))._begin(now)

    def with_done(self, piece: PendingPiece, seconds: float, now: float) -> TimeLeft:
        """A piece is done and took so many seconds, or next to nothing."""
        work = next((each.work for each in self.at_work if each.piece == piece), piece.work)
        return replace(
            self,
            waiting=tuple(each for each in self.waiting if each != piece),
            at_work=tuple(each for each in self.at_work if each.piece != piece),
            done=(*self.done, _Done(piece.kind, work, seconds)),
        )._begin(now)

    def seconds(self, now: float) -> float | None:
        """The time left [s]; None where there is no ground for a forecast.

        It is never negative, and bounded by what is missing at `LATE` times the slowest pace so far.
        """
        done = sum(each.work for each in self.done)
        missing = sum(each.work for each in self.at_work) + sum(each.work for each in self.waiting)
        if done <= 0.0 or done < GROUND * (done + missing):
            return None
        expected = [each.work * self._pace(each.piece.kind) for each in self.at_work]
        passed = [now - each.since for each in self.at_work]
        if any(time > LATE * whole for time, whole in zip(passed, expected, strict=True)):
            return None
        left = [max(whole - time, AT_LEAST * time) for time, whole in zip(passed, expected, strict=True)]
        return self._last_end([*left, *[0.0] * (self.processes - len(left))], now)

    def _last_end(self, ends: list[float], now: float) -> float:
        """When the last process ends [s from now], from when each ends what it is at."""
        taken = [(each.piece.kind, (now - each.since) / each.work) for each in self.at_work]
        paces = {
            kind: max([self._pace(kind), *(pace for like, pace in taken if like == kind)])
            for kind in {piece.kind for piece in self.waiting}
        }
        begun = self._kinds_begun()
        current = min((each.piece.stage for each in self.at_work), default=None)
        heapify(ends)
        for stage, pieces in groupby(self.waiting, lambda piece: piece.stage):
            if stage != current:
                ends = [max(ends)] * len(ends)
            for piece in pieces:
                heapreplace(ends, ends[0] + self._work(piece, begun) * paces[piece.kind])
                begun[piece.kind] += 1
        return max(ends)

    def _pace(self, kind: str) -> float:
        """Seconds per work: of what is done of a kind, or of everything while there is nothing of it."""
        like = [each for each in self.done if each.kind == kind] or self.done
        return sum(each.seconds for each in like) / sum(each.work for each in like)

    def _kinds_begun(self) -> Counter[str]:
        return Counter(each.piece.kind for each in self.at_work) + Counter(each.kind for each in self.done)

    def _work(self, piece: PendingPiece, begun: Counter[str]) -> float:
        """The work that a piece is when so many of each kind have begun before it."""
        return piece.work * (1.0 if begun[piece.kind] < self.processes else LATER)

    def _begin(self, now: float) -> TimeLeft:
        """Processes that are free begin what waits, unless it is of a later stage."""
        left, waiting = self, self.waiting
        while waiting and len(left.at_work) < self.processes:
            piece, *others = waiting
            if left.at_work and piece.stage > left.at_work[0].piece.stage:
                break
            begun = _AtWork(piece, now, left._work(piece, left._kinds_begun()))
            waiting = tuple(others)
            left = replace(left, waiting=waiting, at_work=(*left.at_work, begun))
        return left


def in_words(seconds: float | None) -> str:
    """A time left as it may be believed, such as `about 2 min left`; empty for None."""
    if seconds is None:
        return ""
    if seconds < 10.0:
        return "a few seconds left"
    if seconds < 55.0:
        return f"about {round(seconds, -1):.0f} s left"
    if seconds < 165.0:
        return f"about {round(seconds / 30.0) / 2.0:g} min left"
    minutes = round(seconds / 60.0)
    if minutes < 10:
        return f"about {minutes} min left"
    if minutes < 90:
        return f"about {5 * round(minutes / 5)} min left"
    return f"about {round(minutes / 60)} h left"
