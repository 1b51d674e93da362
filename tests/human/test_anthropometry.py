"""The tables, and the segments that follow from them, against sums and figures written out by hand."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evodesign.errors import InputError
from evodesign.human.anthropometry import PAIRED_SEGMENTS, SEGMENTS, Person, landmarks, segments, sole_size
from evodesign.human.anthropometry_tables import Sex, tables

persons = st.builds(Person, st.floats(1.45, 2.05), st.floats(40.0, 140.0), st.sampled_from(Sex))
few = settings(max_examples=25, deadline=None)


@pytest.mark.parametrize(("sex", "whole"), [(Sex.MALE, 1.0000), (Sex.FEMALE, 0.9999)])
def test_mass_fractions_of_the_table_sum_to_a_whole_person(sex: Sex, whole: float) -> None:
    rows = tables().de_leva.of(sex).segments
    assert set(rows) == set(SEGMENTS) == set(tables().de_leva.end_points)
    assert sum(row.mass * (2 if name in PAIRED_SEGMENTS else 1) for name, row in rows.items()) == (
        pytest.approx(whole, abs=1e-12)
    )


@few
@given(persons)
def test_segments_weigh_what_the_person_weighs(person: Person) -> None:
    parts = segments(person)
    mass = math.fsum(parts[name].mass * (2 if name in PAIRED_SEGMENTS else 1) for name in parts)
    assert mass == pytest.approx(person.mass, rel=1e-12)


def test_fractions_of_the_standing_chain_sum_to_one() -> None:
    length = tables().lengths
    chain = (length.ankle_height, length.shank, length.thigh, length.trunk, length.neck, length.head)
    assert math.fsum(chain) == pytest.approx(1.0, abs=1e-15)
    assert length.ankle_height + length.shank + length.thigh == pytest.approx(0.530, abs=1e-15)


@pytest.mark.parametrize(
    ("sex", "length", "mass", "centre", "within", "radii"),
    [
        (Sex.MALE, 0.5319, 0.4346, 0.4486, 0.006, (0.372, 0.347, 0.191)),
        (Sex.FEMALE, 0.5293, 0.4257, 0.4151, 0.0005, (0.357, 0.339, 0.171)),
    ],
)
def test_three_trunk_segments_join_to_the_trunk_row_of_the_same_table(
    sex: Sex, length: float, mass: float, centre: float, within: float, radii: tuple[float, float, float]
) -> None:
    """The row "trunk, suprasternale to mid-hip" is not used by the code: it checks centres, axes and radii.

    Its radii agree to the digits printed. Its centre does so for women; the printed centre of the men's
    trunk lies 2.9 mm above that of the three printed parts.
    """
    stature = tables().de_leva.of(sex).stature_m
    parts = [segments(Person(stature, 100.0, sex))[f"{part}_trunk"] for part in ("upper", "middle", "lower")]
    masses = np.array([part.mass for part in parts])
    heights = np.array([part.center[2] for part in parts])
    center = masses @ heights / masses.sum()
    own = np.array([np.diag(part.about_center) for part in parts]).sum(axis=0)
    joined = own + masses @ (heights - center) ** 2 * np.array([1.0, 1.0, 0.0])
    assert masses.sum() == pytest.approx(100.0 * mass, rel=2e-4)
    assert length - center == pytest.approx(centre * length, abs=within * length)
    assert np.sqrt(joined / masses.sum()) / length == pytest.approx(radii, abs=0.0006)


Row = tuple[float, float, tuple[float, float, float]]
"""Mass, centre, and radii about our x, y, z in the T-pose, read from the printed table."""

PRINTED: dict[Sex, dict[str, Row]] = {
    Sex.MALE: {
        "thigh": (0.1416, 0.4095, (0.329, 0.329, 0.149)),
        "shank": (0.0433, 0.4395, (0.251, 0.246, 0.102)),
        "upper_arm": (0.0271, 0.5772, (0.285, 0.158, 0.269)),
        "forearm": (0.0162, 0.4574, (0.265, 0.121, 0.276)),
        "hand": (0.0061, 0.3624, (0.235, 0.184, 0.288)),
        "foot": (0.0137, 0.4415, (0.124, 0.245, 0.257)),
    },
    Sex.FEMALE: {
        "thigh": (0.1478, 0.3612, (0.369, 0.364, 0.162)),
        "shank": (0.0481, 0.4352, (0.267, 0.263, 0.092)),
        "upper_arm": (0.0255, 0.5754, (0.278, 0.148, 0.260)),
        "forearm": (0.0138, 0.4559, (0.257, 0.094, 0.261)),
        "hand": (0.0056, 0.3427, (0.208, 0.154, 0.244)),
        "foot": (0.0129, 0.4014, (0.139, 0.279, 0.299)),
    },
}


@pytest.mark.parametrize(("sex", "whole"), [(Sex.MALE, 1.0), (Sex.FEMALE, 0.9999)])
def test_limbs_are_those_worked_out_from_the_printed_figures(sex: Sex, whole: float) -> None:
    """First end point, direction and length of each limb, from the fractions of stature alone."""
    h, m = 1.8, 80.0
    parts = segments(Person(h, m, sex))
    outward, down, forward = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    course = {
        "thigh": ((0.0, 0.05, 0.0), down, 0.245),
        "shank": ((0.0, 0.05, -0.245), down, 0.246),
        "upper_arm": ((0.0, 0.1295, 0.288), outward, 0.186),
        "forearm": ((0.0, 0.1295 + 0.186, 0.288), outward, 0.146),
        "hand": ((0.0, 0.1295 + 0.186 + 0.146, 0.288), outward, 0.108),
        "foot": ((-0.25 * 0.152, 0.05, -0.530 + 0.0195), forward, 0.152),
    }
    for name, (start, direction, length) in course.items():
        fraction, centre, radii = PRINTED[sex][name]
        mass = fraction / whole * m
        assert parts[name].mass == pytest.approx(mass, rel=1e-12), name
        center = (np.array(start) + centre * length * direction) * h
        assert np.array(parts[name].center) == pytest.approx(center, abs=1e-12), name
        moments = mass * (np.array(radii) * length * h) ** 2
        assert np.array(parts[name].about_center) == pytest.approx(np.diag(moments), abs=1e-15), name


@pytest.mark.parametrize(
    ("sex", "segment", "length", "centre", "other_length", "other_centre"),
    [
        (Sex.MALE, "shank", 0.4403, 0.4395, 0.4340, 0.4459),
        (Sex.FEMALE, "shank", 0.4386, 0.4352, 0.4323, 0.4416),
        (Sex.MALE, "forearm", 0.2689, 0.4574, 0.2669, 0.4608),
        (Sex.FEMALE, "forearm", 0.2643, 0.4559, 0.2624, 0.4592),
        (Sex.MALE, "hand", 0.1879, 0.3624, 0.0862, 0.7900),
        (Sex.FEMALE, "hand", 0.1701, 0.3427, 0.0780, 0.7474),
    ],
)
def test_rows_are_those_of_our_end_points(
    sex: Sex, segment: str, length: float, centre: float, other_length: float, other_centre: float
) -> None:
    """The table has a second row for other end points; only with its own length is a row's centre right."""
    assert tables().de_leva.of(sex).segments[segment].centre == centre
    assert centre * length == pytest.approx(other_centre * other_length, abs=1e-4)


@pytest.mark.parametrize("sex", Sex)
def test_head_rows_with_other_end_points_agree(sex: Sex) -> None:
    """The row "vertex to cervicale" (0.2429 and 0.2437 m) is not used: it must give the same head."""
    length, centre, radii = {
        Sex.MALE: (0.2429, 0.5002, (0.303, 0.315, 0.261)),
        Sex.FEMALE: (0.2437, 0.4841, (0.271, 0.295, 0.261)),
    }[sex]
    person = Person(tables().de_leva.of(sex).stature_m, 70.0, sex)
    head = segments(person)["head"]
    below_vertex = landmarks(person)["Vertex"][2] - head.center[2]
    assert below_vertex == pytest.approx(centre * length, abs=1e-4)
    found = np.sqrt(np.diag(head.about_center) / head.mass)
    assert found == pytest.approx(np.array(radii) * length, rel=3e-3)


@few
@given(persons)
def test_spine_has_three_lumbar_and_four_thoracic_segments_between_navel_and_xiphion(person: Person) -> None:
    z = {name: point[2] for name, point in landmarks(person).items()}
    u, t = (z["T12"] - z["L3"]) / 3.0, (z["T8"] - z["T12"]) / 4.0
    assert t == pytest.approx(0.75 * u, rel=1e-12)
    below = z["L3"] - 0.060 * person.stature if person.sex is Sex.MALE else 2.0 * u
    assert z["L3"] - z["L5"] == pytest.approx(below, rel=1e-12)
    assert 0.0 < z["L5"] < z["L3"] < z["T12"] < z["T8"] < z["Neck"] < z["Head"] < z["Vertex"]


@pytest.mark.parametrize(("sex", "share"), [(Sex.MALE, 0.4587), (Sex.FEMALE, 0.4585)])
def test_palm_is_at_the_third_metacarpal(sex: Sex, share: float) -> None:
    """De Leva gives the lengths too: wrist to metacarpal 86.2 and 78.0 mm, to dactylion 187.9 and 170.1."""
    points = landmarks(Person(1.7, 65.0, sex))
    reach = math.dist(points["LeftPalm"], points["LeftHand"])
    assert reach / (0.108 * 1.7) == pytest.approx(share, abs=5e-5)
    assert share == pytest.approx({Sex.MALE: 86.2 / 187.9, Sex.FEMALE: 78.0 / 170.1}[sex], abs=5e-4)


def test_soles_grow_with_stature() -> None:
    assert sole_size(Person(2.0, 80.0, Sex.MALE)) == pytest.approx((0.304, 0.110))


@pytest.mark.parametrize(
    ("stature", "mass", "key"),
    [
        (1.449, 70.0, "stature_m"),
        (2.051, 70.0, "stature_m"),
        (float("nan"), 70.0, "stature_m"),
        (1.7, 39.9, "mass_kg"),
        (1.7, 140.1, "mass_kg"),
        (1.7, float("inf"), "mass_kg"),
    ],
)
def test_a_person_outside_the_tables_is_refused_by_name(stature: float, mass: float, key: str) -> None:
    with pytest.raises(InputError) as refusal:
        Person(stature, mass, Sex.MALE)
    assert (refusal.value.source, refusal.value.key) == ("human", key)


def test_every_table_names_its_source() -> None:
    figures = tables()
    for table in (
        figures.accepted,
        figures.lengths,
        figures.foot,
        figures.trunk,
        figures.looks,
        figures.de_leva,
        figures.articulation,
    ):
        assert len(table.source) > 20
