"""Known postures as starting values of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from evodesign.nlp.program import Program
from evodesign.posture.load_cases import prefix_of
from evodesign.posture.results import AgentPosture
from evodesign.posture.symmetry import Form

__all__ = ["start_from"]


NOTHING: Mapping[str, Mapping[str, AgentPosture]] = MappingProxyType({})
"""What is borne under disturbances where there are none."""


def start_from(
    forms: Sequence[Form],
    program: Program,
    postures: Mapping[str, AgentPosture],
    disturbed: Mapping[str, Mapping[str, AgentPosture]] = NOTHING,
) -> dict[str, Any]:
    """Whole postures as values of a program's variables; hands of an absent agent are the partner's.

    Args:
        forms: of robot and person.
        program: over both or one of them.
        postures: by agent name.
        disturbed: what is borne under each disturbance, in their order, by its name and the agent's.
    """
    counts = {variable.name: variable.symbol.numel() for variable in program.variables}
    known: dict[str, Any] = {}
    for form in forms:
        posture, agent = postures[form.agent.name], form.agent.name
        known |= _borne(form, posture, counts, "")
        for number, borne in enumerate(disturbed.values()):
            known |= _borne(form, borne[agent], counts, prefix_of(number))
        if f"{agent}.joints" in counts:
            known[f"{agent}.base_position"] = posture.base_position
            known[f"{agent}.base_angles"] = posture.base_angles
            known[f"{agent}.joints"] = [posture.joints[name] for name in form.joints]
    return known


def _borne(form: Form, posture: AgentPosture, counts: Mapping[str, int], prefix: str) -> dict[str, Any]:
    """An agent's wrenches and torques in a case whose variables begin with a prefix."""
    agent = f"{prefix}{form.agent.name}"
    present = f"{agent}.torques" in counts
    hand = agent if present else f"{prefix}partner"
    hands = {f"{hand}.{side}_hand": posture.hand_wrenches[side] for side in form.sides}
    known: dict[str, Any] = {name: wrench[: counts[name]] for name, wrench in hands.items()}
    if present:
        known |= {f"{agent}.{side}_foot": posture.foot_wrenches[side] for side in form.sides}
        known[f"{agent}.torques"] = [posture.torques[name] for name in form.joints]
    return known
