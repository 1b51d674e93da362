"""What the card says of the person's back and effort is what the postures ask, beside NIOSH's limit."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib import resources
from pathlib import Path

import msgspec
import pytest

from evodesign.human.back import ACTION_LIMIT
from evodesign.mechanics.agent import HUMAN
from evodesign.problem.build import DesignProblem
from evodesign.quantities.ergonomics import ergonomics
from evodesign.report.page import page_content, page_html
from evodesign.runlog.run import RunLog
from tests.report.page.chromium import Tab, browser
from tests.report.page.reading import open_page

pytestmark = pytest.mark.slow

ROWS = """JSON.stringify([...document.querySelectorAll('[data-effort]')].map(row =>
    [row.dataset.effort, row.lastChild.textContent, row.lastChild.className]))"""


CHOOSE = """(() => { const choice = document.getElementById('axis-up');
    choice.value = [...choice.options].find(one => /back.compression/.test(one.text)).value;
    choice.dispatchEvent(new Event('change')); return true; })()"""


def test_the_page_holds_what_the_postures_ask(real_run: RunLog, problem: DesignProblem) -> None:
    content = page_content(real_run)
    shown = [detail for detail in real_run.details if detail.evaluation in content.designs]
    assert shown
    for detail in shown:
        for told, case in zip(content.designs[detail.evaluation].efforts, detail.cases, strict=True):
            asked = ergonomics(problem.scene.human, case.hardest.agents[HUMAN])
            assert told.back_n == round(asked.back.compression)
            assert told.shear_n == round(asked.back.shear)
            assert told.back_limit_n == ACTION_LIMIT
            assert told.load_n_m == pytest.approx(asked.load_torque, abs=0.051)
            assert (told.rula, told.reba) == (asked.rula.whole, asked.reba.whole)
            assert (told.tires, told.longer) == (asked.endurance.joint.joint, not asked.endurance.measured)


def test_the_line_on_the_front_is_at_the_limit() -> None:
    script = resources.files("evodesign.report.page").joinpath("template", "front.js").read_text("utf-8")
    assert f"const BACK_LIMIT = {ACTION_LIMIT:g};" in script


@pytest.mark.needs_chromium
def test_the_front_has_a_line_at_the_limit_where_the_back_is_an_axis(
    real_run: RunLog, tmp_path: Path
) -> None:
    """The person's torque of a run, called the back's compression."""
    old, new = "human_torque", "worst_back_compression"
    objectives = tuple(
        msgspec.structs.replace(each, name=new, unit="N") if each.name == old else each
        for each in real_run.header.objectives
    )
    evaluations = tuple(
        msgspec.structs.replace(
            each,
            assessment=msgspec.structs.replace(
                each.assessment,
                objectives={new if k == old else k: v for k, v in each.assessment.objectives.items()},
            ),
        )
        for each in real_run.evaluations
    )
    header = msgspec.structs.replace(real_run.header, objectives=objectives)
    path = tmp_path / "report.html"
    path.write_text(
        page_html(page_content(replace(real_run, header=header, evaluations=evaluations))), "utf-8"
    )
    with browser(tmp_path / "chromium") as tab:
        open_page(tab, path)
        tab.value(CHOOSE)
        lines = json.loads(tab.value("JSON.stringify(document.getElementById('front').layout.shapes)"))
    assert [(line["y0"], line["y1"]) for line in lines] == [(ACTION_LIMIT, ACTION_LIMIT)]


@pytest.mark.needs_chromium
def test_the_card_names_the_limit_of_the_back(page: Tab) -> None:
    rows = {name: (text, look) for name, text, look in json.loads(page.value(ROWS))}
    assert list(rows) == [
        "Compression of L5/S1",
        "Shear of L5/S1",
        "Torques that the load adds",
        "Can be held",
        "RULA (1 to 7)",
        "REBA (1 to 15)",
    ]
    text, look = rows["Compression of L5/S1"]
    assert text.endswith("below NIOSH's limit of 3.4 kN")
    assert look == ""
