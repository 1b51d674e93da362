"""A small problem with a measured person, and a run in whose end the front met samples of people."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import evodesign

LIFTING = Path(__file__).parent / "golden" / "lifting"

SAMPLES = 3


def measured_tables(grasp: str = "rigid", **human: Any) -> dict[str, Any]:
    """One person, one height, two lengths."""
    found = tomllib.loads((LIFTING / "problem.toml").read_text(encoding="utf-8"))
    found["human"] = [{**found["human"][0], "posture": "measured", **human}]
    found["payload"] = {key: found["payload"][key] for key in ("size_m", "mass_kg")} | {"grasp": grasp}
    if grasp == "rigid":
        found["payload"]["hand_moment_n_m"] = 7.0
    found["task"]["heights_m"] = [1.0]
    found["design"] = {"length": found["design"]["length"]}
    found["search"].pop("start")
    found["solver"] = {"start_portfolio": False}
    del found["disturbance"]
    return found


def search_with_people(directory: Path, **options: Any) -> evodesign.Run:
    """A random search of six designs whose front then meets three samples of people."""
    problem = evodesign.Problem.from_dict(measured_tables(spread=SAMPLES), LIFTING)
    sizes = {"algorithm": "random", "evaluations": 6, "population": 3, "seed": 2, "pool": "serial"}
    return evodesign.search(problem, directory, **{**sizes, **options})
