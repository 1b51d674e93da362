"""A person in a given posture: moments computed again by sums over links, and postures found from places."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evodesign.body.placement import Placement
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.posture.results import AgentPosture
from evodesign.tree.frames import link_frames
from evodesign.validation.posed import ANGLES, MOMENTS, PosedPerson

WEIGHT = 120.0
FEATURES = {"trunk_low": 21.0, "trunk_up": 55.0, "knee": 48.0, "shank": 12.0, "arm": -6.0, "elbow": 31.0}
UPRIGHT = {"trunk_low": 2.0, "trunk_up": 4.0, "knee": 3.0, "shank": 2.0, "arm": 20.0, "elbow": 80.0}


@pytest.fixture(scope="module", params=[Sex.FEMALE, Sex.MALE], ids=str)
def person(request: pytest.FixtureRequest) -> PosedPerson:
    stature = 1.62 if request.param is Sex.FEMALE else 1.84
    return PosedPerson(Person(stature, 68.0, request.param, ShoulderWidth.JOINT_CENTRES))


@pytest.fixture(params=[FEATURES, UPRIGHT], ids=["bent", "upright"])
def posture(person: PosedPerson, request: pytest.FixtureRequest) -> AgentPosture:
    angles = {name: math.radians(value) for name, value in request.param.items()}
    return person.from_angles({**angles, "ahead": 0.21})


def centres(
    person: PosedPerson, posture: AgentPosture
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Origins of links, and their masses with their centres' places, from the tree alone."""
    c, s = math.cos(posture.base_angles[1]), math.sin(posture.base_angles[1])
    base = Placement(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)), tuple(posture.base_position.tolist()))
    frames = link_frames(person.form.agent.tree, base, posture.joints)
    origins = {name: np.array(place.translation) for name, place in frames.items()}
    bodies = {}
    for link in person.form.agent.tree.links:
        place, inertia = frames[link.name], link.inertia
        centre = np.array(place.rotation) @ np.array(inertia.center) + origins[link.name]
        bodies[link.name] = np.array([inertia.mass, *centre])
    return origins, bodies


def is_of_legs(link: str) -> bool:
    return any(part in link for part in ("Leg", "Foot", "Toe", "Sole"))


def test_moments_are_those_of_weights_above_each_joint(person: PosedPerson, posture: AgentPosture) -> None:
    """sum of m g (x - x_joint) over links above, and of the load in the palms."""
    origins, bodies = centres(person, posture)
    load = WEIGHT * (origins["LeftPalm"][0] + origins["RightPalm"][0]) / 2.0
    below = {
        "l5s1": ("L5", lambda link: is_of_legs(link) or link == "Pelvis"),
        "hips": ("LeftUpperLeg", is_of_legs),
        "knees": ("LeftLowerLeg", lambda link: is_of_legs(link) and "UpperLeg" not in link),
        "ankles": ("LeftFoot", lambda link: any(part in link for part in ("Foot", "Toe", "Sole"))),
    }
    found = person.posed(posture, WEIGHT).moments
    assert set(found) == set(MOMENTS) == set(below)
    for name, (joint, is_below) in below.items():
        at = origins[joint][0]
        above = sum(9.81 * body[0] * (body[1] - at) for link, body in bodies.items() if not is_below(link))
        assert found[name] == pytest.approx(above + load - WEIGHT * at, abs=1e-6), name


def test_a_plate_gives_the_moment_of_the_ground_less_weights_below(
    person: PosedPerson, posture: AgentPosture
) -> None:
    """Any force of the plate, not only one that balances the posture."""
    origins, bodies = centres(person, posture)
    x, z = origins["L5"][0], origins["L5"][2]
    forward, up, at = 14.0, 801.0, 0.071
    weights = sum(
        9.81 * body[0] * (body[1] - x)
        for link, body in bodies.items()
        if is_of_legs(link) or link == "Pelvis"
    )
    expected = z * forward + (at - x) * up - weights
    assert person.l5s1_from_below(posture, WEIGHT, (forward, up), at) == pytest.approx(expected, abs=1e-6)


def test_a_posture_has_the_angles_that_it_was_made_of(person: PosedPerson) -> None:
    """Of the trunk within 3 degrees: a chord's lean is not quite the mean of its links' leans."""
    angles = {name: math.radians(value) for name, value in FEATURES.items()}
    found = person.posed(person.from_angles({**angles, "ahead": 0.2}), 0.0)
    for name, value in FEATURES.items():
        assert found.angles[name] == pytest.approx(value, abs=3.0 if name.startswith("trunk") else 1e-6)
    assert found.angles["hip_flex"] == pytest.approx(
        found.angles["trunk_low"] - found.angles["shank"] + found.angles["knee"], abs=1e-9
    )
    assert found.places["ankle"][0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("with_legs", [True, False])
def test_a_posture_is_found_again_from_its_places(
    person: PosedPerson, posture: AgentPosture, with_legs: bool
) -> None:
    given = person.posed(posture, WEIGHT)
    places = {name: (x + 0.3, z) for name, (x, z) in given.places.items()}
    if not with_legs:
        places = {name: place for name, place in places.items() if name not in ("knee", "ankle")}
    found = person.posed(person.from_places(places), WEIGHT)
    assert found.moments["l5s1"] == pytest.approx(given.moments["l5s1"], abs=0.5)
    for name in ANGLES if with_legs else ("trunk_low", "trunk_up", "arm", "elbow"):
        assert found.angles[name] == pytest.approx(given.angles[name], abs=0.5), name


def test_what_legs_decide_is_left_out_where_they_were_not_measured(
    person: PosedPerson, posture: AgentPosture
) -> None:
    left = person.posed(posture, 0.0).above_legs()
    assert set(left.moments) == {"l5s1", "hips"}
    assert set(left.angles) == {"trunk_low", "trunk_up", "arm", "elbow"}
    assert not {"knee", "ankle"} & set(left.places)
