"""Getting a problem ready: what is worked out or compiled once, while the user is told.

It is kept in the user's cache, so that only the first command on a problem pays for it, and it never changes
a result.
"""

from __future__ import annotations

import hashlib
import os

import msgspec

from evodesign.cli.output import show_notes
from evodesign.posture.cache import Cache, user_cache
from evodesign.posture.codegen import NotCompiled, find_compiler
from evodesign.posture.human_value import HumanValue
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import AssessmentFactory, Evaluator, prepared
from evodesign.records import RunHeader

__all__ = ["evaluator_of", "problem_factory"]


def problem_factory(header: RunHeader) -> AssessmentFactory:
    """The evaluation of a header's problem as workers build it, with everything they share made ready."""
    digest = hashlib.sha256(msgspec.json.encode(header.problem, order="deterministic")).hexdigest()
    problem = build_problem(header.problem)
    factory = AssessmentFactory(digest, header.problem, _values(problem), problem.limits)
    if problem.options.compiled:
        _compile(factory)
    return factory


def evaluator_of(problem: Problem) -> Evaluator:
    """The inner problems of a problem in this process."""
    return Evaluator(problem, _values(problem))


def _values(problem: Problem) -> tuple[HumanValue, ...]:
    return prepared(problem, _cache("people"), lambda sentence: show_notes([sentence]))


def _compile(factory: AssessmentFactory) -> None:
    """Compile a problem's functions unless that was done before, so that no worker waits for another."""
    cache = _cache("ready")
    if cache is not None and cache.read(factory.digest):
        return
    compiler = find_compiler(os.environ)
    if isinstance(compiler, NotCompiled):
        show_notes([f"{compiler.reason}: solving on CasADi's virtual machine, slower and with equal results"])
        return
    show_notes(["compiling the inner problems"])
    factory()
    if cache is not None:
        cache.store(factory.digest, b"ready")


def _cache(subject: str) -> Cache | None:
    try:
        return user_cache(subject, os.environ)
    except OSError as error:
        show_notes([f"nothing can be kept for the next time: {error}"])
        return None
