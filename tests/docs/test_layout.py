"""The README's table of the packages against the floors that imports keep to."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path


def test_the_readme_lists_every_package_in_the_order_of_its_floor(repository: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text())
    contracts = project["tool"]["importlinter"]["contracts"]
    (floors,) = (each["layers"] for each in contracts if each["type"] == "layers")
    packages = [name for floor in floors for name in floor.split(" : ")]
    rows = re.findall(r"(?m)^\| (`evodesign/[^|]*)\|", (repository / "README.md").read_text())
    names = [name for row in rows for name in re.findall("`(.*?)`", row)]
    listed = [re.sub(r"^evodesign/|/$|\.py$", "", name) for name in names]
    assert listed == [name for name in packages if name != "__main__"]
