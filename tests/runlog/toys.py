"""Small deterministic stand-ins: a header, evaluations, a search, a task and pools."""

from __future__ import annotations

import hashlib
import random
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec

from evodesign.pool.base import Finished, Pool
from evodesign.records import (
    FORMAT_VERSION,
    AgentDetail,
    Assessed,
    Assessment,
    Case,
    CaseDetail,
    CaseOutcome,
    Detail,
    Evaluation,
    Front,
    Generation,
    Genome,
    Hold,
    InstantDetail,
    Objective,
    Parameter,
    ProblemSource,
    ReachOutcome,
    RunHeader,
    SearchSettings,
    Sense,
    Status,
    design_of,
)
from evodesign.runlog.run import RunLog
from evodesign.searches.base import Outcome

OBJECTIVES = (
    Objective(name="robot_torque", sense=Sense.MINIMISE, unit="N m"),
    Objective(name="reach_height", sense=Sense.MAXIMISE, unit="m"),
)


def toy_header(population: int = 4, budget: int = 12, seed: int = 1, dimension: int = 2) -> RunHeader:
    parameters = tuple(
        Parameter(name=f"arm.{index}", lower=0.5, upper=2.0, unit="1") for index in range(dimension)
    )
    search = SearchSettings(
        algorithm="toy",
        dimension=dimension,
        objectives=len(OBJECTIVES),
        population=population,
        seed=seed,
        start=((0.25,) * dimension,),
    )
    return RunHeader(
        format_version=FORMAT_VERSION,
        problem=ProblemSource(path="toy.toml", text='name = "töy"', files={"toy.urdf": "<robot/>"}),
        problem_name="toy",
        parameters=parameters,
        objectives=OBJECTIVES,
        search=search,
        budget=budget,
        versions={"evodesign": "0"},
        git=None,
        started="2024-01-01T00:00:00+00:00",
    )


def toy_assessment(genome: Genome, header: RunHeader) -> Assessment:
    """A function of the genome alone; designs with a short first arm are infeasible, some without torque."""
    reach = 1.0 + genome[0] - 0.1 * genome[1]
    violation = max(0.0, 0.3 - genome[0])
    solved = violation == 0.0
    torque = 30.0 * (1.0 + (genome[0] - 0.5) ** 2 + genome[1] / 3.0)
    outcome = CaseOutcome(
        case=Case(task=Hold(height_m=1.0)),
        status=Status.SOLVED if solved else Status.INFEASIBLE,
        reason="" if solved else "too high by a third",
        robot_torque_norm=torque if solved else None,
        human_torque_norm=7.5 if solved else None,
        iterations=17,
        residual=1e-9 if solved else None,
    )
    return Assessment(
        design=design_of(header.parameters, genome),
        objectives={"reach_height": reach} | ({"robot_torque": torque} if solved else {}),
        violation=violation,
        status=outcome.status,
        reason=outcome.reason,
        reach=ReachOutcome(lowest_m=None, highest_m=reach, status=Status.SOLVED, reason=""),
        cases=(outcome,) * 3,
    )


def toy_cases(genome: Genome) -> tuple[CaseDetail, ...]:
    """A posture of one joint that follows from the genome."""
    names = ("left_hand", "right_hand", "left_foot", "right_foot")
    wrenches = dict.fromkeys(names, (0.0, 0.0, 12.5, 0.0, 0.0, 0.0))
    agent = AgentDetail(
        base_position_m=(-0.4, 0.0, genome[0]),
        base_rpy_rad=(0.0, genome[1], 0.0),
        joints_rad={"elbow": genome[0]},
        torques_n_m={"elbow": 30.0 * genome[1]},
        wrenches=wrenches,
    )
    instant = InstantDetail(time_s=0.0, agents={"robot": agent, "human": agent})
    return (CaseDetail(case=Case(task=Hold(height_m=1.0)), instants=(instant,)),)


def toy_assessed(genome: Genome, header: RunHeader) -> Assessed:
    assessment = toy_assessment(genome, header)
    return Assessed(assessment=assessment, cases=toy_cases(genome))


def toy_detail(evaluation: Evaluation) -> Detail:
    return Detail(evaluation=evaluation.number, cases=toy_cases(evaluation.genome))


def toy_evaluations(header: RunHeader, count: int) -> list[Evaluation]:
    generator = random.Random(header.search.seed)
    evaluations = []
    for number in range(count):
        genome = tuple(generator.random() for _ in header.parameters)
        evaluations.append(
            Evaluation(
                number=number,
                generation=number // header.search.population,
                genome=genome,
                assessment=toy_assessment(genome, header),
                seconds=generator.random(),
                worker=f"local-{number % 2}",
            )
        )
    return evaluations


def toy_generation(number: int, evaluations: int) -> Generation:
    return Generation(
        number=number,
        evaluations=evaluations,
        feasible_share=0.5,
        hypervolume=None if number == 0 else 1.25,
        reference=None if number == 0 else {"robot_torque": 60.0, "reach_height": 1.0},
        best={} if number == 0 else {"robot_torque": 30.0, "reach_height": 1.5},
        seconds=0.1,
    )


def toy_front(generation: int) -> Front:
    return Front(generation=generation, evaluations=tuple(range(generation + 1)))


class ToySearch:
    """Asks for genomes that depend on the seed and on every outcome that it was told, to the last bit."""

    def __init__(self, settings: SearchSettings) -> None:
        self._settings = settings
        self._told = hashlib.sha256(str(settings.seed).encode())

    def ask(self) -> tuple[Genome, ...]:
        generator = random.Random(self._told.digest())
        settings = self._settings
        return tuple(
            tuple(generator.random() for _ in range(settings.dimension)) for _ in range(settings.population)
        )

    def tell(self, outcomes: Sequence[Outcome]) -> None:
        assert len(outcomes) == self._settings.population
        self._told.update(repr(outcomes).encode())


@dataclass
class ToyTask:
    """Makes tasks that assess genomes and count how often; `before` runs first."""

    header: RunHeader
    before: Callable[[int], object] = lambda call: None
    genomes: list[Genome] = field(default_factory=list)

    def __call__(self) -> Callable[[Genome], Assessed]:
        def task(genome: Genome) -> Assessed:
            self.before(len(self.genomes))
            self.genomes.append(genome)
            return toy_assessed(genome, self.header)

        return task


class OrderedPool(Pool):
    """Runs in this process, one by one, or all at once and gives back in an order made from their number."""

    def __init__(self, order: Callable[[int], Sequence[int]] | None = None) -> None:
        self._order = order
        self.closed_early = 0

    def run(self, factory: Any, arguments: Iterable[Any]) -> Iterator[Finished[Any]]:
        task = factory()
        try:
            if self._order is None:
                for index, argument in enumerate(arguments):
                    yield self.finish(task, index, argument)
            else:
                given = list(arguments)
                for index in self._order(len(given)):
                    yield self.finish(task, index, given[index])
        except GeneratorExit:
            self.closed_early += 1
            raise

    def finish(self, task: Callable[[Any], Any], index: int, argument: Any) -> Finished[Any]:
        return Finished(index, task(argument), None, False, 0.25, "here")

    def close(self) -> None:
        pass


def shuffled(seed: int) -> Callable[[int], Sequence[int]]:
    def order(count: int) -> Sequence[int]:
        return random.Random(seed).sample(range(count), count)

    return order


def essence(run: RunLog) -> tuple[list[Evaluation], list[Generation], tuple[Front, ...]]:
    """What must be equal between two runs: everything but times and names of workers.

    Postures of designs that were dominated when they arrived may be there or not: those that a stop logs
    early are compared with fewer others.
    """
    return (
        [msgspec.structs.replace(each, seconds=0.0, worker="") for each in run.evaluations],
        [msgspec.structs.replace(each, seconds=0.0) for each in run.generations],
        run.fronts,
    )


def lost(evaluation: Evaluation) -> Evaluation:
    """The same evaluation, had its worker been lost."""
    failed = msgspec.structs.replace(
        evaluation.assessment,
        objectives={},
        violation=None,
        status=Status.WORKER_LOST,
        reason="the worker was lost",
        reach=None,
        cases=(),
    )
    return msgspec.structs.replace(evaluation, assessment=failed)
