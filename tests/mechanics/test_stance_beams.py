"""What links transmit in load cases: wrenches that keep the robot at rest, and the torques of its joints."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pinocchio as pin
import pytest
import scipy

from evodesign.errors import ModelError
from evodesign.hardware.structure import STRENGTHS
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.link_beams import virtual_work, weights
from evodesign.mechanics.stance_beams import impact, stance_safety, standing
from evodesign.mechanics.stance_case import StanceCase, StanceTorques
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.tree.equip import actuators_of
from evodesign.tree.frames import link_frames
from evodesign.tree.model import Tree
from tests.mechanics.test_link_beams import HANDS, LOWER, SOLES, TUBE, UPPER, arms, bent
from tests.problem.test_standing_cases import HOLD, ON_ONE_LEG, PUSH, at_rest, stood, with_cases


@pytest.mark.parametrize(
    ("text", "name"), [("", "one leg"), (HOLD, "tray"), (PUSH, "shove"), (ON_ONE_LEG, "bumped")]
)
def test_wrenches_hold_the_robot_as_pinocchio_says(repository: Path, text: str, name: str) -> None:
    """The recursive Newton-Euler algorithm leaves nothing at the base and the case's torques at joints."""
    tree, case, found = stood(with_cases(repository, text), name)
    base, _, wrenches = standing(tree, case, found)
    model, data, q = at_rest(tree, case, found)
    assert np.array(base.rotation) == pytest.approx(np.array(pin.Quaternion(q[3:7]).matrix()), abs=1e-9)
    outside = [pin.Force.Zero() for _ in range(model.njoints)]
    for frame, force, moment in wrenches:
        number = model.getFrameId(frame)
        carrier = model.frames[number].parentJoint
        place = data.oMf[number].translation - data.oMi[carrier].translation
        turn = np.array(data.oMi[carrier].rotation).T
        outside[carrier] += pin.Force(turn @ force, turn @ (moment + np.cross(place, force)))
    still = np.zeros(model.nv)
    rows = np.array(pin.rnea(model, data, q, still, still, outside))
    assert np.abs(rows[:6]).max() < 1e-6
    for joint, torque in found.torques.items():
        assert rows[model.joints[model.getJointId(joint)].idx_v] == pytest.approx(torque, abs=1e-6)
    assert stance_safety(tree, case, found)


def fall(height: float, force: float) -> tuple[StanceCase, StanceTorques]:
    """Loads [N] that fall into the hands of two arms."""
    loads = tuple((hand, (0.0, 0.0, -force)) for hand in HANDS)
    case = StanceCase("box", {}, SOLES, (), 1.0, loads=loads, dropped=height)
    return case, StanceTorques({}, feet=((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))


def test_a_load_that_falls_asks_what_a_spring_of_finite_elements_says() -> None:
    """Motion of a mass on a spring from the moment at which it is met, integrated over time by SciPy."""
    height, force = 0.1, 25.0
    softness = -bent(0.0, np.array([0.0, -force]))[1] / force
    mass, speed = force / GRAVITY, math.sqrt(2.0 * GRAVITY * height)
    turned = scipy.integrate.solve_ivp(
        lambda _, state: [state[1], GRAVITY - state[0] / softness / mass],
        (0.0, 0.1),
        [0.0, speed],
        events=lambda _, state: state[1],
        rtol=1e-10,
        atol=1e-12,
    )
    lowest = float(turned.y_events[0][0][0])
    case, found = fall(height, force)
    times, _ = impact(arms(), case, found)
    assert times == pytest.approx(lowest / softness / force, rel=1e-6)
    own = float(arms().link_by_name["l_lower"].mass) * GRAVITY
    moment = times * force * (UPPER + LOWER) + own * (UPPER + LOWER / 2)
    strength = STRENGTHS["aluminium_6061"].strength * TUBE.second_moments[0] / 0.04
    assert stance_safety(arms(), case, found)["l_upper"].factor == pytest.approx(strength / moment)


def test_nothing_falls_onto_what_does_not_give_way() -> None:
    case, found = fall(0.1, 25.0)
    rigid = Tree("arms", tuple(replace(link, solids=()) for link in arms().links), arms().joints)
    with pytest.raises(ModelError, match=r"load case 'box'.*give way"):
        impact(rigid, case, found)


def test_a_robot_that_lands_on_a_foot_winds_up_its_gears_by_its_torques_at_rest(repository: Path) -> None:
    """tau^2 / k of pinocchio's gravity torques over the weight, and n from the sum with what beams give."""
    landing = 'name = "one leg"\ndropped_from_m = 0.05'
    source = read_source(repository / "problems" / "icub_hardware.toml")
    text = source.text.replace('name = "one leg"', landing)
    tree, case, found = stood(build_problem(msgspec.structs.replace(source, text=text)), "one leg")
    base, joints, _ = standing(tree, case, found)
    places = link_frames(tree, base, joints)
    weight = GRAVITY * float(tree.mass)
    load = list(weights(tree, places))
    unit = [(frame, force / weight, moment / weight) for frame, force, moment in load]
    given_way = virtual_work(tree, places, load, unit, case.soles)
    for joint, actuator in actuators_of(tree).items():
        wound = found.torques[joint] ** 2 / float(actuator.stiffness) / weight
        assert given_way.windup[joint] == pytest.approx(wound, rel=1e-6, abs=1e-12)
    times, _ = impact(tree, case, found)
    assert times == pytest.approx(1.0 + math.sqrt(1.0 + 0.1 / given_way.total))
    still = stance_safety(tree, replace(case, dropped=0.0), found)
    for link, safety in stance_safety(tree, case, found).items():
        assert safety.factor == pytest.approx(still[link].factor / times), link
