"""The evaluation of a problem, with everything that its workers share precomputed and compiled.

That is kept in the user's cache, so that only the first evaluation of a problem pays for it, and it never
changes a result.
"""

from __future__ import annotations

import os

from evodesign.identity import code_digest, digest
from evodesign.nlp.codegen import Compiler, NotCompiled, find_compiler
from evodesign.nlp.disk_cache import Cache, user_cache
from evodesign.pool.base import Pool
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.baseline import BaselineFactory
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import AssessmentFactory, Evaluator
from evodesign.problem.precompute import precomputed
from evodesign.problem.progress import SILENT, PrecomputeProgress
from evodesign.records import RunHeader
from evodesign.search.base import JOINT_STARTS

__all__ = ["cached_precomputed", "evaluation_factory", "evaluator_of"]

Evaluations = AssessmentFactory | BaselineFactory


def evaluation_factory(header: RunHeader, pool: Pool, progress: PrecomputeProgress = SILENT) -> Evaluations:
    """The evaluation of a header's problem as workers build it.

    Args:
        header: of a run.
        pool: where what no cache holds is worked out.
        progress: is shown what is worked out.
    """
    problem, name = build_problem(header.problem), digest(header.problem)
    factory: Evaluations
    if header.search.algorithm == JOINT_STARTS:
        factory = BaselineFactory(f"{name}-{JOINT_STARTS}", header.problem, problem.limits)
        compiled = problem.joint.options.compiled
    else:
        factory = AssessmentFactory(name, problem, cached_precomputed(problem, pool, progress))
        compiled = problem.options.compiled
    if compiled:
        _compile(factory, progress)
    return factory


def evaluator_of(problem: Problem, jobs: int, progress: PrecomputeProgress = SILENT) -> Evaluator:
    """The inner problems of a problem in this process; so many jobs work out what is missing."""
    with make_pool("joblib", jobs) as pool:
        known = cached_precomputed(problem, pool, progress)
    return Evaluator(problem, known)


def cached_precomputed(problem: Problem, pool: Pool, progress: PrecomputeProgress = SILENT) -> Precomputed:
    """What is known of a problem before any robot is evaluated, worked out where it is missing."""
    return precomputed(problem, _cache("precomputed", progress), pool, progress)


def _compile(factory: Evaluations, progress: PrecomputeProgress) -> None:
    """Compile a problem's functions unless that was done before, so that no worker waits for another."""
    compiler = find_compiler(os.environ)
    if isinstance(compiler, NotCompiled):
        progress.note(
            f"{compiler.reason}: solving on CasADi's virtual machine, slower and with equal results"
        )
        return
    cache, key = _cache("ready", progress), _mark(factory, compiler)
    if cache is not None and cache.read(key):
        return
    progress.missing(1)
    factory()
    progress.done("compiled inner problems")
    if cache is not None:
        cache.store(key, b"ready")


def _mark(factory: Evaluations, compiler: Compiler) -> str:
    """Key of the mark that a problem's functions are compiled."""
    return digest((factory.digest, code_digest(type(factory).__module__), compiler))


def _cache(subject: str, progress: PrecomputeProgress) -> Cache | None:
    """The user's cache of a subject; None where nothing can be kept."""
    try:
        return user_cache(subject, os.environ)
    except OSError as error:
        progress.note(f"nothing can be kept for the next time: {error}")
        return None
