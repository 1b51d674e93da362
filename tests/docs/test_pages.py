"""README and indices lead to all pages, recipes and problems, and the citation file is of this version."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

import evodesign

REPOSITORY = Path(__file__).parents[2]
README = (REPOSITORY / "README.md").read_text(encoding="utf-8")
PROBLEM_FILE = (REPOSITORY / "docs" / "problem_file.md").read_text(encoding="utf-8")
CONTRIBUTING = (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", sorted((REPOSITORY / "docs").glob("*.md")), ids=lambda page: page.name)
def test_the_readme_leads_to_every_page(page: Path) -> None:
    assert f"](docs/{page.name})" in README


@pytest.mark.parametrize(
    "recipe", sorted((REPOSITORY / "docs" / "recipes").glob("*.md")), ids=lambda page: page.name
)
def test_index_and_readme_lead_to_every_recipe_and_each_is_a_screen(recipe: Path) -> None:
    text = recipe.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 45
    if recipe.name != "index.md":
        assert f"]({recipe.name})" in (recipe.parent / "index.md").read_text(encoding="utf-8")
        assert f"](docs/recipes/{recipe.name})" in README
        assert "evodesign " in text


def test_the_readme_is_read_in_ten_minutes() -> None:
    assert len(README.splitlines()) <= 130


@pytest.mark.parametrize("file", sorted((REPOSITORY / "problems").glob("*.toml")), ids=lambda file: file.stem)
def test_the_page_of_problem_files_names_every_problem(file: Path) -> None:
    assert f"`{file.name}`" in PROBLEM_FILE


def test_links_within_contributing_lead_to_its_sections() -> None:
    sections = {
        f"#{title.lower().replace(' ', '-')}"
        for title in re.findall(r"^#+ (.*)$", CONTRIBUTING, re.MULTILINE)
    }
    links = set(re.findall(r"\]\((#[\w-]+)\)", CONTRIBUTING))
    assert len(links) >= 9
    assert links <= sections
    assert {"#tests"} <= links & sections


CITATION_KEYS = {
    "abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi", "identifiers",
    "keywords", "license", "license-url", "message", "preferred-citation", "references", "repository",
    "repository-artifact", "repository-code", "title", "type", "url", "version",
}  # fmt: skip
"""All that the Citation File Format 1.2.0 knows at the top."""


@pytest.fixture(scope="module")
def citation() -> dict[str, Any]:
    return dict(yaml.safe_load((REPOSITORY / "CITATION.cff").read_text(encoding="utf-8")))


def test_the_citation_file_has_the_keys_of_its_format(citation: dict[str, Any]) -> None:
    assert {"cff-version", "message", "title", "authors"} <= set(citation) <= CITATION_KEYS
    assert (citation["cff-version"], citation["type"]) == ("1.2.0", "software")
    assert citation["authors"] == [{"name": "The evodesign authors"}]
    strings = ("cff-version", "message", "title", "version", "license")
    assert [key for key in strings if not isinstance(citation[key], str)] == [], (
        "quoted where YAML sees a number"
    )


def test_the_citation_is_of_this_version_and_licence(citation: dict[str, Any]) -> None:
    assert citation["version"] == evodesign.__version__
    text = (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")
    assert f'license = "{citation["license"]}"' in text


def test_the_paper_is_cited(citation: dict[str, Any]) -> None:
    (paper,) = citation["references"]
    assert {"type", "title", "authors"} <= set(paper), "what a reference must have"
    assert [author["family-names"] for author in paper["authors"]] == ["Sartore", "Rapetti", "Pucci"]
    words = re.sub(r"\s+", " ", README)
    assert paper["title"] in words
    assert f"Humanoids {paper['year']}" in words
