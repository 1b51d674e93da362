"""What is told of the pieces that a problem needs before its first evaluation."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any, cast

import pytest

from evodesign.evaluation.precompute import precompute_setting, precomputed
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.nlp.disk_cache import Cache, user_cache
from evodesign.pool.base import Finished, Pool
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.plan import Piece
from evodesign.posture.precompute.precomputed import Precomputed
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
