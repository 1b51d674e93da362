"""Things in a problem that are allowed but look like mistakes."""

from __future__ import annotations

import math

from evodesign.problem.build import Problem
from evodesign.tree.anthropometry import Person, Sex
from evodesign.tree.human import human_tree
from evodesign.tree.model import Joint

__all__ = ["notes"]

ALIKE = math.radians(15.0)
"""Joint limits closer than this count as the same."""


def notes(problem: Problem) -> tuple[str, ...]:
    """A sentence for each thing that a careful reader of the problem would ask about."""
    human = problem.scene.human.tree
    anatomy = human_tree(Person(1.75, 75.0, Sex.MALE)).joint_by_name
    turned = [
        joint for joint in human.joints if joint.name in anatomy and _looks_turned(joint, anatomy[joint.name])
    ]
    return tuple(_sentence(human.name, joint, anatomy[joint.name]) for joint in turned)


def _looks_turned(joint: Joint, anatomical: Joint) -> bool:
    """Whether limits fit the anatomical ones much better with their sign turned."""
    as_given = _difference(joint.lower, joint.upper, anatomical)
    turned = _difference(-joint.upper, -joint.lower, anatomical)
    return turned < ALIKE < as_given


def _difference(lower: float, upper: float, anatomical: Joint) -> float:
    return max(abs(lower - anatomical.lower), abs(upper - anatomical.upper))


def _sentence(name: str, joint: Joint, anatomical: Joint) -> str:
    given, expected = (
        f"{math.degrees(j.lower):.0f} to {math.degrees(j.upper):.0f} degrees" for j in (joint, anatomical)
    )
    return (
        f"{name}: joint {joint.name} turns from {given}, where a person's turns from {expected}: "
        "its limits seem to have the wrong sign"
    )
