"""Simulations as JSON (docs/motion.md has keys and units)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from evodesign.control.gains import Feedback
from evodesign.evaluation.simulations import SimulatedCase
from evodesign.simulation.outcome import AgentOutcome


def simulations_json(simulations: Sequence[SimulatedCase], feedback: Feedback) -> dict[str, Any]:
    """What the table of a simulation shows, in SI units."""
    return {
        "feedback": {"frequency_rad_s": feedback.frequency, "damping_ratio": feedback.damping},
        "simulations": [_one(each) for each in simulations],
    }


def _one(simulation: SimulatedCase) -> dict[str, Any]:
    outcome = simulation.outcome
    return {
        "case": simulation.name,
        "person": simulation.scene.pair[0],
        "payload": simulation.scene.payload.label,
        "seconds": outcome.seconds,
        "stands": outcome.stands,
        "drift_m": outcome.drift,
        "tilt_rad": outcome.tilt,
        "agents": {name: _agent(agent) for name, agent in outcome.agents.items()},
    }


def _agent(outcome: AgentOutcome) -> dict[str, Any]:
    return {
        "fell": outcome.fell,
        "tracking_rad": outcome.tracking,
        "torque_difference_n_m": outcome.torque,
        "torque_difference_joint": outcome.torque_joint,
        "planned_peak_n_m": outcome.peak,
        "torque_share": outcome.torque_share,
        "slip_m": outcome.slip,
        "at_limit": list(outcome.at_limit),
    }
