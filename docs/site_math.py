"""Formulas of the site: TeX becomes MathML when the site is built, so that no script has to be loaded."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)
"""What `pymdownx.arithmatex` makes of a formula between dollars."""


def mathml(found: re.Match[str]) -> str:
    """A formula, in its line or displayed.

    Raises:
        PluginError: a command of TeX is unknown.
    """
    tex, display = html.unescape(found[3]).strip(), "block" if found[2] == "[" else "inline"
    formula = str(convert(tex, display=display))
    if "\\" in formula:
        raise PluginError(f"latex2mathml does not know a command of: {tex}")
    return formula


def on_page_content(content: str, page: Any, config: Any, files: Any) -> str:
    """Set the formulas of a page."""
    return FORMULA.sub(mathml, content)
