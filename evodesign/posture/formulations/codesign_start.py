"""Where the joint problem's solves begin: a design, and postures drawn for it.

A start is a genome and nothing else: the postures are drawn with a generator seeded by the genome's digits,
so that how a start ends is a property of problem and start alone. Joints begin a random share of the way to
the middle of their ranges, with some spread about it, anew at every height. The named designs of a problem
begin half-way to the middle.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import numpy as np

from evodesign.nlp.program import Program, Start
from evodesign.posture.symmetry import Form
from evodesign.posture.terms.floating_base import joint_ranges
from evodesign.posture.warm_start import layout_of
from evodesign.records import Genome

__all__ = ["drawn_postures", "standard_postures"]

SHARE = 0.5
"""Of the way from zero to the middle of each joint's range, at which standard postures begin."""

SPREAD = 0.3
"""Standard deviation of a joint about the common share [rad]."""


def standard_postures(program: Program, forms: Sequence[Form]) -> Start:
    """Joints of every agent at every height half-way to the middle of their ranges, by variable name."""
    return {name: SHARE * middle for name, middle in _middles(program, forms).items()}


def drawn_postures(program: Program, forms: Sequence[Form], genome: Genome) -> Start:
    """Joints of every agent at every height, drawn for a genome, by variable name."""
    digest = hashlib.sha256(np.array(genome).tobytes()).digest()
    rng = np.random.default_rng(int.from_bytes(digest))
    return {
        name: rng.uniform() * middle + SPREAD * rng.standard_normal(len(middle))
        for name, middle in _middles(program, forms).items()
    }


def _middles(program: Program, forms: Sequence[Form]) -> dict[str, np.ndarray]:
    """The middle of every joint's range, by variable name, in the program's order."""
    middles = {form.agent.name: np.mean(joint_ranges(form), axis=1) for form in forms}
    return {name: middles[slot.party] for slot, name in layout_of(program).items() if slot.part == "joints"}
