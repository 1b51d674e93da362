"""What many tests stand on: the default problem, built once."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import Evaluator
from evodesign.problem.source import read_source

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


@pytest.fixture(scope="session")
def evaluator(problem: Problem) -> Evaluator:
    """The default problem's inner problems."""
    return Evaluator(problem)
