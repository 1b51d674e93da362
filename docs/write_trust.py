"""Writes the tables and pictures of docs/trust.md: `python -m docs.write_trust`, half a minute."""

from __future__ import annotations

from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from evodesign.cli.tables.validation import validation_tables
from evodesign.report.figures.validation import write_validation_figures
from evodesign.validation.compare import compare
from evodesign.validation.holds import compare_holds
from evodesign.validation.measured import shipped_cases

DOCS = Path(__file__).parent
PAGE = DOCS / "trust.md"
FENCE = "```\n"


def main() -> None:
    """Put what `evodesign validate` prints and draws in the place of what the page shows."""
    compared, out = compare(shipped_cases()), StringIO()
    for table in validation_tables(compared, compare_holds()):
        Console(file=out, width=80).print(table)
    before, _, after = PAGE.read_text(encoding="utf-8").split(FENCE, 2)
    tables = "".join(f"{line.rstrip()}\n" for line in out.getvalue().splitlines())
    PAGE.write_text(FENCE.join([before, tables, after]), encoding="utf-8")
    with TemporaryDirectory() as folder:
        for path in write_validation_figures(compared, Path(folder)):
            if path.suffix == ".png":
                name = {"postures_side": "side", "l5s1_moment": "l5s1"}[path.stem]
                (DOCS / "pictures" / f"validate_{name}.png").write_bytes(path.read_bytes())


if __name__ == "__main__":
    main()
