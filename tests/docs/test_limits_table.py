"""The table of `[limits]` in docs/model.md has every key with its default and unit."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec

from evodesign.mechanics.agent import StanceLimits
from evodesign.problem.task_tables import LimitsTable

ROW = re.compile(r"^\| `(\w+)` \| ([^|]+) \| (\w+) \| [^|]+ \| [^|]+ \|$", re.MULTILINE)


def test_every_key_of_the_limits_stands_in_the_table_with_its_default(repository: Path) -> None:
    text = (repository / "docs" / "model.md").read_text(encoding="utf-8")
    rows = {key: (default.strip(), unit) for key, default, unit in ROW.findall(text)}
    defaults = msgspec.structs.asdict(LimitsTable())
    robots = StanceLimits()
    by_size = {
        key: f"by size; a robot {shown(value)}"
        for key, value in (
            ("trunk_clearance_m", robots.trunk_clearance),
            ("feet_apart_m", robots.feet_apart),
        )
    }
    assert all(defaults[key] is None for key in by_size)
    expected = {key: by_size.get(key, shown(value)) for key, value in defaults.items()}
    assert {key: rows[key][0] for key in defaults} == expected
    for key in defaults:
        ending = key.rpartition("_")[2]
        assert rows[key][1] == (ending if ending in ("m", "n", "rad") else "1").replace("n", "N")


def shown(value: object) -> str:
    if value is None:
        return "none"
    if isinstance(value, tuple):
        return f"[{', '.join(f'{each:.2f}' for each in value)}]"
    return f"{value:.2f}" if float(str(value)) not in (0.0, 0.5, 5.0) else f"{value}"
