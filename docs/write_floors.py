"""Writes docs/pictures/floors.svg, the packages by floor: `python -m docs.write_floors`."""

from __future__ import annotations

import tomllib
from pathlib import Path

DOCS = Path(__file__).parent
PICTURE = DOCS / "pictures" / "floors.svg"

ROW, WIDTH, GAP = 26, 560, 4
STYLE = "rect{fill:#e8eef4;stroke:#5b7083}text{font:13px sans-serif;fill:#1d2b36;text-anchor:middle}"


def floors() -> list[list[str]]:
    """Names of packages and modules by floor, the highest first, as the import contract has them."""
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))
    (layers,) = (
        contract["layers"]
        for contract in project["tool"]["importlinter"]["contracts"]
        if contract["type"] == "layers"
    )
    return [floor.split(" : ") for floor in layers]


def picture() -> str:
    """The picture as SVG."""
    rows = floors()
    height = len(rows) * ROW + GAP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}">',
        f"<style>{STYLE}</style>",
    ]
    for number, names in enumerate(rows):
        top, width = GAP + number * ROW, (WIDTH - GAP) / len(names)
        for place, name in enumerate(names):
            left = GAP + place * width
            parts.append(
                f'<rect x="{left:g}" y="{top}" width="{width - GAP:g}" height="{ROW - GAP}" rx="3"/>'
                f'<text x="{left + (width - GAP) / 2:g}" y="{top + 16}">{name}</text>'
            )
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")
