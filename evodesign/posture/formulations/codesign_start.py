"""Where the joint problem's solves begin: a design, and postures drawn for it.

A start is a genome and nothing else: the postures are drawn with a generator seeded by the genome's digits,
so that how a start ends is a property of problem and start alone. Joints begin a random share of the way to
the middle of their ranges, with some spread about it, anew at every height. The named designs of a problem
begin half-way to the middle.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from evodesign.posture.symmetry import Form
from evodesign.records import Genome

__all__ = ["drawn_postures", "standard_postures"]

Array = Any

SHARE = 0.5
"""Of the way from zero to the middle of each joint's range, at which standard postures begin."""

SPREAD = 0.3
"""Standard deviation of a joint about the common share [rad]."""


def standard_postures(forms: Sequence[Form], heights: int) -> dict[str, Array]:
    """Joints of every form at every height half-way to the middle of its range, by variable name."""
    return {_name(index, form): SHARE * _middle(form) for index in range(heights) for form in forms}


def drawn_postures(forms: Sequence[Form], heights: int, genome: Genome) -> dict[str, Array]:
    """Joints of every form at every height, drawn for a genome, by variable name."""
    digest = hashlib.sha256(np.array(genome).tobytes()).digest()
    rng = np.random.default_rng(int.from_bytes(digest))
    return {
        _name(index, form): rng.uniform() * _middle(form) + SPREAD * rng.standard_normal(len(form.joints))
        for index in range(heights)
        for form in forms
    }


def _name(index: int, form: Form) -> str:
    return f"height_{index}.{form.agent.name}.joints"


def _middle(form: Form) -> Array:
    joints = [form.agent.tree.joint_by_name[name] for name in form.joints]
    return np.array([(max(j.lower, -np.pi) + min(j.upper, np.pi)) / 2.0 for j in joints])
