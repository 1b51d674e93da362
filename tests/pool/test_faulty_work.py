"""Searches whose designs kill, hang and poison, and whose machines come and go."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from evodesign.evolve import start
from evodesign.pool.base import Limits, Pool
from evodesign.pool.registry import make_pool
from evodesign.pool.worker import SerialPool
from evodesign.records import Evaluation, RunHeader, Status
from evodesign.runlog.session_log import Silent
from tests.pool.cluster import Cluster
from tests.pool.faulty import HANGS, KILLS, NOT_A_NUMBER, Faulty, Slow, fault, results
from tests.runlog.toys import essence, toy_header

pytestmark = pytest.mark.slow

REASONS = {
    KILLS: "the worker process died (signal 9), also when retried alone",
    HANGS: "no result after 5 s, so the worker process was ended",
    NOT_A_NUMBER: "not a finite number: assessment.objectives.robot_torque is nan",
}


def header_of(algorithm: str, population: int, budget: int, seed: int = 3) -> RunHeader:
    toy = toy_header(population=population, budget=budget, seed=seed)
    settings = msgspec.structs.replace(toy.search, algorithm=algorithm, start=())
    return msgspec.structs.replace(toy, search=settings)


@pytest.fixture(params=["joblib", "dask"])
def pool(request: pytest.FixtureRequest) -> Iterator[Pool]:
    scheduler = request.getfixturevalue("cluster").address if request.param == "dask" else None
    with make_pool(request.param, 2, scheduler) as made:
        yield made


def test_every_tenth_design_kills_every_tenth_hangs_every_tenth_is_not_a_number(
    pool: Pool, tmp_path: Path
) -> None:
    header = header_of("random", population=20, budget=40, seed=8)  # of which three hang
    calls = tmp_path / "calls"
    factory = Faulty(header.parameters, str(calls), Limits(seconds=5.0))
    run = start(tmp_path / "run", header, factory, pool, Silent())
    expected = Counter(fault(evaluation.genome) for evaluation in run.evaluations)
    assert all(expected[kind] >= 3 for kind in REASONS)
    found = Counter(evaluation.assessment.status for evaluation in run.evaluations)
    assert len(run.evaluations) == header.budget
    assert found[Status.WORKER_LOST] == expected[KILLS]
    assert found[Status.TIME_LIMIT] == expected[HANGS]
    assert found[Status.NUMERICAL_FAILURE] == expected[NOT_A_NUMBER]
    called = Counter(calls.read_text().splitlines())
    for evaluation in run.evaluations:
        kind = fault(evaluation.genome)
        assert called[str(evaluation.genome)] == (2 if kind == KILLS else 1)
        if kind in REASONS:
            assert evaluation.assessment.reason == REASONS[kind]
        else:
            assert evaluation.assessment == results(header.parameters, evaluation.genome)


class Trouble(Silent):
    """Kills workers when some evaluations are done, adds one, and later kills and restarts the scheduler."""

    def __init__(self, cluster: Cluster) -> None:
        self._cluster = cluster

    def evaluated(self, evaluation: Evaluation, done: int, budget: int) -> None:
        cluster = self._cluster
        if done == 20:
            cluster.kill_worker()
            cluster.kill_worker()
            cluster.add_worker("--no-nanny")
        if done == 60:
            cluster.kill_scheduler()
            cluster.start_scheduler()
            for _ in range(3):
                cluster.add_worker("--no-nanny")


def test_workers_and_a_scheduler_that_come_and_go_change_nothing(tmp_path: Path) -> None:
    header = header_of("nsga2", population=24, budget=120)
    alone = start(tmp_path / "alone", header, Slow(header.parameters, 0.0), SerialPool(), Silent())
    with Cluster() as cluster:
        cluster.start_scheduler()
        for _ in range(4):
            cluster.add_worker("--no-nanny")
        cluster.wait_for(4)
        with make_pool("dask", 1, cluster.address) as pool:
            slow = Slow(header.parameters, 0.05)
            with pytest.warns(UserWarning, match="is lost; waiting for it"):
                together = start(tmp_path / "together", header, slow, pool, Trouble(cluster))
    assert essence(together) == essence(alone)
    workers = [
        {each.worker for each in part} for part in (together.evaluations[:20], together.evaluations[96:])
    ]
    assert workers[0].isdisjoint(workers[1]), "the last ones ran on workers started after the scheduler's end"
    assert not any("lost" in each.worker for each in together.evaluations)
