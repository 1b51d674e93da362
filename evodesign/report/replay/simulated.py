"""Simulations as an MCAP file: what was done, not what was planned, with the times of the simulation.

Several simulations follow each other, a second apart. Wrenches are those of MuJoCo's contacts and grasps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import IO

import numpy as np
from scipy.spatial.transform import Rotation

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.evaluation.simulations import SimulatedCase
from evodesign.mechanics.agent import Agent
from evodesign.records import AgentDetail, Case, CaseDetail, InstantDetail
from evodesign.report.replay.recording import NANOSECONDS, Frame, write_frames
from evodesign.report.scene_models import SceneSet, placed_scene
from evodesign.simulation.outcome import AgentRollout
from evodesign.tasks import Hold
from evodesign.tree.urdf_write import urdf_text

PAUSE = 1.0
"""Between two simulations [s]."""


def write_simulations(stream: IO[bytes], scene_set: SceneSet, simulations: Sequence[SimulatedCase]) -> None:
    """Write a recording of simulations of one design.

    Args:
        stream: to an empty file.
        scene_set: the design's robot with all people and loads.
        simulations: in the order in which they are shown.
    Raises:
        InputError: there is none.
    """
    if not simulations:
        raise InputError("--mcap", "", "a simulation to be shown", "none")
    people = {name: tree for name, (_, tree) in scene_set.others_files.items()}
    attachments = {name: urdf_text(tree) for name, tree in {"robot.urdf": scene_set.robot, **people}.items()}
    about = {f"simulation {number}": each.name for number, each in enumerate(simulations)}
    write_frames(stream, scene_set, _frames(scene_set, simulations), attachments, about)


def _frames(scene_set: SceneSet, simulations: Sequence[SimulatedCase]) -> Iterator[Frame]:
    begin = 0.0
    for simulation in simulations:
        rollout = simulation.rollout
        for frame, place in enumerate(rollout.frames):
            detail = _detail(simulation, frame, place)
            models = scene_set.models_of(detail)
            stage = placed_scene(models, detail)
            load = _placement(rollout.loads[place])
            nanoseconds = round((begin + rollout.times[place]) * NANOSECONDS)
            yield nanoseconds, replace(stage, world_from_load=load), detail
        begin += float(rollout.times[-1]) + PAUSE


def _detail(simulation: SimulatedCase, frame: int, place: int) -> CaseDetail:
    """A frame as if it were a hold at the planned height."""
    rollout, (person, payload) = simulation.rollout, simulation.scene.pair
    agents = {
        agent.name: _posture(agent, rollout.agents[agent.name], frame, place)
        for agent in simulation.scene.agents
    }
    task = Hold(height_m=float(simulation.plan.heights[place]))
    case = Case(person=person, payload=payload, task=task)
    return CaseDetail(case=case, instants=(InstantDetail(time_s=float(rollout.times[place]), agents=agents),))


def _posture(agent: Agent, rollout: AgentRollout, frame: int, place: int) -> AgentDetail:
    agent_from_world = Rotation.from_euler("z", -agent.facing)
    position, turn = agent_from_world.apply(rollout.roots[place, :3]), _turn(rollout.roots[place])
    yaw, pitch, roll = (agent_from_world * turn).as_euler("ZYX")
    joints, torques = rollout.positions[place].tolist(), rollout.torques[place].tolist()
    both = ((agent.feet, rollout.feet), (agent.hands, rollout.hands))
    wrenches = {
        contact.name: wrench
        for contacts, found in both
        for contact, wrench in zip(contacts, found[frame].tolist(), strict=True)
    }
    return AgentDetail(
        base_position_m=tuple(position.tolist()),
        base_rpy_rad=(float(roll), float(pitch), float(yaw)),
        joints_rad=dict(zip(agent.joints, joints, strict=True)),
        torques_n_m=dict(zip(agent.joints, torques, strict=True)),
        wrenches={name: tuple(wrench) for name, wrench in wrenches.items()},
    )


def _turn(pose: np.ndarray) -> Rotation:
    return Rotation.from_quat(pose[[4, 5, 6, 3]])


def _placement(pose: np.ndarray) -> Placement:
    matrix = _turn(pose).as_matrix().tolist()
    return Placement((tuple(matrix[0]), tuple(matrix[1]), tuple(matrix[2])), tuple(pose[:3].tolist()))
