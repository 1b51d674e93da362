"""Texts of the page stand out from what they stand on, in both themes (WCAG 2.1, AA: 4.5)."""

from __future__ import annotations

import re
from itertools import product

import pytest

from evodesign.report.page.render import TEMPLATE


def luminance(colour: str) -> float:
    """Relative luminance of `#rrggbb`, after WCAG 2.1."""
    parts = [int(colour[start : start + 2], 16) / 255.0 for start in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_texts_stand_out(theme: int) -> None:
    block = TEMPLATE.joinpath("palette.css").read_text(encoding="utf-8").split("}")[theme]
    colours = dict(re.findall(r"--([\w-]+): (#\w{6});", block))
    pairs = [*product(("ink", "soft", "accent"), ("surface", "ground")), ("second", "surface")]
    for text, ground in pairs:
        dark, light = sorted((luminance(colours[text]), luminance(colours[ground])))
        assert (light + 0.05) / (dark + 0.05) >= 4.5, (text, ground)
