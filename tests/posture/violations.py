"""What the check finds, by name."""

from __future__ import annotations

from collections.abc import Mapping

from evodesign.posture.check import Checker, sizes
from evodesign.posture.results import AgentPosture, Instant

Postures = Mapping[str, AgentPosture]


def violations(
    checker: Checker, postures: Postures, height: float, disturbed: Mapping[str, Postures] | None = None
) -> dict[str, float]:
    """Sizes of all residuals, SI units, by name."""
    return sizes(checker.residuals(Instant(0.0, postures, disturbed or {}), height))
