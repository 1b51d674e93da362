"""What many tests stand on: the point-grasp problem, built once."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest
from hypothesis import HealthCheck, settings

from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.precompute import precompute_setting, precomputed, staged_pieces
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.interrupts import INTERRUPTS
from evodesign.nlp.disk_cache import user_cache
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.pool.worker import SerialPool
from evodesign.posture.precompute import meetings
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.plan import OF_STARTS
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from tests.machine import NEEDS, leave_out, left_out
from tests.measured_people import search_with_people
from tests.pool.cluster import Cluster

REPOSITORY = Path(__file__).parents[1]

# No test is lost to a busy machine: neither a deadline nor a drawing that is slow there.
settings.register_profile(
    "evodesign", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("evodesign")


def pytest_configure() -> None:
    """Heed Ctrl-C, as in a terminal: what a shell starts in the background inherits that it is ignored."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what waits for the point-grasp problem, so that `make test-quick` goes without it."""
    for item in items:
        if "known" in getattr(item, "fixturenames", ()):
            item.add_marker("prepared")
    if workers := os.environ.get("PYTEST_XDIST_WORKER_COUNT"):
        items[:] = slow_ones_sooner(items, int(workers))


def slow_ones_sooner(items: list[pytest.Item], workers: int) -> list[pytest.Item]:
    """The tests in an order in which no worker is left with a slow one when the others are through.

    Each begins with a share of the list, one after the other; whoever ends steals from another's end. So
    modules with slow tests or a browser come first in every share, each module whole.
    """
    slow = {
        item.path
        for item in items
        for marker in ("slow", "needs_chromium")
        if item.get_closest_marker(marker)
    }
    kinds = [[item for item in items if (item.path in slow) is first] for first in (True, False)]
    ordered: list[pytest.Item] = []
    for worker in range(workers):
        for kind in kinds:
            ends = [len(kind) * each // workers for each in (worker, worker + 1)]
            begin, end = (_whole_modules(kind, place) for place in ends)
            ordered += kind[begin:end]
    return ordered


def _whole_modules(items: list[pytest.Item], place: int) -> int:
    """The place, moved on to where a module begins."""
    while 0 < place < len(items) and items[place].path == items[place - 1].path:
        place += 1
    return place


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Ask what the machine lacks before fixtures are made for a test that cannot run."""
    for marker, (there, reason) in NEEDS.items():
        if item.get_closest_marker(marker) and not there():
            leave_out(reason)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say what was left out, and how to have it."""
    for sentence in left_out(terminalreporter.stats.get("skipped", [])):
        terminalreporter.write_line(sentence)
    if "not slow" in config.option.markexpr:
        terminalreporter.write_line("left out: the slow tests, which `make test-all` runs too")


@pytest.fixture(scope="session")
def repository() -> Path:
    """Folder of the checkout."""
    return REPOSITORY


@pytest.fixture(scope="session")
def problem() -> DesignProblem:
    """Point-grasp, without compiling what tests make of it: that takes longer than it saves them."""
    source = read_source(REPOSITORY / "problems" / "point_grasp.toml")
    built = build_problem(msgspec.structs.replace(source, method="ipopt"))
    return replace(built, options=replace(built.options, compiled=False))


@pytest.fixture(scope="session")
def native(problem: DesignProblem) -> DesignProblem:
    """Point-grasp as commands solve it: a search takes a third of the time, compiled for all in `known`."""
    return build_problem(msgspec.structs.replace(problem.source, method=None))


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache of the tests' own, which commands started by tests and tests running side by side use too.

    It is new in each session, unless $EVODESIGN_TEST_CACHE names a directory that keeps it: working out the
    point-grasp problem takes a minute.
    """
    kept = os.environ.get("EVODESIGN_TEST_CACHE")
    session = tmp_path_factory.getbasetemp()
    own = session.parent / "cache" if "PYTEST_XDIST_WORKER" in os.environ else session / "cache"
    place = Path(kept) if kept else own
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EVODESIGN_CACHE", str(place))
        yield place


@pytest.fixture(scope="session")
def known(problem: DesignProblem, native: DesignProblem) -> Precomputed:
    """What is worked out of point-grasp beforehand, where commands started by tests find it too.

    IPOPT begins at what the native method found: it would need three times as long to find the same.
    """
    cache = user_cache("precomputed", os.environ)
    with cache.lock("default"), JoblibPool(2) as pool:
        precomputed(native, cache, pool, PrecomputeProgress())
        for lent, key in zip(keys_of_starts(native), keys_of_starts(problem), strict=True):
            content = cache.read(lent)
            assert content is not None
            cache.store(key, content)
        return precomputed(problem, cache, pool, PrecomputeProgress())


@pytest.fixture(autouse=True)
def own_signals() -> Iterator[None]:
    """Handlers that a command in a test's process installs end with the test, and so does an interrupt."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)
    INTERRUPTS.unwinding = False


@pytest.fixture(scope="session")
def run_with_people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose front met samples of people; to be read, or copied."""
    directory = tmp_path_factory.mktemp("people") / "run"
    search_with_people(directory)
    return directory


def keys_of_starts(problem: DesignProblem) -> list[str]:
    """What a problem's portfolios are kept under."""
    pieces = (piece for stage in staged_pieces(problem) for piece in stage if piece.subject in OF_STARTS)
    return [key_of(precompute_setting(problem), piece) for piece in pieces]


@pytest.fixture(scope="session")
def evaluator(problem: DesignProblem, known: Precomputed) -> Evaluator:
    """The point-grasp problem's inner problems."""
    return Evaluator(problem, known)


@pytest.fixture
def few_designs_meet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pairs of bodies near each other are looked for in a few designs, in this process, for time."""
    monkeypatch.setattr("evodesign.evaluation.factory.make_pool", lambda *_, **__: SerialPool())
    for number, few in {"DESIGNS": 2, "FEWEST": 1}.items():
        monkeypatch.setattr(meetings, number, few)


@pytest.fixture(scope="session")
def cluster() -> Iterator[Cluster]:
    """A Dask scheduler with two workers, of which one has a nanny."""
    with Cluster() as made:
        made.start_scheduler()
        made.add_worker()
        made.add_worker("--no-nanny")
        made.wait_for(2)
        yield made
