"""The page in a real browser: it reports no error, asks for nothing, and its parts answer to each other."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.analysis.front import front
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.problem.build import DesignProblem
from evodesign.records import AgentDetail, Objective, Sense
from evodesign.report.page import page_content, page_html
from evodesign.report.page.bodies import agent_body
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.writer import RunWriter
from evodesign.tree.words import in_words
from tests.report.page.chromium import Tab, browser
from tests.report.page.reading import CANVAS, SHOWN_WITHIN, check_poses, open_page, shown_as
from tests.runlog.toys import toy_evaluations, toy_header
from tests.tree.crane import crane

pytestmark = [pytest.mark.needs_chromium, pytest.mark.slow]

PLOT = "document.getElementById('front')"
SHOWN = "document.getElementById('card-title').textContent"
NAME = "<script>alert(1)</script>"


def trace(tab: Tab, name: str) -> list[int]:
    """Numbers of the designs that a trace of the front draws."""
    drawn = tab.value(f"JSON.stringify({PLOT}.data.find(t => t.name === '{name}').customdata)")
    return list(json.loads(drawn))


def apart(number: int, spots: dict[int, tuple[float, float]]) -> float:
    """How far a design is drawn from the nearest other one."""
    return min(math.dist(spots[number], place) for other, place in spots.items() if other != number)


def spot(tab: Tab, number: int) -> tuple[float, float]:
    """Where in the window the front draws a design."""
    left, top, _, _ = tab.place(PLOT)
    x, y = tab.value(
        f"(() => {{ const p = {PLOT}, t = p.data.find(t => t.name === 'front'), l = p._fullLayout;"
        f"const i = t.customdata.indexOf({number});"
        "return [l.xaxis.d2p(t.x[i]) + l._size.l, l.yaxis.d2p(t.y[i]) + l._size.t]; })()"
    )
    return left + x, top + y


def front_of(run: RunLog) -> dict[int, Any]:
    return {each.number: each.assessment for each in front(run.header.objectives, run.evaluations)}


def test_front_draws_every_design_of_it_in_2d_and_3d(page: Tab, real_run: RunLog) -> None:
    assert trace(page, "front") == list(front_of(real_run))
    assert trace(page, "unscaled") == [0]
    page.value("document.getElementById('front-3D').click()")
    page.wait_for(f"{PLOT}.data[0].type === 'scatter3d'")
    assert trace(page, "front") == list(front_of(real_run))
    assert trace(page, "unscaled") == [0]


def test_brushing_a_parameter_changes_the_fronts_selection(page: Tab, real_run: RunLog) -> None:
    track = "document.querySelector('[data-axis=\"length.thigh\"] .track')"
    left, top, width, height = page.place(track)
    page.drag((left + 0.5 * width, top + height / 2), (left + 0.99 * width, top + height / 2))
    low, high = page.value("[...window.evodesign.state.brushes.values()][0]")
    assert low == pytest.approx(0.6 + 0.5 * 1.2, abs=0.01)
    inside = [n for n, found in front_of(real_run).items() if low <= found.design["length.thigh"] <= high]
    assert 0 < len(inside) < len(front_of(real_run))
    page.wait_for(f"{PLOT}.data.find(t => t.name === 'front').x.length === {len(inside)}")
    assert trace(page, "front") == inside
    assert f"{len(inside)} of {len(front_of(real_run))}" in page.value(
        "document.getElementById('brushed').textContent"
    )
    page.value("document.getElementById('clear').click()")
    assert trace(page, "front") == list(front_of(real_run))


def test_drawing_a_frame_into_the_front_selects_and_clearing_takes_it_away(
    page: Tab, real_run: RunLog
) -> None:
    page.value(f"Plotly.relayout({PLOT}, {{dragmode: 'select'}}).then(() => true)")
    x, y = spot(page, page.value("window.evodesign.state.selected"))
    page.drag((x - 25, y - 25), (x + 25, y + 25))
    page.wait_for("window.evodesign.state.lasso !== null")
    chosen = set(page.value("[...window.evodesign.state.lasso]"))
    inside = [number for number in front_of(real_run) if number in chosen]
    assert 0 < len(inside) < len(front_of(real_run))
    assert trace(page, "front") == inside
    page.value("document.getElementById('clear').click()")
    page.wait_for(f"!{PLOT}.layout.selections?.length")
    assert page.value("window.evodesign.state.lasso") is None
    assert trace(page, "front") == list(front_of(real_run))


def test_brush_moves_by_keyboard(page: Tab) -> None:
    page.value("document.querySelector('[data-axis=\"length.thigh\"] input').focus()")
    page.key("ArrowRight")
    low, high = page.value("[...window.evodesign.state.brushes.values()][0]")
    assert low == pytest.approx(0.6 + 1.2 / 1000)
    assert high == 1.8


def test_clicking_a_point_shows_its_card(page: Tab, real_run: RunLog) -> None:
    marked = page.value("window.evodesign.content.marks.map(mark => mark.number)")
    shown = page.value("window.evodesign.state.selected")
    spots = {number: spot(page, number) for number in front_of(real_run)}
    number = max(
        marked, key=lambda number: apart(number, spots) if number in spots and number != shown else -1.0
    )
    page.click(*spots[number])
    page.wait_for(f"{SHOWN} === 'Design {number}'")
    assert page.value("document.getElementById('announce').textContent") == f"Design {number} is shown."
    found = front_of(real_run)[number]
    for name, value in found.objectives.items():
        tile = f"document.querySelector('[data-objective=\"{name}\"]').firstChild.textContent"
        assert page.value(tile) == shown_as(value)
    for name, value in found.design.items():
        cell = f"document.querySelector('[data-parameter=\"{name}\"]').textContent"
        assert page.value(cell) == shown_as(value)


def test_every_point_of_the_front_shows_its_robot(page: Tab, real_run: RunLog) -> None:
    for number in front_of(real_run):
        page.value(f"window.evodesign.select({number})")
        page.wait_for(f"{SHOWN} === 'Design {number}'")
        page.wait_for(f"{CANVAS}.getAttribute('aria-label').startsWith('Design {number} and the person')")


def crowded_run(directory: Path) -> RunLog:
    """A front of which each design has a dominated one so near that both are one spot on the screen."""
    header = toy_header()
    feasible = [each for each in toy_evaluations(header, 60) if each.feasible]
    with RunWriter(directory, header) as log:
        for number, evaluation in enumerate(feasible):
            place, behind = divmod(number, 2)
            values = {"robot_torque": 30.0 + place**2, "reach_height": 1.0 + 0.1 * place}
            values["robot_torque"] += 1e-3 * behind
            found = msgspec.structs.replace(evaluation.assessment, objectives=values)
            log.write(msgspec.structs.replace(evaluation, number=number, assessment=found))
    return read_run(directory)


def test_a_click_on_a_marked_design_selects_it_whatever_lies_behind(chromium: Tab, tmp_path: Path) -> None:
    run = crowded_run(tmp_path / "run")
    open_run(chromium, run)
    assert set(front_of(run)) == {each.number for each in run.evaluations if each.number % 2 == 0}
    marked = dict.fromkeys(chromium.value("window.evodesign.content.marks.map(mark => mark.number)"))
    assert len(marked) >= 2
    for number in marked:
        chromium.value(f"window.evodesign.select({number + 1})")
        x, y = spot(chromium, number)
        chromium.mouse("mouseMoved", x, y, pressed=False)
        chromium.wait_for(f"{PLOT}.querySelector('.hovertext')?.textContent.startsWith('Design {number}')")
        chromium.click(x + 4, y)
        chromium.wait_for(f"{SHOWN} === 'Design {number}'")
    assert chromium.complaints() == []


def test_a_click_on_a_disc_of_the_front_selects_that_one_and_not_what_it_hides(
    chromium: Tab, tmp_path: Path
) -> None:
    run = crowded_run(tmp_path / "run")
    open_run(chromium, run)
    number = next(
        number
        for number in front_of(run)
        if number not in chromium.value("window.evodesign.content.marks.map(mark => mark.number)")
    )
    chromium.click(*spot(chromium, number))
    chromium.wait_for(f"{SHOWN} === 'Design {number}'")


def test_the_nearest_bodies_of_the_posture_that_is_shown_are_told(page: Tab) -> None:
    told = page.value(
        "(() => { const { content, state } = window.evodesign, design = content.designs[state.selected];"
        "const at = design.postures.findIndex(p => p.case.task.height_m === content.heights_m[state.height]);"
        "return design.clearances[at]; })()"
    )
    text = page.value("document.getElementById('nearest-bodies').textContent")
    for body in (told["first"], told["second"]):
        agent, link = body.split(" ", 1)
        assert f"{agent} {in_words(link)}" in text.lower()
    assert ("overlap by" if told["distance_m"] < -1e-4 else "apart") in text


def test_arrow_keys_walk_along_the_front(page: Tab, real_run: RunLog) -> None:
    before = page.value(SHOWN)
    page.value(f"{PLOT}.focus()")
    page.key("ArrowLeft")
    page.key("ArrowRight")
    page.key("ArrowRight")
    assert page.value(SHOWN) != before
    assert int(page.value(SHOWN).removeprefix("Design ")) in front_of(real_run)


def test_moving_the_height_slider_moves_the_posture(page: Tab, real_run: RunLog) -> None:
    number = page.value("window.evodesign.state.selected")
    before = page.value(f"{CANVAS}.toDataURL()")
    wrenches = page.value("document.querySelector('.wrenches').textContent")
    page.value("document.getElementById('height').focus()")
    page.key("ArrowRight")
    page.wait_for("document.querySelector('.height output').textContent === '1.2 m'")
    page.wait_for(f"{CANVAS}.toDataURL() !== {json.dumps(before)}")
    assert page.value("document.querySelector('.wrenches').textContent") != wrenches
    details = next(detail for detail in real_run.details if detail.evaluation == number)
    force = details.cases[2].agents[ROBOT].wrenches["left_foot"][2]
    cell = "document.querySelector('[data-agent=robot] tr:nth-child(2)').children[3].textContent"
    assert page.value(cell) == f"{force:.1f}"


def test_posture_comes_back_after_a_design_without_one(page: Tab, real_run: RunLog) -> None:
    first = page.value("window.evodesign.state.selected")
    drawn = page.value(f"{CANVAS}.toDataURL()")
    known = {detail.evaluation for detail in real_run.details}
    bare = next(evaluation.number for evaluation in real_run.evaluations if evaluation.number not in known)
    page.value(f"window.evodesign.select({bare})")
    assert page.value(SHOWN) == f"Design {bare}"
    assert page.value(f"{CANVAS} === null")
    page.value(f"window.evodesign.select({first})")
    page.wait_for(f"{CANVAS}.toDataURL() === {json.dumps(drawn)}")


def test_links_stand_where_our_kinematics_puts_them(
    page: Tab, problem: DesignProblem, real_run: RunLog
) -> None:
    detail = real_run.details[-1]
    values = list(real_run.evaluations[detail.evaluation].assessment.design.values())
    robot = problem.space.resized(problem.scene.robot.tree, values)
    for place, posture in enumerate(detail.cases):
        for name, tree, turn in ((ROBOT, robot, 0.0), (HUMAN, problem.scene.human.tree, math.pi)):
            script = (
                f"(() => {{ const e = window.evodesign, d = e.content.designs[{detail.evaluation}];"
                f"const posture = d.postures[{place}].instants[0].agents.{name};"
                f"return e.linkPoses('{name}', e.treeOf('{name}', d, ''), posture); }})()"
            )
            check_poses(page, script, tree, posture.agents[name], turn, within=SHOWN_WITHIN)


def test_slides_and_oblique_axes_move_as_in_our_kinematics(page: Tab, problem: DesignProblem) -> None:
    tree = crane()
    robot = problem.scene.robot
    frames = {"left_foot": "hook", "right_foot": "flag"}
    contacts = tuple(replace(foot, frame=frames[foot.name]) for foot in robot.feet)
    agent = replace(robot, tree=tree, contacts=contacts)
    posture = AgentDetail(
        base_position_m=(0.3, -0.2, 0.9),
        base_rpy_rad=(0.4, -0.7, 1.9),
        joints_rad={"swing": 0.8, "reach": 0.35, "twist": -2.9, "wave": 1.2},
        torques_n_m={},
        wrenches={},
    )
    given = [msgspec.json.encode(part).decode() for part in (agent_body(agent, {}), posture)]
    check_poses(page, f"window.evodesign.linkPoses('robot', {given[0]}, {given[1]})", tree, posture, 0.0)


def test_table_lists_the_front_as_the_log_has_it(page: Tab, real_run: RunLog) -> None:
    rows = page.value(
        "[...document.querySelectorAll('#table tbody tr')].map(r => [...r.children].map(c => c.textContent))"
    )
    found = front_of(real_run)
    assert sorted(int(row[0]) for row in rows) == list(found)
    for row in rows:
        assert row[1:4] == [shown_as(value) for value in found[int(row[0])].objectives.values()]
    page.value("document.querySelector('#table .open').click()")
    assert page.value(SHOWN) == f"Design {rows[0][0]}"


@pytest.mark.parametrize(("system", "other"), [("light", "dark"), ("dark", "light")])
def test_page_follows_the_system_until_told_otherwise(
    chromium: Tab, real_page: Path, system: str, other: str
) -> None:
    open_page(chromium, real_page, theme=system)
    theme = "document.documentElement.dataset.theme"
    assert chromium.value(theme) == system
    chromium.value("document.getElementById('theme').click()")
    assert chromium.value(theme) == other


def test_everything_that_can_be_operated_has_a_name(page: Tab) -> None:
    nameless = page.value(
        "[...document.querySelectorAll('button, input, select, canvas[role], .plot')].filter(e =>"
        "!(e.textContent.trim() || e.ariaLabel || e.labels?.length || e.getAttribute('aria-labelledby')))"
        ".map(e => e.outerHTML)"
    )
    assert nameless == []


def test_laptop_width_needs_no_sideways_scrolling(page: Tab) -> None:
    for width in (1280, 1024, 600):
        page.resize(width, 800)
        page.wait_for(f"document.documentElement.scrollWidth <= {width}")


def test_marks_of_a_design_keep_their_width_in_the_table_of_a_narrow_window(page: Tab) -> None:
    page.resize(420, 800)
    widths = "[...document.querySelectorAll('#table td.marked')].map(cell => cell.clientWidth)"
    page.wait_for(f"{widths}.length > 0 && Math.min(...{widths}) >= 200")
    page.resize(1280, 800)


def open_run(tab: Tab, run: RunLog) -> None:
    """Write and open the page of a run, which must report no error."""
    path = run.directory / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    tab.events.clear()
    open_page(tab, path)
    assert tab.complaints() == []
    assert tab.requests() == [path.as_uri()]


def toy_run(
    directory: Path, count: int, *, feasible: bool = True, objectives: int = 2, title: str = "toy"
) -> RunLog:
    more = tuple(Objective(name=f"{NAME}{i}", sense=Sense.MINIMISE, unit="kg") for i in range(3))
    parameters = tuple(
        msgspec.structs.replace(one, name=f"{one.name}.{title}") for one in toy_header().parameters
    )
    header = msgspec.structs.replace(
        toy_header(),
        problem_name=title,
        objectives=(*toy_header().objectives, *more)[:objectives],
        parameters=parameters,
        search=msgspec.structs.replace(toy_header().search, objectives=objectives),
    )
    names = {objective.name for objective in header.objectives}
    with RunWriter(directory, header) as log:
        for evaluation in toy_evaluations(header, count):
            if feasible or not evaluation.feasible:
                found = evaluation.assessment
                values = {one.name: (0.5 - evaluation.genome[i % 2]) ** 2 for i, one in enumerate(more)}
                values = {name: value for name, value in (found.objectives | values).items() if name in names}
                found = msgspec.structs.replace(found, objectives=values)
                log.write(msgspec.structs.replace(evaluation, assessment=found))
    return read_run(directory)


def test_empty_run_says_so(chromium: Tab, tmp_path: Path) -> None:
    open_run(chromium, toy_run(tmp_path / "run", 0))
    assert "holds no evaluation yet" in chromium.value("document.body.innerText")


def test_run_without_feasible_design_opens_the_nearest(chromium: Tab, tmp_path: Path) -> None:
    run = toy_run(tmp_path / "run", 40, feasible=False)
    open_run(chromium, run)
    text = chromium.value("document.body.innerText")
    assert "No design of this run is feasible" in text
    assert "Infeasible at every height" in text
    nearest = min(run.evaluations, key=lambda evaluation: evaluation.assessment.violation or 0.0)
    assert chromium.value(SHOWN) == f"Design {nearest.number}"


def test_one_objective_is_drawn_over_the_evaluations(chromium: Tab, tmp_path: Path) -> None:
    open_run(chromium, toy_run(tmp_path / "run", 40, objectives=1))
    assert chromium.value(f"{PLOT}.layout.xaxis.title.text") == "evaluation [number]"
    assert len(trace(chromium, "front")) == 1


def test_five_objectives_offer_any_three_as_axes(chromium: Tab, tmp_path: Path) -> None:
    run = toy_run(tmp_path / "run", 60, objectives=5)
    open_run(chromium, run)
    assert trace(chromium, "front") == list(front_of(run))
    assert chromium.value("document.querySelectorAll('#axis-across [label=Results] option').length") == 5


def test_names_are_shown_as_text(chromium: Tab, tmp_path: Path) -> None:
    open_run(chromium, toy_run(tmp_path / "run", 40, objectives=5, title=NAME))
    assert chromium.value("document.getElementById('title').textContent") == NAME
    assert chromium.value("document.title").startswith(NAME)
    assert NAME + "0" in chromium.value("document.getElementById('table').textContent")
    assert chromium.value("document.querySelectorAll('script').length") == 3
    assert not [event for event in chromium.events if event["method"] == "Page.javascriptDialogOpening"]


def test_run_cut_by_a_crash_shows_what_is_there_with_a_note(
    chromium: Tab, tmp_path: Path, real_run: RunLog
) -> None:
    log = (real_run.directory / "000.mcap").read_bytes()
    (tmp_path / "000.mcap").write_bytes(log[: len(log) * 2 // 3])
    open_run(chromium, read_run(tmp_path))
    assert "ends after" in chromium.value("document.getElementById('notes').innerText")
    assert chromium.value("document.getElementById('card-title') !== null")


def test_browser_without_webgl_says_what_it_cannot_draw(
    real_page: Path, tmp_path: Path, real_run: RunLog
) -> None:
    with browser(tmp_path / "chromium", "--disable-3d-apis") as tab:
        open_page(tab, real_page)
        assert "offers no WebGL" in tab.value("document.getElementById('card').innerText")
        assert tab.value("document.getElementById('front-3D').disabled")
        assert trace(tab, "front") == list(front_of(real_run))
        assert tab.complaints() == []
