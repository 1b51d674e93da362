"""The bill of materials on a design's card: what the bill says, and readable on a phone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.evaluate import Evaluator
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.hardware_quantities import winding_temperature
from evodesign.records import Detail, Evaluation, Hold
from evodesign.report.page import page_content, page_html
from evodesign.report.page.card import hardware_content
from evodesign.runlog.header import header_of
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from evodesign.tree.words import in_words
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page, shown_as
from tests.report.scenes import random_detail

pytestmark = [pytest.mark.needs_chromium, pytest.mark.slow]

SECTION = "[...document.querySelectorAll('.card details')].find(d => d.textContent.startsWith('{title}'))"


@pytest.fixture(scope="module")
def hardware(repository: Path) -> DesignProblem:
    """The problem of hardware at one height, solved by IPOPT on CasADi's virtual machine."""
    source = read_source(repository / "problems" / "icub_hardware.toml")
    built = build_problem(msgspec.structs.replace(source, method="ipopt"))
    return replace(built, tasks=(Hold(height_m=1.0),), options=replace(built.options, compiled=False))


@pytest.fixture(scope="module")
def run(hardware: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    """A run of one design."""
    directory, evaluator = tmp_path_factory.mktemp("hardware") / "run", Evaluator(hardware)
    genome = (0.4,) * len(hardware.space.parameters)
    assessed = evaluator.assess(genome)
    assert assessed.cases, assessed.assessment.reason
    with RunWriter(directory, header_of(hardware, hardware.settings("nsga2", 1, 1), 1)) as log:
        log.write(
            Evaluation(
                number=0,
                generation=0,
                genome=genome,
                assessment=assessed.assessment,
                seconds=0.1,
                worker="here",
            )
        )
        log.write(Detail(evaluation=0, cases=assessed.cases))
    return read_run(directory)


@pytest.fixture(scope="module")
def page(run: RunLog) -> Path:
    """The page of that run."""
    path = run.directory / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    return path


def test_the_card_shows_what_the_bill_says(
    chromium: Tab, run: RunLog, page: Path, hardware: DesignProblem
) -> None:
    chromium.events.clear()
    open_page(chromium, page)
    assessment = run.evaluations[0].assessment
    values = hardware.space.given(list(assessment.design.values()), assessment.rated_torques)
    tree = hardware.space.resized(hardware.scene.robot.tree, values)
    bill = bill_of_materials(hardware, tree, run.details[0].cases)
    for part, mass in bill["mass_kg"].items():
        shown = chromium.value(f"document.querySelector('[data-mass={part}] .number').textContent")
        assert shown == f"{shown_as(mass)} kg"
    for parameter in hardware.space.parameters:
        if not parameter.joints:
            continue
        rows = {joint: bill["joints"][joint] for joint in parameter.joints}
        most = max(rows, key=lambda joint: rows[joint]["share"])
        text = chromium.value(f"document.querySelector('[data-actuator={parameter.group}]').textContent")
        assert text.startswith(f"{len(rows)} \u00d7 {parameter.group}")
        assert f"{in_words(most)} needs {rows[most]['asked_n_m']:.3g} N m ({rows[most]['asked_by']})" in text
        assert f"{rows[most]['rated_torque_n_m']:.3g}" in text
    forearm = bill["links"]["l_forearm"]
    text = chromium.value("document.querySelector('[data-wall=l_forearm]').textContent")
    assert text.startswith("l_forearmaluminium 60612")
    assert f"{float(format(forearm['safety_factor'], '.3g')):g}" in text
    assert text.endswith(f"{forearm['safety_mode']}, {forearm['safety_case']}")
    text = chromium.value("document.querySelector('[data-mass=total]').closest('table').textContent")
    assert text.startswith(f"{'. '.join(bill['governs'])}.")
    assert chromium.complaints() == []


@pytest.mark.parametrize("width", [390, 1024])
def test_the_tables_fit_into_a_card(chromium: Tab, page: Path, width: int) -> None:
    chromium.open(page.as_uri(), width=width)
    chromium.wait_for("window.evodesign !== undefined")
    for title in ("Bill of materials", "Actuators", "Walls"):
        section = SECTION.format(title=title)
        assert chromium.value(f"{section}.scrollWidth <= {section}.clientWidth"), title


def test_windings_are_as_warm_as_the_quantity_says(repository: Path) -> None:
    source = read_source(repository / "problems" / "icub_hardware.toml")
    duty = "[duty]\nlifts_per_hour = 60\nhold_s = 20.0\nshift_h = 8.0\nwinding_limit_c = 120.0\n"
    duty += "thermal_time_constant_s = 120.0\n"
    problem = build_problem(msgspec.structs.replace(source, text=source.text + "\n" + duty))
    values = problem.space.values((0.5,) * len(problem.space.parameters))
    tree = problem.space.resized(problem.scene.designed_tree, problem.space.given(values, {}))
    cases = random_detail(problem, 3).cases
    content = hardware_content(problem, tree, cases)
    assert content is not None
    robot = replace(problem.scene.robot, tree=tree)
    warmest = max(winding_temperature(robot, logged_posture(case.agents["robot"])) for case in cases)
    assert max(one.winding_c for one in content.actuators) == pytest.approx(warmest)
    assert {one.winding_limit_c for one in content.actuators} == {120.0}


def test_a_problem_without_hardware_has_no_such_sections(real_run: RunLog) -> None:
    assert all(design.hardware is None for design in page_content(real_run).designs.values())
