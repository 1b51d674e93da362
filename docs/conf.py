"""The documentation as a site, by Sphinx and MyST: pages lie and link to each other as in the repository.

Formulas become MathML when the site is built, so that no script has to be loaded. The site's search ranks
by `search_scores.js` and never looks into the changelog.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from docutils.nodes import SkipNode
from latex2mathml.converter import convert
from sphinx.errors import ExtensionError

project = "evodesign"
extensions = ["myst_parser", "sphinx_copybutton"]
root_doc = "README"
CONTENTS = {
    "Start": ["docs/tutorial", "docs/gallery"],
    "Recipes": ["docs/recipes/index"],
    "Problems": [
        f"docs/{name}"
        for name in (
            *("problem_file", "your_robot", "people", "person", "trust", "default", "sharing"),
            *("disturbances", "motion", "control", "carry", "hardware", "actuators", "materials"),
        )
    ],
    "Searching": [
        f"docs/{name}" for name in ("commands", "page", "choosing", "runs", "export", "distributed")
    ],
    "Python": ["docs/python", "examples/README", "docs/api"],
    "Background": ["docs/architecture", "docs/model", "docs/paper", "docs/benchmarks"],
    "Project": ["CONTRIBUTING", "CHANGELOG", "THIRD_PARTY_LICENSES", "problems/robots/README"],
}
"""Pages by the heading under which the side bar has them."""

RECIPES = "docs/recipes/index"
UNSEARCHED = "CHANGELOG"

include_patterns = [
    "*.md",
    "docs/*.md",
    "docs/recipes/*.md",
    "examples/README.md",
    "problems/robots/README.md",
]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 6
html_theme = "furo"
html_title = project
html_copy_source = False
html_search_scorer = str(Path(__file__).with_name("search_scores.js"))
html_math_renderer = "mathml"


def add_contents(app: Any, page: str, source: list[str]) -> None:
    """Give the first page, and that of the recipes, the pages below them."""
    if page == root_doc:
        trees = [_tree(pages, heading) for heading, pages in CONTENTS.items()]
    elif page == RECIPES:
        recipes = sorted((Path(app.srcdir) / RECIPES).parent.glob("*.md"))
        trees = [_tree([each.stem for each in recipes if each.stem != "index"])]
    else:
        return
    source[0] += "\n" + "\n".join(trees)


def _tree(pages: list[str], heading: str = "") -> str:
    caption = [f":caption: {heading}"] if heading else []
    return "\n".join(("```{toctree}", ":hidden:", *caption, *pages, "```", ""))


def mathml(translator: Any, node: Any) -> None:
    """Set a formula.

    Raises:
        ExtensionError: a command of TeX is unknown.
    """
    block = node.tagname == "math_block"
    formula = str(convert(node.astext(), display="block" if block else "inline"))
    if "\\" in formula:
        raise ExtensionError(f"latex2mathml does not know a command of: {node.astext()}")
    translator.body.append(formula)
    raise SkipNode


def leave_out_of_search(app: Any, tree: Any) -> None:
    """Pages that the search does not know."""
    if app.env.docname == UNSEARCHED:
        app.env.metadata[UNSEARCHED]["nosearch"] = True


def open_at_readme(app: Any, error: Exception | None) -> None:
    """The first page is README's."""
    if error is None:
        shutil.copy(Path(app.outdir) / "README.html", Path(app.outdir) / "index.html")


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", inline_renderers=(mathml, None), block_renderers=(mathml, None))
    app.connect("source-read", add_contents)
    app.connect("doctree-read", leave_out_of_search)
    app.connect("build-finished", open_at_readme)
