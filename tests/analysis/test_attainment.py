from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.attainment import attainment_surfaces
from evodesign.analysis.front import front
from tests.analysis.designs import MASS, REACH, TORQUE, designs_at

whole = st.integers(0, 6).map(float)
runs = st.lists(st.lists(st.tuples(whole, whole), max_size=5), min_size=1, max_size=5)
PAIR = (TORQUE, REACH)


def attains(corners, place):
    """Whether some corner is nowhere worse than a place: less torque, more reach."""
    return any(torque <= place[0] and reach >= place[1] for torque, reach in corners)


@given(runs)
def test_a_surface_bounds_what_its_share_of_the_runs_attains(places):
    designs = [designs_at(PAIR, points) for points in places]
    surfaces = attainment_surfaces(PAIR, [front(PAIR, run) for run in designs])
    shares = [surface.share for surface in surfaces]
    assert shares == sorted(set(shares))
    for surface in surfaces:
        for torque in range(8):
            for reach in range(-1, 7):
                count = sum(attains(points, (torque, reach)) for points in places)
                expected = count >= surface.share * len(places) - 1e-9
                assert attains(surface.corners, (torque, reach)) == expected


def test_levels_are_one_run_half_of_them_and_all():
    run = designs_at(PAIR, [(1.0, 1.0)])
    assert [surface.share for surface in attainment_surfaces(PAIR, [run] * 4)] == [0.25, 0.5, 1.0]
    assert [surface.share for surface in attainment_surfaces(PAIR, [run])] == [1.0]
    assert [surface.share for surface in attainment_surfaces(PAIR, [run, run, []])] == [1 / 3, 2 / 3]
    assert attainment_surfaces(PAIR, [[], []]) == ()


def test_the_front_of_all_objectives_is_enough_for_two_of_them():
    three = (TORQUE, REACH, MASS)
    points = [(1.0, 1.0, 9.0), (2.0, 1.0, 1.0), (3.0, 2.0, 5.0), (3.0, 1.5, 5.0), (0.5, 0.2, 9.5)]
    run = designs_at(three, points)
    assert attainment_surfaces(PAIR, [front(three, run)]) == attainment_surfaces(PAIR, [run])
