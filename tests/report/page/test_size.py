"""How large a page is: a thousand designs, all of them on the front, in less than 5 MB."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.records import Detail
from evodesign.report.page import page_content, page_html
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter

DESIGNS = 1000


def jittered(part: Any, generator: random.Random) -> Any:
    """Numbers moved by up to a third, so that columns are as full as those of a front."""
    match part:
        case float():
            return part if abs(part) < 1e-12 else part * (0.7 + 0.6 * generator.random())
        case dict():
            return {
                key: value if key == "case" else jittered(value, generator) for key, value in part.items()
            }
        case list() | tuple():
            return [jittered(value, generator) for value in part]
    return part


@pytest.mark.slow
def test_a_page_of_a_thousand_designs_is_smaller_than_5_mb(
    repository: Path, real_run: RunLog, tmp_path: Path
) -> None:
    """Of the problem with hardware, whose page holds what others do, and motors and safety of each design.

    Postures are those of the point-grasp problem, whose robot and person that of hardware has too.
    """
    generator = random.Random(3)
    problem = build_problem(read_source(repository / "problems" / "icub_hardware.toml"))
    sized = {each.name: 20.0 for each in problem.space.parameters if each.name.startswith("margin.")}
    known = msgspec.to_builtins(real_run.details[0])
    found = real_run.evaluations[real_run.details[0].evaluation]
    settings = problem.settings("nsga2", 40, 1)
    with RunWriter(tmp_path / "run", header_of(problem, settings, DESIGNS)) as log:
        for number in range(DESIGNS):
            genome = tuple(generator.random() for _ in problem.space.parameters)
            values = problem.space.named(problem.space.values(genome))
            share = number / DESIGNS
            first, *others = (each.name for each in problem.objectives)
            objectives = dict.fromkeys(others, 10.0 + share) | {first: 11.0 - share + 0.5 * share**2}
            assessment = msgspec.structs.replace(
                found.assessment,
                design=dict(values),
                objectives=objectives,
                rated=jittered(sized, generator) if sized else msgspec.UNSET,
            )
            changed = msgspec.structs.replace(
                found, number=number, genome=genome, generation=number // 40, assessment=assessment
            )
            log.evaluation(changed)
            detail = msgspec.convert(jittered(known, generator), Detail)
            log.detail(msgspec.structs.replace(detail, evaluation=number))
    content = page_content(read_run(tmp_path / "run"))
    assert len(content.points.number) == DESIGNS
    assert all(design.postures for design in content.designs.values()), (
        "every design of the front has its own"
    )
    assert len(page_html(content).encode()) < 5_000_000
