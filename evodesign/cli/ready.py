"""Getting a problem ready: what is worked out or compiled once, while the user is told.

It is kept in the user's cache, so that only the first command on a problem pays for it, and it never changes
a result.
"""

from __future__ import annotations

import os

from evodesign.cli.making import making
from evodesign.cli.output import show_notes
from evodesign.identity import code_digest, digest
from evodesign.nlp.codegen import Compiler, NotCompiled, find_compiler
from evodesign.nlp.disk_cache import Cache, user_cache
from evodesign.pool.base import Pool
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.baseline import BaselineFactory
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import AssessmentFactory, Evaluator
from evodesign.problem.precompute import PrecomputeProgress, precomputed
from evodesign.records import RunHeader
from evodesign.search.base import JOINT_STARTS

__all__ = ["evaluator_of", "known_of", "problem_factory"]


Evaluations = AssessmentFactory | BaselineFactory


def problem_factory(header: RunHeader, pool: Pool) -> Evaluations:
    """The evaluation of a header's problem as workers build it, with everything they share made ready.

    Args:
        header: of a run.
        pool: where what is missing is worked out.
    """
    problem, name = build_problem(header.problem), digest(header.problem)
    factory: Evaluations
    with making() as watcher:
        if header.search.algorithm == JOINT_STARTS:
            factory = BaselineFactory(f"{name}-{JOINT_STARTS}", header.problem, problem.limits)
            compiled = problem.joint.options.compiled
        else:
            known = precomputed(problem, _cache("precomputed"), pool, watcher)
            factory = AssessmentFactory(name, problem, known)
            compiled = problem.options.compiled
        if compiled:
            _compile(factory, watcher)
    return factory


def evaluator_of(problem: Problem, jobs: int) -> Evaluator:
    """The inner problems of a problem in this process; so many jobs work out what is missing."""
    with make_pool("joblib", jobs) as pool:
        known = known_of(problem, pool)
    return Evaluator(problem, known)


def known_of(problem: Problem, pool: Pool) -> Precomputed:
    """What is known of a problem before any robot is evaluated, worked out where it is missing."""
    with making() as watcher:
        return precomputed(problem, _cache("precomputed"), pool, watcher)


def _compile(factory: Evaluations, watcher: PrecomputeProgress) -> None:
    """Compile a problem's functions unless that was done before, so that no worker waits for another."""
    compiler = find_compiler(os.environ)
    if isinstance(compiler, NotCompiled):
        show_notes([f"{compiler.reason}: solving on CasADi's virtual machine, slower and with equal results"])
        return
    cache, key = _cache("ready"), _mark(factory, compiler)
    if cache is not None and cache.read(key):
        return
    watcher.missing(1)
    factory()
    watcher.done("compiled inner problems")
    if cache is not None:
        cache.store(key, b"ready")


def _mark(factory: Evaluations, compiler: Compiler) -> str:
    """Key of the mark that a problem's functions are compiled."""
    return digest((factory.digest, code_digest(type(factory).__module__), compiler))


def _cache(subject: str) -> Cache | None:
    try:
        return user_cache(subject, os.environ)
    except OSError as error:
        show_notes([f"nothing can be kept for the next time: {error}"])
        return None
