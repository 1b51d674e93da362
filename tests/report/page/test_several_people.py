"""The page of a run with several people and loads, in a real browser."""

from __future__ import annotations

import json
import math
import statistics
from collections.abc import Iterator

import pytest

from evodesign.human.body import human_tree
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.problem.build import DesignProblem
from evodesign.report.page import page_content, page_html
from evodesign.report.page.card import over_people
from evodesign.runlog.run import RunLog
from tests.report.page.chromium import Tab
from tests.report.page.reading import CANVAS, SHOWN_WITHIN, check_poses, open_page, shown_as
from tests.report.several import CASES, HEIGHTS, LOADS, PEOPLE, problem_of_several, write_several

pytestmark = [pytest.mark.needs_chromium, pytest.mark.slow]


@pytest.fixture(scope="module")
def run(problem: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    return write_several(problem_of_several(problem), tmp_path_factory.mktemp("several") / "run")


@pytest.fixture(scope="module")
def page(chromium: Tab, run: RunLog) -> Iterator[Tab]:
    path = run.directory / "report.html"
    path.write_text(page_html(page_content(run)), encoding="utf-8")
    open_page(chromium, path)
    yield chromium
    assert chromium.complaints() == []
    assert chromium.requests() == [path.as_uri()]


def choose(tab: Tab, control: str, option: int) -> None:
    """Choose an option as a reader does."""
    script = f"const s = document.getElementById('{control}'); s.value = {option};"
    tab.value(f"(() => {{ {script} s.dispatchEvent(new Event('change')); }})()")


def test_links_of_each_case_stand_where_that_persons_kinematics_puts_them(page: Tab, run: RunLog) -> None:
    for place, (human, _, _) in enumerate(CASES):
        script = (
            f"(() => {{ const e = window.evodesign, d = e.content.designs[1], posture = d.postures[{place}];"
            "const tree = e.treeOf('human', d, posture.case.person);"
            "return e.linkPoses('human', tree, posture.instants[0].agents.human); })()"
        )
        posture = run.details[1].cases[place].agents[HUMAN]
        check_poses(page, script, human_tree(PEOPLE[human]), posture, math.pi, within=SHOWN_WITHIN)


def test_choosing_person_load_and_height_shows_that_case(page: Tab, run: RunLog) -> None:
    number = page.value("window.evodesign.state.selected")
    pictures = set()
    for place, (human, payload, height) in enumerate(CASES):
        choose(page, "person", [*PEOPLE].index(human))
        choose(page, "payload", [*LOADS].index(payload))
        slider = "document.getElementById('height')"
        index = HEIGHTS.index(height)
        page.value(f"(() => {{ {slider}.value = {index}; {slider}.dispatchEvent(new Event('input')); }})()")
        detail = run.details[number].cases[place]
        outcome = run.evaluations[number].assessment.cases[place]
        assert outcome.robot_torque_norm is not None
        text = page.value("document.getElementById('height-detail').textContent")
        assert f"robot |torque| {shown_as(outcome.robot_torque_norm)} N m" in text
        cell = "document.querySelector('[data-agent=robot] tr:nth-child(2)').children[1].textContent"
        force = detail.agents[ROBOT].wrenches["left_foot"][0]
        assert page.value(cell) == f"{force:.1f}".replace("-", "\u2212")
        label = f"{human}, {payload}, {height:.1f} m"
        page.wait_for(f"{CANVAS}.getAttribute('aria-label').includes({json.dumps(label)})")
        pressed = "document.querySelector('.cases [aria-pressed=true]').title"
        assert page.value(pressed) == label
        torques = page.value("document.querySelectorAll('.joint-plot')[0].data[0].y")
        pair = [one for one in run.details[number].cases if one.case.pair == (human, payload)]
        sizes = [abs(torque) for one in pair for torque in one.agents[ROBOT].torques_n_m.values()]
        assert torques == pytest.approx(sizes, abs=max(sizes) / 4000)
        pictures.add(label)
    assert len(pictures) == len(CASES)


def test_a_click_on_a_case_shows_it_and_its_number_is_the_logs(page: Tab, run: RunLog) -> None:
    number = page.value("window.evodesign.state.selected")
    outcomes = run.evaluations[number].assessment.cases
    page.value("document.querySelectorAll('input[name=cases]')[1].click()")
    shown = page.value("[...document.querySelectorAll('.cases button')].map(b => [b.title, b.textContent])")
    for (title, text), (human, payload, height), outcome in zip(shown, CASES, outcomes, strict=True):
        assert title == f"{human}, {payload}, {height:.1f} m"
        assert float(text) == pytest.approx(outcome.human_torque_norm, rel=5e-3)
    page.value("document.querySelectorAll('.cases button')[0].click()")
    case = page.value("window.evodesign.shownCase()")
    assert (case["person"], case["payload"], case["height"]) == CASES[0]
    assert page.value("document.getElementById('person').value") == "0"


def test_controls_of_people_and_loads_have_names(page: Tab) -> None:
    for control, name in (("person", "Person"), ("payload", "Load")):
        label = f"document.getElementById('{control}').labels[0].firstChild.textContent"
        assert page.value(label) == name
    options = page.value("[...document.querySelectorAll('#person option')].map(o => o.textContent)")
    assert options == [*PEOPLE]


def test_the_chosen_design_tells_how_torques_spread_over_people(page: Tab, run: RunLog) -> None:
    number = page.value("window.evodesign.state.selected")
    cases = run.evaluations[number].assessment.cases
    for role in ("robot", "human"):
        norms = [
            [getattr(one, f"{role}_torque_norm") for one in cases if one.case.person == person]
            for person in PEOPLE
        ]
        short, tall = (sum(each) / len(each) for each in norms)
        mean, deviation = (short + tall) / 2, abs(tall - short) / math.sqrt(2)
        text = page.value(f"document.querySelector('[data-spread={role}_torque]').textContent")
        told = [float(part) for part in text.removeprefix("people ").split(" ± ")]
        assert told == pytest.approx([mean, deviation], rel=0.05)
    bars = page.value(
        "(t => [t.x, t.error_x.array, t.y, t.error_y.array].flat())"
        "(document.getElementById('front').data.find(t => t.name === 'people'))"
    )
    assert bars[2:] == pytest.approx([mean, deviation], rel=1e-6)


def test_quantiles_and_largest_torques_spread_as_they_are_defined(run: RunLog) -> None:
    cases = run.evaluations[0].assessment.cases
    names = ["worst_robot_torque", "q50_human_torque", "reach_height", "robot_torque"]
    found = over_people(names, cases)
    assert [*found] == ["worst_robot_torque", "q50_human_torque", "robot_torque"]
    largest = [max(one.robot_torque_norm for one in cases if one.case.person == p) for p in PEOPLE]
    assert found["worst_robot_torque"][0] == pytest.approx(sum(largest) / 2)
    middle = [
        statistics.median(one.human_torque_norm for one in cases if one.case.person == p) for p in PEOPLE
    ]
    assert found["q50_human_torque"][1] == pytest.approx(abs(middle[0] - middle[1]) / math.sqrt(2))
    alone = [one for one in cases if one.case.person == "tall"]
    assert over_people(names, alone) == {}, "one person does not spread"
