"""What many tests stand on: the default problem, built once."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from evodesign.posture.cache import user_cache
from evodesign.posture.human_value import HumanValue
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import Evaluator, prepared
from evodesign.problem.source import read_source
from tests.pool.cluster import Cluster

REPOSITORY = Path(__file__).parents[1]

settings.register_profile("house", deadline=None, derandomize=True)
settings.load_profile("house")


@pytest.fixture(scope="session")
def repository() -> Path:
    """Folder of the checkout."""
    return REPOSITORY


@pytest.fixture(scope="session")
def problem() -> Problem:
    """The default problem."""
    return build_problem(read_source(REPOSITORY / "problems" / "icub_lifting.toml"))


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache of the tests' own, which commands started by tests use too."""
    place = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EVODESIGN_CACHE", str(place))
        yield place


@pytest.fixture(scope="session")
def people(problem: Problem) -> tuple[HumanValue, ...]:
    """The default problem's person, worked out once."""
    return prepared(problem, user_cache("people", os.environ), lambda _: None)


@pytest.fixture(scope="session")
def evaluator(problem: Problem, people: tuple[HumanValue, ...]) -> Evaluator:
    """The default problem's inner problems."""
    return Evaluator(problem, people)


@pytest.fixture(scope="session")
def cluster() -> Iterator[Cluster]:
    """A Dask scheduler with two workers, of which one has a nanny."""
    with Cluster() as made:
        made.start_scheduler()
        made.add_worker()
        made.add_worker("--no-nanny")
        made.wait_for(2)
        yield made
