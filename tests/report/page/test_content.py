"""What stands in the page is what stands in the log."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.active_limits import frequent_limits
from evodesign.analysis.front import front
from evodesign.analysis.gains import gains
from evodesign.errors import InputError
from evodesign.evaluation.clearance import Clearances
from evodesign.problem.build import DesignProblem
from evodesign.problem.left_out import left_out
from evodesign.records import Objective, Sense
from evodesign.report.page import gather, page_content, page_html, postures
from evodesign.report.page.content import Content, Points
from evodesign.report.page.marks import chosen_points
from evodesign.report.page.render import TEMPLATE
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from tests.report.page.reading import check_as_shown, check_to_seven_digits, embedded
from tests.runlog.toys import toy_detail, toy_evaluations, toy_generation, toy_header

pytestmark = pytest.mark.slow

NAME = "</script><script>alert(1)</script>"


@pytest.fixture(scope="module")
def content(real_run: RunLog) -> Content:
    return page_content(real_run)


def toy_run(directory: Path, count: int = 30) -> RunLog:
    header = toy_header()
    with RunWriter(directory, header) as log:
        for evaluation in toy_evaluations(header, count):
            log.write(evaluation)
            log.write(toy_detail(evaluation))
        log.write(toy_generation(0, count))
    return read_run(directory)


def test_every_number_of_an_evaluation_is_the_logs(real_run: RunLog, content: Content) -> None:
    points = content.points
    assert points.number == [evaluation.number for evaluation in real_run.evaluations]
    for row, evaluation in enumerate(real_run.evaluations):
        assessment = evaluation.assessment
        assert {name: column[row] for name, column in points.objectives.items()} == assessment.objectives
        assert {name: column[row] for name, column in points.parameters.items()} == assessment.design
        assert points.violation[row] == assessment.violation
        assert assessment.reach is not None
        assert (points.lowest_m[row], points.highest_m[row]) == (
            assessment.reach.lowest_m,
            assessment.reach.highest_m,
        )
    assert content.generations == real_run.generations


def test_every_posture_is_the_logs(real_run: RunLog, content: Content) -> None:
    assert real_run.details
    details = {detail.evaluation: detail for detail in real_run.details}
    on_front = {evaluation.number for evaluation in front(real_run.header.objectives, real_run.evaluations)}
    assert on_front <= set(content.designs)
    for number, design in content.designs.items():
        check_to_seven_digits(design.postures, details[number].cases if number in details else ())
        check_to_seven_digits(design.cases, real_run.evaluations[number].assessment.cases)


def test_every_posture_has_its_nearest_bodies(
    real_run: RunLog, content: Content, problem: DesignProblem
) -> None:
    details = {detail.evaluation: detail.cases for detail in real_run.details}
    for number, design in content.designs.items():
        assert len(design.clearances) == len(design.postures)
        if not design.postures:
            continue
        own = problem.space.values(real_run.evaluations[number].genome)
        robot = problem.space.resized(problem.scene.robot.tree, own)
        found = Clearances(problem.scenes).of(robot, details[number])
        check_to_seven_digits(
            [(each.first, each.second, each.distance_m) for each in design.clearances],
            [(each.first, each.second, each.distance) for each in found],
        )
        break


def test_masses_are_the_resized_robots(real_run: RunLog, content: Content, problem: DesignProblem) -> None:
    assert content.bodies is not None
    for number, design in content.designs.items():
        if design.postures:
            values = list(real_run.evaluations[number].assessment.design.values())
            tree = problem.space.resized(problem.scene.robot.tree, values)
            links = content.bodies.robot.links
            masses = {link.name: design.links.get(index, link).mass_kg for index, link in enumerate(links)}
            check_to_seven_digits(masses, {link.name: float(link.inertia.mass) for link in tree.links})


def test_unscaled_robot_and_the_best_of_each_objective_are_marked(real_run: RunLog, content: Content) -> None:
    marks = {mark.label: mark.number for mark in content.marks}
    assert marks["unscaled robot"] == 0
    objectives = {
        each.number: each.assessment.objectives
        for each in front(real_run.header.objectives, real_run.evaluations)
    }
    least = min(objectives.values(), key=lambda values: values["robot_torque"])
    assert objectives[marks["least robot torque"]] == least
    greatest = max(objectives.values(), key=lambda values: values["reach_height"])
    assert objectives[marks["greatest reach height"]] == greatest
    assert "knee" in marks
    signs = {each.name: -1.0 if each.sense is Sense.MAXIMISE else 1.0 for each in real_run.header.objectives}
    before = real_run.evaluations[0].assessment.objectives
    no_worse = [
        values
        for values in objectives.values()
        if all(sign * values[name] <= sign * before[name] for name, sign in signs.items())
    ]
    assert objectives[marks["least robot torque without loss"]] == min(
        no_worse, key=lambda values: values["robot_torque"]
    )


def test_asked_designs_are_marked(real_run: RunLog) -> None:
    assert (5, "asked") in {(mark.number, mark.kind) for mark in page_content(real_run, (5,)).marks}


def test_design_that_the_run_does_not_hold_is_refused(real_run: RunLog) -> None:
    with pytest.raises(InputError, match="12 evaluations, found 99"):
        page_content(real_run, (99,))


def test_what_is_left_out_is_said(
    real_run: RunLog, monkeypatch: pytest.MonkeyPatch, content: Content
) -> None:
    monkeypatch.setattr(postures, "MOST_NUMBERS", 1)
    bare = page_content(real_run)
    monkeypatch.setattr(gather, "MOST_POINTS", 9)
    small = page_content(real_run)
    frequent = tuple(each.sentence for each in frequent_limits(real_run))
    gained = gains(real_run)
    assert gained is not None
    assert content.notes == (gained.sentence, *frequent, *left_out(real_run.header.problem))
    assert any(note.startswith("no [collisions]") for note in content.notes)
    assert any(note.startswith("9 of 12 evaluations") for note in small.notes)
    assert any("postures of" in note for note in bare.notes)
    assert small.facts == content.facts, "the run's own figures count everything"


def test_heights_at_which_nobody_was_measured_are_said(real_run: RunLog) -> None:
    header, person = real_run.header, 'posture = "least_torque"'
    assert person in header.problem.text
    measured = msgspec.structs.replace(
        header.problem, text=header.problem.text.replace(person, 'posture = "measured"')
    )
    run = replace(real_run, header=msgspec.structs.replace(header, problem=measured))
    (note,) = (each for each in page_content(run).notes if "nobody was measured" in each)
    assert note.startswith("human: how measured people stand with the load at 0.8 m is an assumption")


def test_marked_designs_stay_then_the_front_then_the_feasible() -> None:
    evaluations = toy_evaluations(toy_header(), 40)
    bad = [evaluation.number for evaluation in evaluations if not evaluation.feasible]
    on_front = {each.number for each in front(toy_header().objectives, evaluations)}
    kept = {each.number for each in chosen_points(evaluations, on_front, bad[:1], len(on_front) + 3)}
    assert {bad[0], *on_front} <= kept
    assert len(kept) == len(on_front) + 3
    assert kept & set(bad) == {bad[0]}, "feasible designs come before others"


def test_names_are_text_and_come_back_as_they_were(real_run: RunLog, content: Content) -> None:
    named = msgspec.structs.replace(content, facts=msgspec.structs.replace(content.facts, problem=NAME))
    page = page_html(named)
    assert NAME not in page
    check_as_shown(embedded(page), named)


def test_page_asks_for_nothing(content: Content) -> None:
    page = page_html(content)
    unpacked = re.sub(r'(<script type="text/plain"[^>]*>)[^/]*(?=</script>)', r"\1", page)
    assert "{{" not in unpacked.split("<script>")[0], "every part of the template is filled"
    own = page[: page.index("<script>")] + page[page.index('id="content"') :]
    assert not re.search(r"<(link|script|img|iframe)[^>]+(src|href)=\"(?!data:)", own)
    assert not re.search(r"https?://", own.split("</script>", 1)[1])


@pytest.mark.parametrize("count", [0, 1, 30])
def test_problem_that_cannot_be_rebuilt_leaves_out_only_the_robot(tmp_path: Path, count: int) -> None:
    run = toy_run(tmp_path / "toy", count)
    made = page_content(run)
    assert made.bodies is None
    assert "no robot is drawn" in made.notes[0]
    assert len(made.points.number) == count
    assert json.loads(msgspec.json.encode(made))["facts"]["evaluations"] == count


def test_run_without_feasible_design_shows_the_nearest(tmp_path: Path) -> None:
    header = toy_header()
    with RunWriter(tmp_path / "bad", header) as log:
        for evaluation in toy_evaluations(header, 40):
            if not evaluation.feasible:
                log.write(evaluation)
    run = read_run(tmp_path / "bad")
    nearest = [mark.number for mark in page_content(run).marks if mark.kind == "near"]
    missed = {evaluation.number: evaluation.assessment.violation or 0.0 for evaluation in run.evaluations}
    assert nearest == sorted(missed, key=lambda number: missed[number])[:5]


@pytest.mark.parametrize("count", [1, 5])
def test_any_number_of_objectives(tmp_path: Path, count: int) -> None:
    more = tuple(Objective(name=f"more.{i}", sense=Sense.MINIMISE, unit="kg") for i in range(3))
    objectives = (*toy_header().objectives, *more)[:count]
    search = msgspec.structs.replace(toy_header().search, objectives=count)
    header = msgspec.structs.replace(toy_header(), objectives=objectives, search=search)
    names = {objective.name for objective in objectives}
    with RunWriter(tmp_path / "run", header) as log:
        for evaluation in toy_evaluations(header, 30):
            assessment = evaluation.assessment
            values = {one.name: evaluation.genome[0] + i for i, one in enumerate(more)}
            values = {
                name: value for name, value in (assessment.objectives | values).items() if name in names
            }
            assessment = msgspec.structs.replace(assessment, objectives=values)
            log.write(msgspec.structs.replace(evaluation, assessment=assessment))
    made = page_content(read_run(tmp_path / "run"))
    assert list(made.points.objectives) == [objective.name for objective in objectives]
    assert {"best"} <= {mark.kind for mark in made.marks}


def test_run_cut_by_a_crash_gives_a_page_with_a_note(tmp_path: Path, real_run: RunLog) -> None:
    log = (real_run.directory / "000.mcap").read_bytes()
    (tmp_path / "000.mcap").write_bytes(log[: len(log) * 2 // 3])
    made = page_content(read_run(tmp_path))
    assert 0 < len(made.points.number) < len(real_run.evaluations)
    assert "ends after" in made.notes[0]


def test_every_file_of_the_template_is_in_the_page(content: Content) -> None:
    page = page_html(content)
    for file in TEMPLATE.iterdir():
        text = file.read_text(encoding="utf-8")
        assert file.name == "page.html" or text in page, f"{file.name} is left out"


def test_scripts_read_no_column_that_the_page_lacks() -> None:
    scripts = [file.read_text(encoding="utf-8") for file in TEMPLATE.iterdir() if file.name.endswith(".js")]
    read = {name for script in scripts for name in re.findall(r"\bpoints\.(\w+)", script)}
    assert {"violation", "reason", "constraints"} <= read <= {*Points.__struct_fields__, "map"}
