"""Compression and shear of the disc L5/S1: by hand, by pinocchio, by differences; and who has none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from evodesign.errors import InputError
from evodesign.mechanics.agent import SIDES
from evodesign.mechanics.lumbar_load import lumbar_load
from evodesign.posture.check import AgentModel
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import build_problem
from evodesign.problem.constraints import constraint_key
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml, read_source
from evodesign.problem.unanswered_quantities import refuse_unanswered_quantity
from evodesign.quantities.person_quantities import (
    compression,
    compression_by_posture,
    compression_by_torque,
)
from evodesign.records import ProblemSource
from tests.problem.standing_people import PERSON, POSTURES, G, beyond, masses, places, standing

FLEXION = "jL5S1_roty"


def load_of(posture: AgentPosture):
    joints = np.array([posture.joints[name] for name in PERSON.joints])
    feet = np.concatenate([posture.wrenches[f"{side}_foot"] for side in SIDES])
    return lumbar_load(PERSON, posture.base_angles, joints, feet, posture.torques[FLEXION])


@pytest.mark.parametrize("name", POSTURES)
def test_it_is_the_moment_over_the_lever_and_what_is_above_along_the_spine(name: str) -> None:
    """Written out from above: weights and their places, and what the load does to the hands."""
    posture = standing(name)
    at, above = places(posture), beyond(FLEXION)
    turn, disc = at["L5"]
    force, moment = np.zeros(3), np.zeros(3)
    for link, (mass, center) in masses().items():
        if link in above:
            weight = np.array([0.0, 0.0, -mass * G])
            force += weight
            moment += np.cross(at[link][1] + at[link][0] @ center - disc, weight)
    for side in SIDES:
        wrench = posture.wrenches[f"{side}_hand"]
        force += wrench[:3]
        moment += wrench[3:] + np.cross(at[PERSON.frame(f"{side}_hand")][1] - disc, wrench[:3])
    bends, along, ahead = float(turn[:, 1] @ moment), float(turn[:, 2] @ force), float(turn[:, 0] @ force)
    load = load_of(posture)
    assert load.moment == pytest.approx(bends, abs=1e-6)
    assert load.compression == pytest.approx(abs(bends) / 0.05 - along, abs=1e-4)
    assert load.shear == pytest.approx(ahead, abs=1e-6)
    assert compression(PERSON, posture) == load.compression


@pytest.mark.parametrize("name", POSTURES)
def test_pinocchio_finds_the_same_force(name: str) -> None:
    """From the whole body: what the ground gives to the feet, less the weight of what lies below the disc."""
    posture = standing(name)
    state = AgentModel.of(PERSON, PERSON.tree).at(posture)
    below = PERSON.tree.mass - sum(mass for link, (mass, _) in masses().items() if link in beyond(FLEXION))
    force = np.array([0.0, 0.0, -below * G])
    for side in SIDES:
        force += state.pose(PERSON.frame(f"{side}_foot"))[0] @ posture.wrenches[f"{side}_foot"][:3]
    own = state.pose("L5")[0].T @ force
    assert load_of(posture).force.tolist() == pytest.approx(own.tolist(), abs=1e-6)


def test_to_stoop_presses_and_shears_the_back_more_than_to_stand_upright() -> None:
    stooped, upright = (load_of(standing(name)) for name in ("stooped", "upright"))
    assert stooped.compression > 2000.0 > upright.compression > 500.0
    assert stooped.shear > 200.0 > abs(upright.shear)


@pytest.mark.parametrize("name", POSTURES)
def test_its_derivatives_are_those_of_differences(name: str) -> None:
    posture, generator = standing(name), np.random.default_rng(4)
    by_torque = compression_by_torque(PERSON, posture)
    by_posture = compression_by_posture(PERSON, posture)
    for _ in range(5):
        step = replace(
            posture,
            base_angles=generator.standard_normal(3),
            joints={joint: generator.standard_normal() for joint in posture.joints},
            torques={joint: 10.0 * generator.standard_normal() for joint in posture.torques},
            wrenches={f"{side}_foot": 50.0 * generator.standard_normal(6) for side in SIDES},
        )
        slope = by_posture.along(step) + by_torque[FLEXION] * step.torques[FLEXION]
        ends = [compression(PERSON, moved(posture, step, size)) for size in (1e-5, -1e-5)]
        assert (ends[0] - ends[1]) / 2e-5 == pytest.approx(slope, rel=1e-7)


def moved(posture: AgentPosture, step: AgentPosture, size: float) -> AgentPosture:
    return replace(
        posture,
        base_angles=posture.base_angles + size * step.base_angles,
        joints={name: at + size * step.joints[name] for name, at in posture.joints.items()},
        torques={name: at + size * step.torques[name] for name, at in posture.torques.items()},
        wrenches={
            name: at + size * step.wrenches.get(name, np.zeros(6)) for name, at in posture.wrenches.items()
        },
    )


def test_it_can_be_bounded_by_the_limit_in_newtons(repository: Path) -> None:
    assert constraint_key("worst_back_compression") == "worst_back_compression_n"
    text = (repository / "problems" / "point_grasp.toml").read_text(encoding="utf-8")
    bounded = text + "\n[constraints]\nworst_back_compression_n = { upper = 3400.0 }\n"
    source = msgspec.structs.replace(read_source(repository / "problems" / "point_grasp.toml"), text=bounded)
    (constraint,) = build_problem(source).constraints
    assert (constraint.name, constraint.unit, constraint.upper) == ("worst_back_compression", "N", 3400.0)


def test_a_person_whose_back_is_stiff_there_is_refused_in_a_sentence() -> None:
    stiff = replace(PERSON, joints=tuple(name for name in PERSON.joints if name != FLEXION))
    with pytest.raises(InputError, match=r"objectives: wanted people whose joint jL5S1_roty moves for 'wor"):
        refuse_unanswered_quantity("objectives", "worst_back_compression", *asked(), [stiff])
    refuse_unanswered_quantity("objectives", "human_torque", *asked(), [stiff])


def asked() -> tuple[ProblemFile, ProblemSource]:
    source = read_source(Path(__file__).parents[2] / "problems" / "point_grasp.toml")
    return decode_toml(source.text, source.path, ProblemFile), source
