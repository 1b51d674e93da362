"""What a reader does with the page: compare designs, choose axes, keep a link, take files, on any screen."""

from __future__ import annotations

import base64
import csv
import io
import json
import re
from pathlib import Path

import pytest
from mcap.reader import make_reader

from evodesign.analysis.front import front
from evodesign.evaluation.progress import SILENT
from evodesign.problem.build import DesignProblem
from evodesign.report.export.design import postures_csv
from evodesign.report.opened_design import open_design
from evodesign.runlog.run import RunLog
from evodesign.tree.urdf_write import urdf_text
from tests.report.page.chromium import Tab
from tests.report.page.reading import shown_as

pytestmark = [pytest.mark.needs_chromium, pytest.mark.slow]

PLOT = "document.getElementById('front')"
TITLE = "document.getElementById('card-title').textContent"
SHEET = """(() => { const b = document.getElementById('card'), box = b.getBoundingClientRect();
    return b.checkVisibility({ visibilityProperty: true }) && box.top < innerHeight - 100; })()"""
SELECTED = "window.evodesign.state.selected"


def choose(tab: Tab, key: str, name: str) -> None:
    """Choose the quantity of an axis of the front."""
    tab.value(
        f"(() => {{ const s = document.getElementById('axis-{key}');"
        f"s.value = [...s.options].find(o => o.textContent === '{name}').value;"
        "s.dispatchEvent(new Event('change')); })()"
    )


def two_with_postures(run: RunLog) -> tuple[int, int]:
    """Two designs whose postures are in the page."""
    on_front = {each.number for each in front(run.header.objectives, run.evaluations)}
    first, second, *_ = [d.evaluation for d in run.details if d.evaluation in on_front]
    return first, second


def test_two_designs_stand_side_by_side(page: Tab, real_run: RunLog) -> None:
    first, second = two_with_postures(real_run)
    page.value(f"window.evodesign.select({first})")
    page.value("document.getElementById('put-beside').click()")
    page.value(f"window.evodesign.select({second})")
    assert page.value("document.getElementById('beside-title').textContent") == (
        f"Design {first} beside design {second}"
    )
    seen = page.value(
        "['front', 'beside-title', 'posture-beside', 'posture'].map(id => document.getElementById(id))"
        ".map(e => (b => [b.top, b.bottom])(e.getBoundingClientRect()))"
    )
    assert max(top for top, _ in seen) - min(top for top, _ in seen) < 900, "front and postures in one window"
    worth = {each.number: each.assessment for each in real_run.evaluations}
    for name in [*worth[first].objectives, *worth[first].design]:
        cells = page.value(
            f"[...document.querySelector('[data-beside=\"{name}\"]').children].map(c => c.textContent)"
        )
        known = [{**worth[n].objectives, **worth[n].design}[name] for n in (first, second)]
        assert cells[1:3] == [shown_as(value) for value in known]
    most = {
        detail.evaluation: max(abs(case.agents["robot"].torques_n_m["l_knee"]) for case in detail.cases)
        for detail in real_run.details
    }
    knee = page.value(
        "[...document.querySelector('#beside-torques [data-beside=l_knee]').children].map(c => c.textContent)"
    )
    assert [float(cell) for cell in knee[1:3]] == pytest.approx([most[first], most[second]], rel=1e-3)
    assert page.value("document.querySelector('[data-beside=\"whole robot\"]') !== null")
    drawn = page.value("[...document.querySelectorAll('.stage canvas')].map(c => c.toDataURL())")
    assert len(set(drawn)) == 2
    page.value("window.evodesign.look(0.3, 0.4)")
    turned = page.value("[...document.querySelectorAll('.stage canvas')].map(c => c.toDataURL())")
    assert len({*drawn, *turned}) == 4
    page.value("document.getElementById('close-beside').click()")
    assert page.value("document.getElementById('beside') === null")
    assert page.value("document.getElementById('posture-beside').offsetParent === null")


def test_parameters_can_be_axes_and_colours(page: Tab, real_run: RunLog) -> None:
    choose(page, "across", "length thigh")
    choose(page, "colour", "density shank")
    drawn = json.loads(
        page.value(
            "JSON.stringify((t => [t.customdata, t.x, t.marker.color])"
            f"({PLOT}.data.find(t => t.name === 'front')))"
        )
    )
    designs = {each.number: each.assessment.design for each in real_run.evaluations}
    assert len(drawn[0]) > 1
    for column, name in ((drawn[1], "length.thigh"), (drawn[2], "density.shank")):
        assert column == pytest.approx([designs[number][name] for number in drawn[0]], rel=5e-7)


def test_what_lies_outside_the_axes_is_counted_until_all_is_shown(page: Tab, real_run: RunLog) -> None:
    told = "document.getElementById('outside').textContent"
    assert "of the front" not in page.value(told), "axes hold all of the front"
    page.value("document.getElementById('show-all').click()")
    assert page.value(told) == ""
    low = page.value(f"{PLOT}._fullLayout.yaxis.range[0]")
    name = page.value("document.getElementById('axis-up').selectedOptions[0].textContent").replace(" ", "_")
    values = [e.assessment.objectives[name] for e in front(real_run.header.objectives, real_run.evaluations)]
    middle = sorted(values)[len(values) // 2]
    page.value(f"Plotly.relayout({PLOT}, {{'yaxis.range': [{low}, {middle * (1 + 1e-6)}]}}).then(() => true)")
    beyond = sum(value > middle for value in values)
    assert beyond > 0
    assert f"{beyond} of the front" in page.value(told)
    page.value("document.getElementById('show-all').click()")
    assert page.value(told) == ""
    assert page.value(f"{PLOT}._fullLayout.yaxis.range[1]") >= max(values)


def test_a_link_brings_back_what_was_seen(page: Tab, real_page: Path, real_run: RunLog) -> None:
    first, second = two_with_postures(real_run)
    page.value(f"window.evodesign.select({first})")
    page.value("document.getElementById('put-beside').click()")
    page.value(f"window.evodesign.select({second})")
    choose(page, "across", "length thigh")
    page.value("window.evodesign.brush(3, [0.7, 1.7])")
    page.value("window.evodesign.showCase(0, 0, 2)")
    page.value("window.evodesign.look(0.5, 0.25, 4)")
    page.wait_for("location.hash === '#' + window.evodesign.linkText()")
    link = page.value("location.href")
    picture = "document.getElementById('posture').toDataURL()"
    page.value("new Promise(resolve => setTimeout(() => resolve(true), 500))")  # the posture stands still
    drawn = page.value(picture)
    page.call("Page.navigate", url="about:blank")
    page.events.clear()
    page.open(link)
    page.wait_for("window.evodesign !== undefined")
    assert page.value(SELECTED) == second
    assert page.value("window.evodesign.state.beside") == first
    assert page.value("window.evodesign.state.height") == 2
    assert page.value("[...window.evodesign.state.brushes]") == [[3, [0.7, 1.7]]]
    camera = page.value("window.evodesign.camera")
    assert camera == {"turn": 0.5, "tilt": 0.25, "distance": 4}
    across = page.value("document.getElementById('axis-across').selectedOptions[0].textContent")
    assert across == "length thigh"
    assert page.value(picture) == drawn
    page.value(f"location.hash = 'design={first}&beside=99999&height=7'")
    page.wait_for(f"{SELECTED} === {first}")
    assert page.value("window.evodesign.state.beside") is None
    page.events.clear()
    page.call("Page.navigate", url="about:blank")
    page.open(real_page.as_uri())
    page.events[:] = [e for e in page.events if "about:blank" not in json.dumps(e)]


def saved(tab: Tab, button: str) -> bytes:
    """What a button of the card saves."""
    letters = tab.value(
        "new Promise(resolve => { const make = URL.createObjectURL; URL.createObjectURL = (blob) => {"
        "URL.createObjectURL = make; const r = new FileReader();"
        "r.onload = () => resolve(r.result.split(',')[1]); r.readAsDataURL(blob); return 'data:,'; };"
        "HTMLAnchorElement.prototype.click = () => {};"
        f"document.getElementById('save-{button}').click(); }})"
    )
    return base64.b64decode(letters)


def test_the_card_saves_csv_urdf_and_replay(page: Tab, problem: DesignProblem, real_run: RunLog) -> None:
    known = {detail.evaluation for detail in real_run.details}
    number = next(n for n in page.value("window.evodesign.content.marks.map(m => m.number)") if n in known)
    page.value(f"window.evodesign.select({number})")
    design = open_design(real_run, number, 1, SILENT)
    robot = design.scene_set().robot
    number_or_text = re.compile(r"(-?\d+\.\d+(?:e-?\d+)?)")
    mine, theirs = (number_or_text.split(text) for text in (saved(page, "urdf").decode(), urdf_text(robot)))
    assert mine[::2] == theirs[::2]
    assert [float(each) for each in mine[1::2]] == pytest.approx(
        [float(each) for each in theirs[1::2]], rel=2e-4, abs=1e-6
    )
    rows = list(csv.reader(io.StringIO(saved(page, "csv").decode())))
    values = {row[1]: float(row[2]) for row in rows[1:]}
    logged = {**design.evaluation.assessment.objectives, **design.evaluation.assessment.design}
    assert values == pytest.approx(logged, rel=5e-7)
    exported = list(csv.reader(io.StringIO(postures_csv(design.scene_set(), design.cases))))
    shown = list(csv.reader(io.StringIO(saved(page, "postures").decode())))
    assert len(shown) == len(exported)
    for mine, theirs in zip(shown, exported, strict=True):
        for one, other in zip(mine, theirs, strict=True):
            assert one == other or float(one) == pytest.approx(float(other), rel=1e-3, abs=0.02)
    reader = make_reader(io.BytesIO(saved(page, "replay")))
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count > len(design.cases)
    assert [attachment.name for attachment in reader.iter_attachments()] == ["robot.urdf"]
    unmarked = next(
        n for n in known if n not in page.value("window.evodesign.content.marks.map(m => m.number)")
    )
    page.value(f"window.evodesign.select({unmarked})")
    assert "evodesign export RUN" in page.value("document.querySelector('.downloads').textContent")


def test_arrow_keys_walk_on_after_a_click(page: Tab) -> None:
    page.value("document.getElementById('height').focus()")
    number = page.value(SELECTED)
    left, top, _, _ = page.place(PLOT)
    x, y = page.value(
        f"(() => {{ const p = {PLOT}, t = p.data.find(t => t.name === 'front'), l = p._fullLayout;"
        f"const i = t.customdata.indexOf({number});"
        "return [l.xaxis.d2p(t.x[i]) + l._size.l, l.yaxis.d2p(t.y[i]) + l._size.t]; })()"
    )
    page.click(left + x, top + y)
    page.wait_for(f"document.activeElement === {PLOT}")
    walked = {page.value(SELECTED)}
    for key in ("ArrowLeft", "ArrowRight", "ArrowRight"):
        page.key(key)
        walked.add(page.value(SELECTED))
    assert len(walked) > 1
    page.value("document.querySelector('.chip').click()")
    page.value("document.querySelector('.chip').focus()")
    before = page.value(SELECTED)
    page.key("ArrowRight")
    page.key("ArrowLeft")
    page.key("ArrowLeft")
    assert page.value(SELECTED) != before


def test_a_clicked_design_is_seen_at_once_on_a_small_laptop(page: Tab) -> None:
    page.resize(1024, 768)
    page.wait_for("document.documentElement.scrollWidth <= 1024")
    page.place(PLOT)
    card, stage = page.value(
        "[document.getElementById('card-title'), document.getElementById('posture')]"
        ".map(e => (b => [b.top, b.bottom, b.left, b.right])(e.getBoundingClientRect()))"
    )
    for top, bottom, left, right in (card, stage):
        assert min(top, left) >= 0
        assert bottom <= 768
        assert right <= 1024


def test_a_tap_on_a_phone_opens_the_card_as_a_sheet_that_closes_again(page: Tab) -> None:
    page.resize(390, 844)
    page.wait_for("document.documentElement.scrollWidth <= 390")
    page.wait_for(f"{PLOT}._fullLayout.width < 390")
    before = page.value(SELECTED)
    assert not page.value(SHEET), "the card is out of sight until it is asked for"
    left, top, _, _ = page.place(PLOT)
    x, y = page.value(  # the place of another design of the front
        f"(() => {{ const t = {PLOT}.data.find(t => t.name === 'front'), l = {PLOT}._fullLayout;"
        f"const i = t.customdata.findIndex(number => number !== {before});"
        "return [l.xaxis.d2p(t.x[i]) + l._size.l, l.yaxis.d2p(t.y[i]) + l._size.t]; })()"
    )
    scrolled = page.value("scrollY")
    page.call("Emulation.setTouchEmulationEnabled", enabled=True)
    page.call("Input.synthesizeTapGesture", x=left + x, y=top + y, gestureSourceType="touch")
    page.call("Emulation.setTouchEmulationEnabled", enabled=False)
    page.wait_for(f"{SELECTED} !== {before}")
    page.wait_for(SHEET)
    assert page.value("document.activeElement.id") == "card"
    page.key("Escape")
    page.wait_for(f"!{SHEET}")
    bar = "document.getElementById('open-card')"
    page.value(f"{bar}.click()")
    page.wait_for(SHEET)
    assert page.value(f"{bar}.ariaExpanded") == "true"
    page.value(f"{bar}.click()")
    page.wait_for(f"!{SHEET}")
    assert page.value("scrollY") == scrolled, "the reader is where the card was opened"
    page.resize(1440, 900)
    page.wait_for(SHEET)
    assert page.value(f"getComputedStyle({bar}).display") == "none", (
        "a wide page has its card beside the front"
    )


READABLE = """(() => {
  const seen = (one) => one.checkVisibility() && one.textContent.trim();
  const labels = [...document.querySelectorAll('.xtick text, .ytick text, .reach text')].filter(seen)
    .map((one) => [one.closest('g[class*=axislayer], svg'), one.getBoundingClientRect(), one.textContent]);
  const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1
    && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
  const over = labels.filter(([group, box], i) =>
    labels.some(([other, next], j) => i < j && group === other && meet(box, next)));
  const own = (one) => [...one.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  const size = (one) => {
    const { a, b } = one.getCTM?.() ?? { a: 1, b: 0 };
    return parseFloat(getComputedStyle(one).fontSize) * Math.hypot(a, b);
  };
  const small = [...document.querySelectorAll('body *')]
    .filter((one) => seen(one) && own(one) && !one.closest('script, noscript, .unseen') && size(one) < 11);
  return [labels.length, over.map(([, , text]) => text), small.map((one) => one.outerHTML.slice(0, 90))];
})()"""


def test_every_label_has_11_pixels_and_none_lies_over_another(page: Tab) -> None:
    page.value("document.querySelector('#families-section summary').click()")
    page.value("document.querySelectorAll('input[name=torques]')[1].click()")
    for width in (1440, 1024, 390):
        page.resize(width, 844)
        page.wait_for(f"{PLOT}._fullLayout.width < {width}")
        if not page.value(SHEET):
            page.value("document.getElementById('open-card').click()")
        page.value("new Promise(resolve => setTimeout(() => resolve(true), 400))")  # plots follow the width
        labels, over, small = page.value(READABLE)
        assert labels > 20, width
        assert (over, small) == ([], []), width


def test_on_a_phone_nothing_is_wider_than_the_page_and_axes_have_room(page: Tab, real_run: RunLog) -> None:
    first, second = two_with_postures(real_run)
    page.value(f"window.evodesign.select({first}); document.getElementById('put-beside').click();")
    page.value(f"window.evodesign.select({second})")
    page.resize(390, 844)
    page.wait_for("document.documentElement.scrollWidth <= 390")
    page.wait_for("document.getElementById('lines').clientWidth > 300")
    cut = page.value(
        "[...document.querySelectorAll('.axis .name, .axis .range')]"
        ".filter(e => e.scrollWidth > e.clientWidth).map(e => e.textContent)"
    )
    assert cut == []
    page.wait_for(
        "(() => { const l = document.getElementById('lines').getBoundingClientRect();"
        "const t = [...document.querySelectorAll('.track')].at(-1).getBoundingClientRect();"
        "return Math.abs(l.bottom - t.bottom) < 2 && Math.abs(l.left - t.left) < 2; })()"
    )


INKS = """(name) => {
  [...document.querySelectorAll('.views button')].find((one) => one.textContent === name).click();
  const canvas = document.getElementById('posture'), copy = document.createElement('canvas');
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const pen = copy.getContext('2d');
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(0, 0, copy.width, copy.height);
  let [robot, person] = [0, 0];
  for (let at = 0; at < data.length; at += 4) {
    const [red, green, blue, opaque] = data.slice(at, at + 4);
    if (opaque < 250) continue;
    if (blue > red + 60 && blue > green) robot += 1;
    if (red > blue + 60) person += 1;
  }
  return [robot, person];
}"""


def test_from_the_front_whoever_stands_before_the_camera_is_seen_through(page: Tab) -> None:
    names = page.value("[...document.querySelectorAll('.views button')].map(one => one.textContent)")
    assert names == ["Oblique", "Side", "Robot's front", "Person's front"]
    inks = {name: page.value(f"({INKS})({json.dumps(name)})") for name in names}
    for name in ("Oblique", "Side"):
        assert min(inks[name]) > 500, "both are seen"
    assert inks["Robot's front"][1] == 0 < inks["Robot's front"][0] > 500
    assert inks["Person's front"][0] == 0 < inks["Person's front"][1] > 500
