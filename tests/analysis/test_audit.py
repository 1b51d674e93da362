from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.analysis.audit import audit, losses
from evodesign.evolve import start
from evodesign.runlog.run import RunLog
from evodesign.runlog.session_log import Silent
from tests.runlog.toys import OrderedPool, ToySearch, ToyTask, shuffled, toy_header


@pytest.fixture
def run(tmp_path: Path) -> RunLog:
    header = toy_header(population=5, budget=33)
    pool = OrderedPool(shuffled(2))
    return start(tmp_path / "run", header, ToyTask(header), pool, Silent(), make_search=ToySearch)


def test_a_sound_run_has_no_contradictions_and_no_losses(run: RunLog) -> None:
    assert audit(run) == []
    assert losses(run) == []


def changed(run: RunLog, field: str, index: int, **values: Any) -> RunLog:
    records = list(getattr(run, field))
    records[index] = msgspec.structs.replace(records[index], **values)
    return replace(run, **{field: tuple(records)})


def reassessed(run: RunLog, index: int, **values: Any) -> RunLog:
    assessment = msgspec.structs.replace(run.evaluations[index].assessment, **values)
    return changed(run, "evaluations", index, assessment=assessment)


def better(run: RunLog) -> RunLog:
    """A feasible design that the log calls much better than it was told."""
    (first, *_) = run.fronts[-1].evaluations
    return reassessed(run, first, objectives={"robot_torque": 0.5, "reach_height": 9.0})


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda run: changed(run, "evaluations", 3, genome=(0.5, 0.5)), "3: its design is not that of its"),
        (lambda run: changed(run, "evaluations", 3, genome=(0.5, 1.5)), "3: its genome lies outside"),
        (lambda run: changed(run, "evaluations", 3, genome=(0.5,)), "3: wanted 2 coordinates, found 1"),
        (lambda run: reassessed(run, 3, objectives={"speed": 1.0}), "3: it has unknown objectives: speed"),
        (lambda run: reassessed(run, 3, violation=-1.0), "3: its violation is negative"),
        (lambda run: replace(run, evaluations=run.evaluations[1:]), "missing evaluations: 0"),
        (lambda run: changed(run, "generations", 2, hypervolume=0.1), "2: its hypervolume is not that"),
        (lambda run: changed(run, "generations", 2, hypervolume=None), "2: its hypervolume is not that"),
        (lambda run: changed(run, "generations", 2, best={}), "2: its best is not that"),
        (
            lambda run: changed(run, "generations", 2, feasible_share=0.01),
            "2: its feasible share is not that",
        ),
        (lambda run: changed(run, "generations", 2, evaluations=14), "counts 14 evaluations"),
        (lambda run: changed(run, "fronts", 2, evaluations=(1,)), "2: its front is not that"),
        (lambda run: replace(run, details=run.details[1:]), "no postures for members of a front"),
        (lambda run: changed(run, "details", 0, evaluation=3), "no postures for members of a front"),
        (better, "its best is not that of the evaluations"),
    ],
)
def test_every_contradiction_is_found(run: RunLog, damage: Callable[[RunLog], RunLog], sentence: str) -> None:
    assert any(sentence in fault for fault in audit(damage(run)))


def test_losses_are_listed_by_kind_with_ranges(run: RunLog) -> None:
    kept = [*run.evaluations[:4], run.evaluations[5], *run.evaluations[9:]]
    damaged = replace(run, evaluations=tuple(kept), generations=run.generations[1:], fronts=run.fronts[:-1])
    assert losses(damaged)[:3] == [
        "missing evaluations: 4, 6 to 8",
        "missing states of generations: 0",
        "missing fronts of generations: 5",
    ]


def test_evaluations_lost_at_the_end_are_known_from_the_fronts(run: RunLog) -> None:
    assert "missing evaluations: 8 to 29" in losses(replace(run, evaluations=run.evaluations[:8]))[0]
