"""How the growth of a hypervolume over one doubling of evaluations relates to that over the next.

    python -m benchmarks.growth

From the stored shares of `benchmarks/front_quality.py`; nothing is evaluated.
"""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np

RESULTS = Path(__file__).parent / "results" / "front_quality.json"


def factors() -> list[float]:
    """Relative growth of a doubling divided by that of the doubling before, of every stored search."""
    return [after / before for before, after in doublings()]


def doublings() -> list[tuple[float, float]]:
    """Relative growth of two doublings, one after the other, of every stored search."""
    found = list[tuple[float, float]]()
    for row in json.loads(RESULTS.read_text(encoding="utf-8"))["rows"]:
        shares = [share for _, share in sorted((int(count), share) for count, share in row["shares"].items())]
        growths = [after / before - 1.0 for before, after in pairwise(shares)]
        found += pairwise(growths)
    return found


def main() -> None:
    """Print quantiles."""
    found = factors()
    for share in (0.1, 0.25, 0.5, 0.75, 0.9):
        print(f"{share:4.0%}: {np.quantile(found, share):.2f}")
    print(f"of {len(found)} pairs of doublings")


if __name__ == "__main__":
    main()
