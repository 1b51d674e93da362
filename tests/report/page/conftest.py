"""A browser, and a small real run: named designs of the point-grasp problem and some random ones, logged."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from evodesign.analysis.front import RunningFront, front
from evodesign.analysis.hypervolume import best, hypervolume, reference_point
from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.records import Detail, Evaluation, Front, Generation
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from tests.report.page.chromium import Tab, browser
from tests.report.page.reading import open_page

RANDOM_DESIGNS = 4


@pytest.fixture(scope="session")
def real_run(native: DesignProblem, known: Precomputed, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    """One generation of real evaluations, with the postures that a search would log."""
    directory = tmp_path_factory.mktemp("page") / "real"
    generator = random.Random(7)
    evaluator = Evaluator(native, known)
    genomes = [*native.start]
    genomes += [tuple(generator.random() for _ in genomes[0]) for _ in range(RANDOM_DESIGNS)]
    settings = native.settings("nsga2", len(genomes), 1)
    objectives = native.objectives
    running = RunningFront(objectives)
    done: list[Evaluation] = []
    with RunWriter(directory, header_of(native, settings, len(genomes))) as log:
        for number, genome in enumerate(genomes):
            assessed = evaluator.assess(genome)
            evaluation = Evaluation(
                number=number,
                generation=0,
                genome=genome,
                assessment=assessed.assessment,
                seconds=0.25,
                worker="here",
            )
            done.append(evaluation)
            log.write(evaluation)
            if running.enters(evaluation):
                log.write(Detail(evaluation=number, cases=assessed.cases))
        reference = reference_point(objectives, done)
        assert reference is not None
        log.write(
            Generation(
                number=0,
                evaluations=len(done),
                feasible_share=sum(evaluation.feasible for evaluation in done) / len(done),
                hypervolume=hypervolume(objectives, done, reference),
                reference=reference,
                best=best(objectives, done),
                seconds=3.0,
            )
        )
        numbers = tuple(evaluation.number for evaluation in front(objectives, done))
        log.write(Front(generation=0, evaluations=numbers))
    return read_run(directory)


@pytest.fixture(scope="session")
def real_page(real_run: RunLog) -> Path:
    """The page of the real run."""
    from evodesign.report.page import page_content, page_html

    path = real_run.directory / "report.html"
    path.write_text(page_html(page_content(real_run)), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    """A tab of a browser of the module's own."""
    with browser(tmp_path_factory.mktemp("profile") / "chromium") as tab:
        yield tab


@pytest.fixture
def page(chromium: Tab, real_page: Path) -> Iterator[Tab]:
    """The real run's page, newly opened; at the end it must have reported no error."""
    chromium.events.clear()
    open_page(chromium, real_page)
    yield chromium
    assert chromium.complaints() == []
    assert chromium.requests() == [real_page.as_uri()]
