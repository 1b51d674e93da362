"""What the choice between a link's shapes and its file's inertia changes, link by link."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evodesign.problem.build import DesignProblem
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml
from evodesign.tree.model import Link
from evodesign.tree.urdf_read import InertiaRule, links_by_rule

MOVED, CHANGED = 1e-3, 0.05
"""Distance of the centres of mass [m] and relative difference of a principal moment that are worth a line."""


@dataclass(frozen=True, slots=True)
class RuleDifference:
    """A link for which shapes and file say different things.

    Args:
        link: its name.
        taken: the rule that holds for it.
        center_m: distance between the two centres of mass.
        moments_kg_m2: principal moments about them, the smallest first: as taken, and by the other rule.
    """

    link: str
    taken: InertiaRule
    center_m: float
    moments_kg_m2: tuple[tuple[float, float, float], tuple[float, float, float]]


def rule_differences(problem: DesignProblem) -> tuple[RuleDifference, ...]:
    """The links of the robot whose mass is the same, but elsewhere or otherwise spread, by the other rule."""
    tables = decode_toml(problem.source.text, problem.source.path, ProblemFile)
    if tables.designed is None:
        return ()
    name = tables.designed.urdf
    rules = InertiaRule.SHAPES, InertiaRule.FILE
    by_shapes, by_file = links_by_rule(problem.source.files[name], name, rules)
    taken = problem.scene.designed_tree.link_by_name
    found = (_difference(*pair, taken[pair[0].name]) for pair in zip(by_shapes, by_file, strict=True))
    return tuple(each for each in found if each is not None)


def _difference(of_shapes: Link, of_file: Link, taken: Link) -> RuleDifference | None:
    if not of_shapes.solids:
        return None
    moved = math.dist(of_shapes.inertia.center, of_file.inertia.center)
    shapes, file = (np.linalg.eigvalsh(np.array(link.inertia.about_center)) for link in (of_shapes, of_file))
    if moved < MOVED and np.abs(shapes - file).max() < CHANGED * max(shapes.max(), file.max()):
        return None
    rule = InertiaRule.SHAPES if taken.solids else InertiaRule.FILE
    ordered = (shapes, file) if taken.solids else (file, shapes)
    moments = tuple(tuple(map(float, each)) for each in ordered)
    return RuleDifference(taken.name, rule, moved, moments)  # type: ignore[arg-type]
