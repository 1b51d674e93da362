"""The card says in which direction a push margin is least, and what a larger push does there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from evodesign.records import WeakestPush
from evodesign.report.page import page_content, page_html
from evodesign.runlog.run import RunLog, read_run
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page

GOLDEN = Path(__file__).parents[2] / "golden" / "lifting" / "format-2"
LINES = "JSON.stringify([...document.querySelectorAll('[data-weakest]')].map(one => one.textContent))"


def weakest_in(run: RunLog, name: str, weakest: WeakestPush) -> RunLog:
    """The run, as if an objective were a push margin."""
    changed = [
        msgspec.structs.replace(
            each, assessment=msgspec.structs.replace(each.assessment, weakest={name: weakest})
        )
        for each in run.evaluations
    ]
    return replace(run, evaluations=tuple(changed))


@pytest.mark.needs_chromium
@pytest.mark.parametrize(
    ("weakest", "told"),
    [
        (
            WeakestPush("tall, 0.8 m", 180.0, "human falls"),
            "weakest pushed backwards at tall, 0.8 m: human falls",
        ),
        (WeakestPush("0.8 m", 315.0, ""), "weakest pushed forwards to the right at 0.8 m"),
    ],
)
def test_the_card_says_where_a_push_margin_is_least(
    chromium: Tab, tmp_path: Path, weakest: WeakestPush, told: str
) -> None:
    run = read_run(GOLDEN)
    names = [objective.name for objective in run.header.objectives]
    content = page_content(weakest_in(run, names[1], weakest))
    assert {design.weakest[names[1]] for design in content.designs.values()} == {weakest}
    page = tmp_path / "report.html"
    page.write_text(page_html(content), encoding="utf-8")
    open_page(chromium, page)
    lines = msgspec.json.decode(chromium.value(LINES))
    assert lines[:3] == ["", told, ""][: len(names)]
    assert chromium.complaints() == []
