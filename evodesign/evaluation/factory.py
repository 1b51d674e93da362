"""The evaluation of a problem, with all that is kept in the user's cache: nothing is worked out twice.

Pieces that workers share are precomputed and compiled, so that only the first evaluation of a problem pays
for them; they never change a result. Evaluations may be kept between runs as well. What is kept stands under
a digest of everything that it follows from: the problem's tables but for named exceptions, the texts of the
files that they name, the genome, and the code that evaluates with what it stands on. A change of any of these
is another key. Each machine keeps its own, in its user's cache; where that is shared, so is what is kept.

A result that another machine or another day might not give (a time limit) is not kept.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace

import msgspec

from evodesign.evaluation.baseline import BaselineFactory
from evodesign.evaluation.evaluate import AssessmentFactory, Evaluator
from evodesign.evaluation.precompute import precomputed
from evodesign.evaluation.progress import SILENT, PrecomputeProgress
from evodesign.identity import Exceptions, code_digest, digest
from evodesign.nlp.compiler import NotCompiled, find_compiler
from evodesign.nlp.disk_cache import Cache, user_cache
from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.native.calls import method_library
from evodesign.nlp.solver import own_solvers
from evodesign.outside import is_outside
from evodesign.pool.base import Limits, Pool
from evodesign.pool.registry import make_pool
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.agent_tables import HumanTable
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.file import ProblemFile, SolverTable
from evodesign.problem.source import decode_toml
from evodesign.records import (
    Assessed,
    Constraint,
    Genome,
    Lift,
    Objective,
    ProblemSource,
    RunHeader,
    Status,
)
from evodesign.searches.base import JOINT_STARTS

Evaluations = AssessmentFactory | BaselineFactory


def evaluation_factory(header: RunHeader, pool: Pool, progress: PrecomputeProgress = SILENT) -> Evaluations:
    """The evaluation of a header's problem as workers build it.

    Args:
        header: of a run.
        pool: where what no cache holds is worked out.
        progress: is shown what is worked out.
    """
    problem = build_problem(header.problem)
    if header.search.algorithm != JOINT_STARTS:
        evaluation = _assessment_factory(problem, pool, progress)
        return replace(evaluation, gradients=header.search.with_gradients)
    factory = BaselineFactory(f"{digest(header.problem)}-{JOINT_STARTS}", header.problem, problem.limits)
    _say_what_compiles(problem.joint.options, progress)
    return factory


@dataclass(frozen=True, slots=True)
class ValuesFactory:
    """Builds the evaluation of designs given as one number per parameter, in whichever process it is called.

    Args:
        factory: of the same problem's evaluation of genomes.
    """

    factory: AssessmentFactory

    @property
    def limits(self) -> Limits:
        """Those of the factory inside."""
        return self.factory.limits

    def __call__(self) -> Callable[[Sequence[float]], Assessed]:
        """Build the inner problems and return the function from values to results."""
        return Evaluator(self.factory.problem, self.factory.known, own_solvers()).assess_values


def values_factory(
    problem: DesignProblem, pool: Pool, progress: PrecomputeProgress = SILENT
) -> ValuesFactory:
    """The evaluation of a problem's designs as workers build it, from values instead of genomes.

    Args:
        problem: whose designs they are.
        pool: where what no cache holds is worked out.
        progress: is shown what is worked out.
    """
    return ValuesFactory(_assessment_factory(problem, pool, progress))


def evaluator_of(
    problem: DesignProblem, jobs: int, progress: PrecomputeProgress = SILENT, lifts: Sequence[Lift] = ()
) -> Evaluator:
    """The inner problems of a problem in this process; so many jobs work out what is missing."""
    with make_pool("joblib", jobs, note=progress.note) as pool:
        known = cached_precomputed(problem, pool, progress, lifts)
    return Evaluator(problem, known)


def cached_precomputed(
    problem: DesignProblem, pool: Pool, progress: PrecomputeProgress = SILENT, lifts: Sequence[Lift] = ()
) -> Precomputed:
    """What is known of a problem before any robot is evaluated, worked out where it is missing.

    Args:
        problem: it.
        pool: where it is worked out.
        progress: is shown what is.
        lifts: of which starts are asked for, beside the problem's own.
    """
    return precomputed(problem, _cache("precomputed", progress), pool, progress, lifts=lifts)


def _assessment_factory(
    problem: DesignProblem, pool: Pool, progress: PrecomputeProgress
) -> AssessmentFactory:
    """The evaluation of a problem's designs, with all that is worked out once."""
    _say_what_compiles(problem.options, progress)
    known = precomputed(problem, _cache("precomputed", progress), pool, progress)
    return AssessmentFactory(digest(problem.source), problem, known)


def _say_what_compiles(options: SolverOptions, progress: PrecomputeProgress) -> None:
    """Tell what stands in the way of fast solves by some options."""
    if not options.compiled:
        return
    compiler = find_compiler(os.environ)
    if isinstance(compiler, NotCompiled):
        progress.note(f"{compiler.reason}: IPOPT solves, on CasADi's virtual machine, many times slower")
        return
    if compiler.bundled:
        progress.note(
            "TinyCC compiles; evaluations take up to twice as long as with gcc or clang, to the same digits"
        )
    if options.method is MethodName.IPOPT and isinstance(native := method_library(), NotCompiled):
        progress.note(f"{native.reason}: IPOPT solves, several times slower")


def _cache(subject: str, progress: PrecomputeProgress = SILENT) -> Cache | None:
    """The user's cache of a subject; None where nothing can be kept."""
    try:
        return user_cache(subject, os.environ)
    except OSError as error:
        progress.note(f"nothing can be kept for the next time: {error}")
        return None


NO_PART_OF_EVALUATIONS: Exceptions = {
    ProblemFile: {
        "name": "is a word for results",
        "description": "is for people",
        "search": "says which designs are evaluated, and when",
    },
    HumanTable: {"spread": "is asked after a search"},
    SolverTable: {
        "evaluation_seconds": "what such a limit ended is not kept",
        "evaluation_memory_gb": "what such a limit ended is not kept",
    },
    ProblemSource: {"path": "is for messages", "text": "counts as the tables that it holds"},
}

EVALUATING = ("evodesign.evaluation.evaluate", "evodesign.evaluation.precompute")
"""The modules that evaluate, and that work out what is known beforehand."""

PASSING = frozenset({Status.TIME_LIMIT, Status.WORKER_LOST})
"""What another try might not give."""

GRADIENTS = "gradients"
"""What the key of an evaluation says that comes with them."""

Task = Callable[[Genome], Assessed]


@dataclass(frozen=True, slots=True)
class Remembering:
    """Builds an evaluation that looks first whether it knows the design.

    With objectives from outside of the package nothing is kept: no digest has their code.

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
        problem = self.factory.problem
        quantities: tuple[Objective | Constraint, ...] = (*problem.objectives, *problem.constraints)
        if any(is_outside(quantity.name) for quantity in quantities):
            return self.factory()
        shelf = f"evaluations/{problem_digest(self.factory.source)}"
        kind = GRADIENTS if self.factory.gradients else ""
        return functools.partial(_remembered, functools.cache(self.factory), shelf, kind)


def problem_digest(source: ProblemSource) -> str:
    """Digest of everything but the genome that an evaluation follows from.

    The designs that a search starts from are no part of it, although the problem names their file.
    """
    tables = decode_toml(source.text, source.path, ProblemFile)
    files = {name: text for name, text in source.files.items() if name != tables.search.start}
    named = msgspec.structs.replace(source, files=files)
    return digest((tables, named, code_digest(*EVALUATING)), without=NO_PART_OF_EVALUATIONS)


def _remembered(task: Callable[[], Task], shelf: str, kind: str, genome: Genome) -> Assessed:
    """What a genome is worth: as kept, or worked out by one process while others wait for it."""
    key = digest((genome, kind) if kind else genome)
    cache = _cache(f"{shelf}/{key[:2]}")
    if cache is None:
        return task()(genome)
    with ExitStack() as held:
        with suppress(OSError):  # without the lock, at worst the work is done twice
            held.enter_context(cache.lock(key, keep=False))
        known = _read(cache, key)
        if known is not None:
            return msgspec.structs.replace(known, gradient_seconds=0.0)
        return _kept(cache, key, task()(genome))


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
