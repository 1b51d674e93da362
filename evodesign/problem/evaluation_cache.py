"""Evaluations kept between runs: the same design of the same problem is never solved twice.

What is kept stands under a digest of everything that it follows from: the problem's tables but for its name,
its search and what an evaluation may cost; the texts of robot and person; the genome; the versions of the
solver's packages; and the source of the rooms that evaluate. A change of any of these is another key. Each
machine keeps its own, in its user's cache; where that is shared, so is what is kept.

A result that another machine or another day might not give (a time limit) is not kept.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import msgspec

from evodesign.nlp.disk_cache import Cache, digest_of, user_cache
from evodesign.pool.base import Limits
from evodesign.problem.decode import decode_toml
from evodesign.problem.evaluate import AssessmentFactory
from evodesign.problem.file import ProblemFile, SearchTable, SolverTable
from evodesign.records import Assessed, Genome, ProblemSource, Status

__all__ = ["Remembering", "problem_digest"]

PACKAGES = ("casadi", "numpy", "pin")
"""What an evaluation computes with."""

ROOMS = ("body", "tree", "human", "design", "mechanics", "nlp", "posture", "problem", "records.py")
"""Where the source of an evaluation lies."""

PASSING = frozenset({Status.TIME_LIMIT, Status.WORKER_LOST})
"""What another try might not give."""

Task = Callable[[Genome], Assessed]


@dataclass(frozen=True, slots=True)
class Remembering:
    """Builds an evaluation that looks first whether it knows the design.

    Args:
        factory: of the evaluation; its task is built when a design is not known.
    """

    factory: AssessmentFactory

    @property
    def limits(self) -> Limits:
        """Those of the factory inside."""
        return self.factory.limits

    def __call__(self) -> Task:
        """The function from genome to what it is worth."""
        shelf = f"evaluations/{problem_digest(self.factory.source)}"
        return functools.partial(_remembered, functools.cache(self.factory), shelf)


def problem_digest(source: ProblemSource) -> str:
    """Digest of everything but the genome that an evaluation follows from."""
    tables = decode_toml(source.text, source.path, ProblemFile)
    limitless = msgspec.structs.replace(
        tables.solver,
        evaluation_seconds=SolverTable().evaluation_seconds,
        evaluation_memory_gb=SolverTable().evaluation_memory_gb,
    )
    tables = msgspec.structs.replace(tables, name="-", search=SearchTable(), solver=limitless)
    texts = {
        name: source.files[name]
        for name in (tables.robot.urdf, *(t.urdf for t in tables.people.values()))
        if name
    }
    return digest_of(
        msgspec.json.encode(tables, order="deterministic"),
        msgspec.json.encode(texts, order="deterministic"),
        msgspec.json.encode(source.symmetry),
        *(f"{name} {version(name)}".encode() for name in PACKAGES),
        _source_digest().encode(),
    )


@functools.cache
def _source_digest() -> str:
    """Digest of the code and tables that evaluate."""
    package = Path(__file__).parents[1]
    files = [path for room in ROOMS for path in (package / room, *(package / room).rglob("*"))]
    sources = sorted(path for path in files if path.suffix in {".py", ".toml"})
    return digest_of(*(part for path in sources for part in (path.name.encode(), path.read_bytes())))


def _remembered(task: Callable[[], Task], shelf: str, genome: Genome) -> Assessed:
    """What a genome is worth: as kept, or worked out by one process while others wait for it."""
    key = digest_of(msgspec.json.encode(genome))
    cache = _cache(f"{shelf}/{key[:2]}")
    if cache is None:
        return task()(genome)
    with ExitStack() as held:
        with suppress(OSError):  # without the lock, at worst the work is done twice
            held.enter_context(cache.lock(key, keep=False))
        known = _read(cache, key)
        return known if known is not None else _kept(cache, key, task()(genome))


def _cache(subject: str) -> Cache | None:
    """The cache of a subject; None where nothing can be kept."""
    try:
        return user_cache(subject, os.environ)
    except OSError:
        return None


def _kept(cache: Cache, key: str, assessed: Assessed) -> Assessed:
    content = msgspec.json.encode(assessed)
    if _lasts(assessed) and _decoded(content) == assessed:
        with suppress(OSError):
            cache.store(key, content)
    return assessed


def _lasts(assessed: Assessed) -> bool:
    assessment = assessed.assessment
    parts = (*assessment.cases, *((assessment.reach,) if assessment.reach else ()))
    return PASSING.isdisjoint({assessment.status, *(part.status for part in parts)})


def _read(cache: Cache, key: str) -> Assessed | None:
    content = cache.read(key)
    return None if content is None else _decoded(content)


def _decoded(content: bytes) -> Assessed | None:
    try:
        return msgspec.json.decode(content, type=Assessed)
    except msgspec.DecodeError:
        return None
