"""Pages of the site that lie outside docs/, for mkdocs: README and others, and what they link to.

Pages link to each other as they lie in the repository, so that links work there as well. The site has
them all in one folder: links are turned to where a file lies in the site, and what is no page is copied.
"""

from __future__ import annotations

import os.path
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

REPOSITORY = Path(__file__).parents[1]
DOCS = Path(__file__).parent
PAGES = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "THIRD_PARTY_LICENSES.md": "licences.md",
    "examples/README.md": "examples.md",
    "problems/robots/README.md": "robots.md",
}
"""Where a page of the repository lies in the site."""

LINK = re.compile(r"(\]\()([^)\s#]+)(#[^)\s]*)?\)")


def in_site(text: str, folder: Path, copied: set[str], place: str = "") -> str:
    """A page's text with links as the site has them.

    Args:
        text: Markdown.
        folder: of the page in the repository.
        copied: gets the files to copy, from the repository's top.
        place: folder of the page in the site.
    """

    def turned(found: re.Match[str]) -> str:
        target = (folder / found[2]).resolve()
        if "://" in found[2] or not target.is_file() or not target.is_relative_to(REPOSITORY):
            return found[0]
        name = str(target.relative_to(REPOSITORY))
        there = os.path.relpath(PAGES.get(name, name.removeprefix("docs/")), place or ".")
        if name not in PAGES and not target.is_relative_to(DOCS):
            copied.add(name)
        return f"{found[1]}{there}{found[3] or ''})"

    return LINK.sub(turned, text)


def on_files(files: Files, config: Any) -> Files:
    """Add the pages from outside docs/, and what any page links to."""
    copied: set[str] = set()
    for name, place in PAGES.items():
        text = (REPOSITORY / name).read_text(encoding="utf-8")
        text = in_site(text, (REPOSITORY / name).parent, copied)
        files.append(File.generated(config, place, content=text))
    for page in DOCS.rglob("*.md"):
        in_site(page.read_text(encoding="utf-8"), page.parent, copied)
    for name in copied:
        files.append(File.generated(config, name, abs_src_path=str(REPOSITORY / name)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Turn the links of pages of docs/, and let the site's search find recipes first and changes nowhere."""
    name = page.file.src_uri
    if name == "changelog.md":
        page.meta["search"] = {"exclude": True}
    elif name.startswith("recipes/"):
        page.meta["search"] = {"boost": 4}
    if page.file.generated_by:
        return markdown
    place = Path(name).parent.as_posix()
    return in_site(markdown, DOCS / place, set(), place)
