"""What comes with evodesign of the default problem: for that problem alone, and as any machine has it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.pool.base import Pool
from evodesign.pool.worker import Finished
from evodesign.posture.precompute.pieces import compute_piece
from evodesign.posture.precompute.plan import PROGRAMS, Piece, Subject
from evodesign.posture.precompute.precomputed import PersonReach, Precomputed
from evodesign.problem.build import build_problem
from evodesign.problem.precompute import precompute_setting, precomputed, staged_pieces
from evodesign.problem.prepared import DATA, prepared_digest, prepared_pieces
from evodesign.problem.progress import SILENT
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource


@pytest.fixture(scope="module")
def source(repository: Path) -> ProblemSource:
    return read_source(repository / "problems" / "icub_lifting.toml")


def with_line(source: ProblemSource, old: str, new: str) -> ProblemSource:
    assert old in source.text
    return msgspec.structs.replace(source, text=source.text.replace(old, new))


class Recorder(Pool):
    """Works nothing out, and keeps what it was asked for."""

    def __init__(self) -> None:
        self.asked: list[Piece] = []

    @property
    def processes(self) -> int:
        return 1

    def run(self, factory: Any, tasks: Sequence[Piece]) -> Iterator[Finished[bytes]]:
        self.asked += tasks
        for index in range(len(tasks)):
            yield Finished(index, b"null", None, worker_lost=False, seconds=0.0, worker="")


def test_only_machine_code_is_made_of_the_default_problem(source: ProblemSource) -> None:
    problem, pool = build_problem(source), Recorder()
    known = precomputed(problem, None, pool, SILENT)
    assert {piece.subject for piece in pool.asked} == set(PROGRAMS)
    assert set(known.postures) == set(known.chosen) == set(problem.cases)
    assert all(portfolio.starts for portfolio in (known.highest, known.lowest, *known.chosen.values()))
    assert set(known.person_reaches) == {scene.pair for scene in problem.scenes}
    assert known.meetings


def test_what_comes_along_is_what_is_asked_for(source: ProblemSource) -> None:
    pieces = {piece for stage in staged_pieces(build_problem(source)) for piece in stage}
    assert set(prepared_pieces(source)) == {piece for piece in pieces if piece.subject not in PROGRAMS}


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("seed = 1", "seed = 2", True),
        ("evaluations = 240", "evaluations = 960", True),
        ('name = "icub-lifting"', 'name = "mine"', True),
        ('maximise = ["shared_reach_height"]', 'maximise = ["highest_reach"]', True),
        ("mass_kg = { lower = 25.0, upper = 65.0 }", "mass_kg = { upper = 60.0 }", True),
        ("[search]", '[solver]\nmethod = "ipopt"\n\n[search]', True),
        ("mass_kg = 15.0", "mass_kg = 14.0", False),
        ("heights_m = [0.8, 1.0, 1.2]", "heights_m = [0.8, 1.0, 1.1]", False),
        ("percentiles = [5]", "percentiles = [50]", False),
        ("push_n = [-20.0, 0.0, 0.0]", "push_n = [-10.0, 0.0, 0.0]", False),
        ("[search]", '[solver]\nsymmetry = "off"\n\n[search]', False),
    ],
)
def test_it_is_given_to_the_same_problem_alone(source: ProblemSource, old: str, new: str, same: bool) -> None:
    other = with_line(source, old, new)
    assert (prepared_digest(other) == prepared_digest(source)) is same
    assert (prepared_pieces(other) == prepared_pieces(source)) is same


def test_a_robot_that_differs_is_another_problem(source: ProblemSource) -> None:
    files = {name: text.replace('<mass value="', '<mass value="1') for name, text in source.files.items()}
    assert files != source.files
    assert not prepared_pieces(msgspec.structs.replace(source, files=files))


@pytest.mark.slow
@pytest.mark.needs_compiler
def test_the_peoples_reach_is_what_this_machine_finds(source: ProblemSource) -> None:
    problem, known = build_problem(source), Precomputed()
    given = prepared_pieces(source)
    for piece in (piece for piece in given if piece.subject is Subject.PERSON_REACH):
        found = compute_piece(precompute_setting(problem), piece, known)
        one, other = (msgspec.json.decode(each, type=PersonReach) for each in (found, given[piece]))
        assert (one.lowest, one.highest) == pytest.approx((other.lowest, other.highest), abs=0.005)


def test_every_file_is_of_a_problem_that_comes_along(repository: Path) -> None:
    for path in DATA.glob("*.json"):
        made_for = msgspec.json.decode(path.read_bytes())["made_for"]
        assert made_for == prepared_digest(read_source(repository / "problems" / f"{path.stem}.toml")), (
            path.name
        )
