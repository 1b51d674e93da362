"""The pages use the field's words: phrases of a private language are refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
REFUSED = (
    r"mak(?:e|es|ing) ready|made ready|\bkept apart\b|\bkept in better ways\b|\bworked out\b",
    r"\b(?:is|are|was|were|be|been) (?:re)?told\b|\btold (?:are|about|too)\b",
    r"\b(?:[Ww]hat|[Nn]othing) .{0,30}\btold\b|\b(?:Watched|Told) are\b|\bcopied for every\b",
    r"\b(?:is|are|was|were|be|been|[Nn]ot) looked at\b|\bWho carries\b|\bwho carries how\b",
    r"\b(?:is|are|was|were) served\b|\bled well\b|\bpush still\b|\bcarries and leans\b",
    r"\bdear(?:er)?\b|\bborne\b|\bbear(?:s|ing)? (?:the|a|most|it|\d)|\bworth(?! of)\b",
    r"\b(?:un)?parted\b|\bparts? (?:their )?bod(?:y|ies)\b|\bmeetings\b|\bbettered\b|\bmended\b",
    r"\brefuges?\b|\bgiven up\b|\bconquers?\b|\bbelieved\b|\bkinks?\b|\bnobody's motion\b",
    r"\bsettled (?:people|posture|lift)|\b(?:is|are|was|were) settled\b",
    r"\bwhole postures?\b|\bsolved whole\b|\bwithin itself\b|\bis found by geometry\b",
    r"\bmade \d+ better\b|\bwhat a start promised\b|\blead to in the iterations\b",
    r"\bhardly any search would still\b",
)
"""Regular expressions, most from sentences that once stood on the pages."""

PAGES = [REPOSITORY / "README.md", REPOSITORY / "CHANGELOG.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


def phrases(text: str) -> list[str]:
    """What of a page's prose, without code, is refused."""
    prose = re.sub(r"\s+", " ", CODE.sub(" ", text))
    return [found[0] for pattern in REFUSED for found in re.finditer(pattern, prose)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_uses_the_words_of_the_field(page: Path) -> None:
    found = set(phrases(page.read_text(encoding="utf-8")))
    assert sorted(found) == []


@pytest.mark.parametrize(
    "sentence",
    [
        "What is made ready of the default problem but\nmachine code",
        "Watched are all pairs.",
        "Who carries leans back",
        "it is told of every posture which two bodies are nearest",
        "optima are looked at for directions that part their bodies better",
        "what a design needs is told too badly",
        "Romeo is solved whole",
        "limits that are missed by 1e-5 push still",
        "a believed front",
    ],
)
def test_sentences_that_once_stood_there_are_refused(sentence: str) -> None:
    assert phrases(sentence)


def test_code_and_the_fields_own_words_pass() -> None:
    assert not phrases("`settled` ends; strain wave drives carry a load, and `evodesign seeds` told `x`.")
