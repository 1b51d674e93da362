"""What is told of the pieces that a problem needs before its first evaluation."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, cast

import pytest

from evodesign.evaluation.precompute import precompute_setting, precomputed, staged_pieces
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.nlp.disk_cache import Cache, user_cache
from evodesign.pool.base import Finished, Pool
from evodesign.posture.precompute import pieces
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.pieces import compute_piece
from evodesign.posture.precompute.plan import Piece, Subject
from evodesign.posture.precompute.precomputed import NO_STARTS, Precomputed
from evodesign.posture.seeking.landscape import Landscape
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.problem.build import DesignProblem


class Forgetful:
    """A cache that has lost some pieces, and a pool that finds them again where they really are."""

    def __init__(self, problem: DesignProblem, lost: int, damaged: int) -> None:
        self.real, self.setting = user_cache("precomputed", os.environ), precompute_setting(problem)
        self.lost, self.damaged = lost, damaged
        self.asked: list[str] = []
        self.worked_out = 0

    def read(self, key: str) -> bytes | None:
        if key not in self.asked:
            self.asked.append(key)
        place = self.asked.index(key)
        if place < self.lost:
            return None
        return b"nonsense" if place < self.lost + self.damaged else self.real.read(key)

    def store(self, key: str, content: bytes) -> None: ...

    @property
    def processes(self) -> int:
        return 3

    def run(self, factory: Any, pieces: Sequence[Piece]) -> Iterator[Finished[bytes]]:
        for index, piece in enumerate(pieces):
            self.worked_out += 1
            value = self.real.read(key_of(self.setting, piece))
            yield Finished(index, value, None, worker_lost=False, seconds=0.0, worker="")


class Watcher(PrecomputeProgress):
    def __init__(self) -> None:
        self.told: list[int] = []
        self.ready: list[str] = []

    def missing(self, pieces: int) -> None:
        self.told.append(pieces)

    def done(self, piece: str) -> None:
        self.ready.append(piece)


@pytest.mark.parametrize(
    ("lost", "damaged", "told"), [(0, 0, []), (100, 0, [6]), (4, 0, [4]), (4, 1, [4, 1])]
)
def test_all_pieces_are_told_before_the_first_is_worked_out(
    lost: int,
    damaged: int,
    told: list[int],
    problem: DesignProblem,
    known: Precomputed,
) -> None:
    forgetful, watcher = Forgetful(problem, lost, damaged), Watcher()
    found = precomputed(problem, cast("Cache", forgetful), cast("Pool", forgetful), watcher)
    assert found.postures.keys() == known.postures.keys()
    each = "designs, starts of the highest and lowest load, and of postures at three heights"
    assert len(forgetful.asked) == 6, each
    assert watcher.told == told
    assert len(watcher.ready) == len({*watcher.ready}) == forgetful.worked_out == sum(told)


@pytest.mark.slow
def test_starts_of_other_heights_are_sought_from_those_of_the_middle_one(
    problem: DesignProblem, known: Precomputed, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The middle one is worked out before; where it has no starts, others are sought all over."""
    own, sought = known.starts(problem.scene.pair, problem.holds[1]), list[Landscape]()

    def portfolio(landscape: Landscape, designs: object) -> StartPortfolio:
        sought.append(landscape)
        return NO_STARTS

    monkeypatch.setattr(pieces, "start_portfolio", portfolio)
    stages = [[each for each in stage if each.subject is Subject.POSTURE] for stage in staged_pieces(problem)]
    (first,), others = [stage for stage in stages if stage]
    assert [task.height_m for task in problem.holds] == [0.8, 1.0, 1.2]
    assert (first.task, first.after) == (problem.holds[1], None)
    assert {other.task for other in others} == {problem.holds[0], problem.holds[2]}
    setting = precompute_setting(problem)
    for other in others:
        assert other.after == first.task
        assert key_of(setting, other) != key_of(setting, replace(other, after=None))
        compute_piece(setting, other, known)
        compute_piece(setting, other, replace(known, postures={}))
    compute_piece(setting, first, known)
    assert [landscape.universal is own for landscape in sought] == [True, False, True, False, False]


def test_starts_of_other_cases_are_those_of_all_but_one(problem: DesignProblem, known: Precomputed) -> None:
    pair, (low, middle, high) = problem.scene.pair, problem.holds
    expected = [id(start) for task in (low, high) for start in known.starts(pair, task)]
    beside, rest = known.other_starts(pair, middle)
    assert (beside, sorted(map(id, rest))) == ((), sorted(expected))
    someone = ("someone", pair[1])
    beside, rest = known.other_starts(someone, middle)
    assert (beside, sorted(map(id, rest))) == (known.starts(pair, middle), sorted(expected))
