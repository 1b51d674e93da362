"""A forecast on a simulated clock: it comes late enough, gets better, and is never absurd."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.problem.time_left import LATE, LATER, PendingPiece, TimeLeft, in_words

LAST = PendingPiece("a lift", "lift", 0.1, 3)


def pieces_of(heights: int, people: int = 1) -> list[PendingPiece]:
    """Those of a problem, with kinds and work as `precomputed` tells them."""
    reach = [PendingPiece(name, name, 1.0, 0) for name in ("highest", "lowest")]
    persons = [PendingPiece(f"person {number}", "person", 0.3, 0) for number in range(heights * people)]
    return [
        *reach,
        *persons,
        *(PendingPiece(f"posture {number}", "posture", 1.7, 1) for number in range(heights)),
        LAST,
    ]


def ends_of(
    pieces: Sequence[PendingPiece], seconds: Mapping[str, float], processes: int
) -> list[tuple[float, PendingPiece]]:
    """When each piece ends, in the order of the ends: whoever is free takes the next one of a stage."""
    ends, begun = [], 0.0
    for _, stage in groupby(pieces, lambda piece: piece.stage):
        free = [begun] * processes
        for piece in stage:
            first = free.index(min(free))
            free[first] += seconds[piece.name]
            ends.append((free[first], piece))
        begun = max(free)
    return sorted(ends, key=lambda end: end[0])


def course(
    pieces: Sequence[PendingPiece], seconds: Mapping[str, float], processes: int, shares: Sequence[float]
) -> Iterator[tuple[float, float, float | None]]:
    """At rising shares of all the time: the moment, the time that is really left, and the forecast."""
    ends = ends_of(pieces, seconds, processes)
    left, last = TimeLeft().with_missing(pieces, processes, 0.0), ends[-1][0]
    for share in shares:
        now = share * last
        while ends and ends[0][0] <= now:
            moment, piece = ends.pop(0)
            left = left.with_done(piece, seconds[piece.name], moment)
        yield now, last - now, left.seconds(now)


def some_robot(number: int, pieces: Sequence[PendingPiece], processes: int) -> dict[str, float]:
    """Seconds of its pieces: a pace of its own, one for each kind, something for each piece and the first."""
    chance = random.Random(number)
    pace, later = chance.uniform(3.0, 300.0), chance.uniform(0.25, 0.75)
    kinds = {piece.kind: chance.uniform(0.7, 1.4) for piece in pieces}
    seconds: dict[str, float] = {}
    for place, piece in enumerate(pieces):
        like = sum(each.kind == piece.kind for each in pieces[:place])
        share = 1.0 if like < processes else later
        seconds[piece.name] = pace * kinds[piece.kind] * piece.work * share * chance.uniform(0.8, 1.25)
    return seconds


def test_nothing_is_told_before_a_tenth_of_the_work_is_done() -> None:
    pieces = pieces_of(heights=12)
    left = TimeLeft().with_missing(pieces, 2, 0.0)
    assert left.seconds(0.0) is None
    assert left.seconds(50.0) is None
    left = left.with_done(pieces[0], 50.0, 50.0)
    assert left.seconds(50.0) is None, "one of 26 units"
    for piece in pieces[1:6]:
        left = left.with_done(piece, 50.0 * piece.work, 60.0)
    assert left.seconds(60.0) is not None


@pytest.mark.parametrize(("count", "processes"), [(7, 1), (8, 2), (9, 2), (9, 4), (20, 3)])
def test_equal_pieces_are_forecast_exactly(count: int, processes: int) -> None:
    pieces = [PendingPiece(f"piece {number}", "one", 1.7, 0) for number in range(count)]
    left = TimeLeft().with_missing(pieces, processes, 5.0)
    for piece in pieces[:processes]:
        left = left.with_done(piece, 20.0, 25.0)
    rounds = math.ceil((count - processes) / processes)
    for passed in (0.0, 3.0, 7.5):
        expected = rounds * 20.0 * LATER - passed
        assert left.seconds(25.0 + passed) == pytest.approx(expected)


def test_a_stage_begins_when_all_of_the_one_before_are_done() -> None:
    first = [PendingPiece("short", "a", 1.0, 0), PendingPiece("long", "b", 1.0, 0)]
    last = [PendingPiece(name, "c", 2.0, 1) for name in ("one", "other")]
    left = TimeLeft().with_missing([*last, *first], 2, 0.0).with_done(first[0], 10.0, 10.0)
    assert left.seconds(10.0) == pytest.approx(0.15 * 10.0 + 20.0), (
        "the long one is late; the last two follow"
    )
    left = left.with_done(first[1], 30.0, 30.0)
    assert left.seconds(30.0) == pytest.approx(2.0 * 20.0), "side by side, at 20 s for a unit of work"
    assert left.seconds(45.0) == pytest.approx(25.0)


def test_a_process_more_or_less_changes_the_forecast() -> None:
    pieces = [PendingPiece(f"{number}", "one", 1.0, 0) for number in range(9)]

    def forecast(processes: int) -> float | None:
        left = TimeLeft().with_missing(pieces, processes, 0.0)
        return left.with_done(pieces[0], 10.0, 10.0).seconds(10.0)

    alone, four = forecast(1), forecast(4)
    assert alone is not None
    assert four is not None
    assert four < alone / 2.0


@pytest.mark.parametrize("processes", [1, 2, 3])
def test_forecasts_get_better_as_pieces_are_done(processes: int) -> None:
    shares = (0.45, 0.7, 0.95)
    errors: list[list[float]] = [[] for _ in shares]
    for number in range(60):
        pieces = pieces_of(heights=3 + number % 5, people=1 + number % 2)
        told = list(course(pieces, some_robot(number, pieces, processes), processes, shares))
        for place, (now, true, forecast) in enumerate(told):
            if forecast is not None:
                errors[place].append(abs(forecast - true) / (now + true))
    assert [len(each) for each in errors] == pytest.approx([60] * 3, abs=6), "they are told nearly always"
    means = [sum(each) / len(each) for each in errors]
    assert means == sorted(means, reverse=True)
    assert means[0] < 0.15
    assert means[-1] < 0.06


some_seconds = st.one_of(st.floats(0.0, 100.0), st.just(0.0), st.floats(1e3, 1e6))


@given(st.data(), st.integers(1, 6), st.integers(1, 4))
def test_whatever_pieces_take_no_forecast_is_absurd(
    data: st.DataObject, processes: int, heights: int
) -> None:
    pieces = pieces_of(heights)
    seconds = {piece.name: data.draw(some_seconds) for piece in pieces}
    shares = sorted(data.draw(st.lists(st.floats(0.0, 1.0), max_size=12)))
    ends = ends_of(pieces, seconds, processes)
    for now, _, forecast in course(pieces, seconds, processes, shares):
        done = [piece for end, piece in ends if end <= now]
        missing = sum(piece.work for end, piece in ends if end > now)
        if forecast is None:
            continue
        slowest = max(seconds[piece.name] / (LATER * piece.work) for piece in done)
        assert 0.0 <= forecast <= LATE * missing * slowest * (1.0 + 1e-9)


def test_a_piece_that_hangs_silences_the_forecast_and_its_end_brings_it_back() -> None:
    pieces = pieces_of(heights=3)
    left = TimeLeft().with_missing(pieces, 2, 0.0)
    for piece, seconds in zip(pieces, (10.0, 10.0, 3.0, 3.0, 3.0 * LATER), strict=False):
        left = left.with_done(piece, seconds, 20.0)
    told = [left.seconds(20.0 + 0.5 * step) for step in range(400)]
    spoken = [each for each in told if each is not None]
    assert spoken[:28] == sorted(spoken[:28], reverse=True), "it goes down while 17 s are not over"
    assert spoken[34:] == sorted(spoken[34:]), "what is late may take longer, and so may those to come"
    assert max(spoken) <= LATE * (17.0 + 17.0 * LATER)
    assert len(spoken) == math.floor(LATE * 17.0 / 0.5) + 1, "until a posture takes three times 17 s"
    assert left.with_done(pieces[5], 199.0, 219.0).seconds(219.0) is not None


def test_the_last_piece_leaves_nothing() -> None:
    left = TimeLeft().with_missing([LAST], 1, 3.0)
    assert left.seconds(9.0) is None
    assert left.with_done(LAST, 6.0, 9.0).seconds(9.0) == 0.0


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (None, ""),
        (0.0, "a few seconds left"),
        (14.0, "about 10 s left"),
        (54.9, "about 50 s left"),
        (55.0, "about 1 min left"),
        (89.0, "about 1.5 min left"),
        (120.0, "about 2 min left"),
        (170.0, "about 3 min left"),
        (9.4 * 60.0, "about 9 min left"),
        (12.0 * 60.0, "about 10 min left"),
        (5000.0, "about 85 min left"),
        (3.4 * 3600.0, "about 3 h left"),
    ],
)
def test_a_forecast_is_told_as_exactly_as_it_is(seconds: float | None, words: str) -> None:
    assert in_words(seconds) == words


@given(st.floats(10.0, 1e6))
def test_words_are_within_a_third_of_the_number(seconds: float) -> None:
    _, number, unit, _ = in_words(seconds).split()
    told = float(number) * {"s": 1.0, "min": 60.0, "h": 3600.0}[unit]
    assert told == pytest.approx(seconds, rel=0.34)
