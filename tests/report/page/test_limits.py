"""The card's active limits are those of the log, posture by posture."""

from __future__ import annotations

import json
import re
from typing import Any

import msgspec
import pytest

from evodesign.analysis.active_limits import frequent_limits
from evodesign.records import CaseDetail
from evodesign.report.page import page_content
from evodesign.runlog.run import RunLog
from evodesign.tree.words import in_words
from tests.report.page.chromium import Tab

pytestmark = pytest.mark.slow

MINUS = "\N{MINUS SIGN}"

ROWS = """JSON.stringify([...document.querySelectorAll('[data-limit]')].map(row =>
    [row.dataset.limit, ...[...row.children].map(cell => cell.textContent)]))"""


def shown_case(page: Tab) -> dict[str, Any]:
    """The postures of the case that is shown, from the page's content."""
    return dict(
        page.value(
            "(() => { const { content, state } = window.evodesign, d = content.designs[state.selected];"
            "return d.postures.find(p => p.case.task.height_m === content.heights_m[state.height]); })()"
        )
    )


@pytest.mark.needs_chromium
def test_the_card_lists_the_limits_of_the_posture_that_is_shown(page: Tab, real_run: RunLog) -> None:
    rows = json.loads(page.value(ROWS))
    detail = msgspec.convert(shown_case(page), CaseDetail)
    assert [row[0] for row in rows] == [limit.name for limit in detail.limits]
    assert rows
    for (_, words, whose, price, step), limit in zip(rows, detail.limits, strict=True):
        told = msgspec.structs.replace(limit, part=re.sub(r"\w+", lambda one: in_words(one[0]), limit.part))
        assert words.replace(MINUS, "-").lower() == told.words.lower()
        assert whose == {"robot": "Robot", "human": "Person", "": "Both"}[limit.agent]
        assert float(price.replace(MINUS, "-")) == pytest.approx(limit.change_n_m, rel=0.01)
        assert step == limit.step[1]
    number = page.value("window.evodesign.state.selected")
    (logged,) = (each for each in real_run.details if each.evaluation == number)
    own = next(case for case in logged.cases if case.case == detail.case)
    assert [limit.identity for limit in own.limits] == [limit.identity for limit in detail.limits]


def test_notes_name_the_limits_that_hold_most_of_the_front(real_run: RunLog) -> None:
    often = [each.sentence for each in frequent_limits(real_run)]
    assert often
    assert set(often) <= set(page_content(real_run).notes)
