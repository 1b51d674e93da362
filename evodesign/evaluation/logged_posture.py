"""A posture of the log as the one that it was made of."""

from __future__ import annotations

import numpy as np

from evodesign.posture.results import AgentPosture
from evodesign.records import AgentDetail, LoadCaseDetail


def logged_posture(own: AgentDetail, disturbed: LoadCaseDetail | None = None) -> AgentPosture:
    """An agent's posture with what it carries, undisturbed or under a disturbance."""
    carried = disturbed or own
    return AgentPosture(
        base_position=np.array(own.base_position_m),
        base_angles=np.array(own.base_rpy_rad),
        joints=own.joints_rad,
        torques=carried.torques_n_m,
        wrenches={name: np.array(wrench) for name, wrench in carried.wrenches.items()},
    )
