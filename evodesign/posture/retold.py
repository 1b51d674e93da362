"""Known postures as starting values of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from evodesign.posture.form import Form
from evodesign.posture.program import Program
from evodesign.posture.solution import AgentPosture

__all__ = ["start_from"]


def start_from(
    forms: Sequence[Form], program: Program, postures: Mapping[str, AgentPosture]
) -> dict[str, Any]:
    """Whole postures as values of a program's variables; hands of an absent agent are the partner's.

    Args:
        forms: of robot and person.
        program: over both or one of them.
        postures: by agent name.
    """
    counts = {variable.name: variable.symbol.numel() for variable in program.variables}
    known: dict[str, Any] = {}
    for form in forms:
        posture, agent = postures[form.agent.name], form.agent.name
        present = f"{agent}.joints" in counts
        hands = {
            f"{agent if present else 'partner'}.{side}_hand": posture.hand_wrenches[side]
            for side in form.sides
        }
        known |= {name: wrench[: counts[name]] for name, wrench in hands.items()}
        if present:
            known |= {f"{agent}.{side}_foot": posture.foot_wrenches[side] for side in form.sides}
            known[f"{agent}.base_position"] = posture.base_position
            known[f"{agent}.base_angles"] = posture.base_angles
            known[f"{agent}.joints"] = [posture.joints[name] for name in form.joints]
            known[f"{agent}.torques"] = [posture.torques[name] for name in form.joints]
    return known
