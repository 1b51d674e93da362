"""What the card says of the person's back and effort is what the postures ask, beside NIOSH's limit."""

from __future__ import annotations

import json

import pytest

from evodesign.human.back import ACTION_LIMIT
from evodesign.mechanics.scene import HUMAN
from evodesign.problem.build import DesignProblem
from evodesign.problem.ergonomics import ergonomics
from evodesign.report.page import page_content
from evodesign.runlog.run import RunLog
from tests.report.page.chromium import Tab

ROWS = """JSON.stringify([...document.querySelectorAll('[data-effort]')].map(row =>
    [row.dataset.effort, row.lastChild.textContent, row.lastChild.className]))"""


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
