"""Every file that README, CONTRIBUTING, Makefile and docs name is there: links, paths, modules."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
PAGES = sorted(
    [
        REPOSITORY / "README.md",
        REPOSITORY / "CONTRIBUTING.md",
        REPOSITORY / "Makefile",
        *(REPOSITORY / "docs").rglob("*.md"),
        *(REPOSITORY / "docs").rglob("*.ipynb"),
    ]
    + [REPOSITORY / folder / "README.md" for folder in ("problems/robots", "runs")]
)
LINK = re.compile(r"\]\(([^)\s]+)\)")
SOURCE = re.compile(r"(?<![\w./*-])((?:evodesign|tests|benchmarks|docs|problems|populations)/[\w./-]*)")
MODULE = re.compile(r"(?<![\w./*-])((?:\w+/)*\w+\.py)\b")
NAMED = re.compile(r"`((?:\w+/)*\w+\.py): (\w+)`")
BENCHMARK = re.compile(r"python -m (benchmarks\.\w+)")


@pytest.fixture(scope="module", params=PAGES, ids=lambda page: str(page.relative_to(REPOSITORY)))
def page(request: pytest.FixtureRequest) -> Path:
    return Path(request.param)


def test_links_lead_to_files(page: Path) -> None:
    targets = [found.split("#")[0] for found in LINK.findall(page.read_text(encoding="utf-8"))]
    inside = [target for target in targets if target and "://" not in target]
    assert [target for target in inside if not (page.parent / target).exists()] == []


def test_paths_of_the_repository_exist(page: Path) -> None:
    named = [found.rstrip(".") for found in SOURCE.findall(page.read_text(encoding="utf-8"))]
    assert [path for path in named if not (REPOSITORY / path).exists()] == []


def test_modules_exist(page: Path) -> None:
    """A module is named from the repository, from the package, or by its name alone."""
    text = page.read_text(encoding="utf-8")
    known = {path.name for path in (REPOSITORY / "evodesign").rglob("*.py")}
    roots = (REPOSITORY, REPOSITORY / "evodesign", page.parent)
    missing = [
        path
        for path in MODULE.findall(text)
        if not any((root / path).exists() for root in roots) and not ("/" not in path and path in known)
    ]
    assert missing == []
    commands = [found.replace(".", "/") + ".py" for found in BENCHMARK.findall(text)]
    assert [path for path in commands if not (REPOSITORY / path).exists()] == []


def test_what_is_named_in_a_module_is_defined_there(page: Path) -> None:
    """As in `posture/terms/feet.py: rows`."""
    named = NAMED.findall(page.read_text(encoding="utf-8"))
    modules = {path: (REPOSITORY / "evodesign" / path).read_text(encoding="utf-8") for path, _ in named}
    assert [
        (path, name) for path, name in named if not re.search(rf"(def|class) {name}\b", modules[path])
    ] == []


def test_the_pages_name_paths_of_every_kind() -> None:
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert min(len(kind.findall(text)) for kind in (LINK, SOURCE, MODULE, BENCHMARK)) > 5
