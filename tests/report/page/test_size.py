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
from evodesign.report.page.content import Content
from evodesign.report.page.postures import details_shown, most_designs
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter

DESIGNS, MADE = 1000, 50


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

    A page is made of 50 designs; the others lie between two of them.

    Postures are those of the point-grasp problem, whose robot and person that of hardware has too.
    """
    generator = random.Random(3)
    problem = build_problem(read_source(repository / "problems" / "icub_hardware.toml"))
    sized = {each.name: 20.0 for each in problem.space.parameters if each.name.startswith("margin.")}
    known = msgspec.to_builtins(real_run.details[0])
    found = real_run.evaluations[real_run.details[0].evaluation]
    settings = problem.settings("nsga2", 40, 1)
    with RunWriter(tmp_path / "run", header_of(problem, settings, MADE)) as log:
        for number in range(MADE):
            genome = tuple(generator.random() for _ in problem.space.parameters)
            values = problem.space.named(problem.space.values(genome))
            share = number / MADE
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
            log.write(changed)
            detail = msgspec.convert(jittered(known, generator), Detail)
            log.write(msgspec.structs.replace(detail, evaluation=number))
    run = read_run(tmp_path / "run")
    assert details_shown(run.details, (), run.evaluations, range(MADE))[1] == (), "none is left out"
    assert most_designs(run.details) >= DESIGNS
    content = many(page_content(run), generator)
    assert (
        len(content.points.number) == DESIGNS == sum(bool(each.postures) for each in content.designs.values())
    )
    assert len(page_html(content).encode()) < 5_000_000


def many(content: Content, generator: random.Random) -> Content:
    """A page's content with a thousand designs in place of its own, each between two of these."""
    told = msgspec.to_builtins(content)
    designs = {}
    for number in range(DESIGNS):
        one, other = (told["designs"][generator.randrange(MADE)] for _ in range(2))
        designs[number] = between(one, other, generator.random())
        if number >= len(content.marks):
            designs[number] |= {"slices": [], "replay": ""}
    for key, column in told["points"].items():
        for values in column.values() if isinstance(column, dict) else [column]:
            values *= DESIGNS // MADE
            values[:] = range(DESIGNS) if key == "number" else jittered(values, generator)
    return msgspec.convert(told | {"designs": designs}, Content, strict=False)


def between(one: Any, other: Any, share: float) -> Any:
    """Numbers so far from one to the other, with seven digits; what has no match in the other stays."""
    match one, other:
        case float(), float():
            return float(f"{one + share * (other - one):.7g}")
        case dict(), dict():
            return {key: between(value, other.get(key), share) for key, value in one.items()}
        case list() | tuple(), list() | tuple() if len(one) == len(other):
            return [between(*pair, share) for pair in zip(one, other, strict=True)]
    return one
