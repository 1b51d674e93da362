"""A comparison of runs as a JSON object."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

import msgspec

from evodesign.analysis.comparison import Compared, Comparison, best_designs


def comparison_json(comparison: Comparison) -> dict[str, Any]:
    """A comparison as a JSON object; its shape is a promise."""
    return {
        "objectives": [
            {"name": each.name, "unit": each.unit, "sense": each.sense} for each in comparison.objectives
        ],
        "reference": comparison.reference,
        "evaluations": comparison.evaluations,
        "notes": list(comparison.notes),
        "searches": [
            {"name": name, "runs": len(members), "hypervolume": hypervolume_summary(members)}
            for name, members in comparison.searches.items()
        ],
        "runs": [_run(each) for each in comparison.runs],
        "tests": [
            {
                "samples": list(test.samples),
                "test": test.name,
                "p": test.p,
                "effect": test.effect,
                "finding": test.finding,
                "reason": test.reason,
            }
            for test in comparison.tests
        ],
        "attainment": [
            {
                "search": each.search,
                "objectives": [objective.name for objective in each.objectives],
                "surfaces": msgspec.to_builtins(each.surfaces),
            }
            for each in comparison.attainments
        ],
        "best_designs": [
            {
                "reason": each.reason,
                "run": str(each.run.run.directory),
                "id": each.evaluation.number,
                "objectives": each.evaluation.assessment.objectives,
                "parameters": each.evaluation.assessment.design,
            }
            for each in best_designs(comparison)
        ],
    }


def hypervolume_summary(members: Sequence[Compared]) -> dict[str, float] | None:
    """Median, least and greatest hypervolume of a search; None without any."""
    volumes = [each.hypervolume for each in members if each.hypervolume is not None]
    if not volumes:
        return None
    return {"median": statistics.median(volumes), "least": min(volumes), "greatest": max(volumes)}


def _run(each: Compared) -> dict[str, Any]:
    header = each.run.header
    return {
        "run": str(each.run.directory),
        "problem": header.problem_name,
        "search": each.search,
        "seed": header.search.seed,
        "evaluations": len(each.run.evaluations),
        "front": len(each.front),
        "hypervolume": each.hypervolume,
        "share": each.share,
        "best": each.best,
        "curve": msgspec.to_builtins(each.curve),
    }
