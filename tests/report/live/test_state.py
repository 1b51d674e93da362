from evodesign.analysis.front import front
from evodesign.records import Status
from evodesign.report.live import state as live_state
from evodesign.report.live.state import LiveRun
from tests.analysis.designs import numbers
from tests.runlog.toys import toy_evaluations, toy_generation, toy_header

HEADER = toy_header(budget=100)
RUN = toy_evaluations(HEADER, 60)


def learnt(pieces):
    """A standing after records in pieces, one per second."""
    one, time = LiveRun(), 0.0
    for piece in pieces:
        one.learn([(record, time + index) for index, record in enumerate(piece)])
        time += len(piece)
    return one.state


def test_before_the_header_there_is_no_standing():
    assert learnt([]) is None


def test_counts_and_front_are_those_of_the_whole_run_however_it_came():
    whole = learnt([[HEADER, *RUN]])
    pieces = learnt([[HEADER], *([each] for each in RUN)])
    for state in (whole, pieces):
        assert state.done == len(RUN)
        assert state.feasible == sum(each.feasible for each in RUN)
        assert state.front == front(HEADER.objectives, RUN)
        assert state.causes == {
            Status.INFEASIBLE: sum(each.assessment.status is Status.INFEASIBLE for each in RUN)
        }
    beaten = [each for each in RUN if each.feasible and each not in whole.front]
    assert sorted(numbers(pieces.others)) == numbers(beaten)


def test_an_evaluation_that_comes_twice_counts_once():
    assert learnt([[HEADER, *RUN, *RUN[:5]]]).done == len(RUN)


def test_the_sample_of_the_others_stays_small_and_even(monkeypatch):
    monkeypatch.setattr(live_state, "SAMPLE", 10)
    others = learnt([[HEADER], *([each] for each in RUN)]).others
    assert 0 < len(others) <= 10
    assert {number % 4 for number in numbers(others)} == {0}


def test_pace_and_time_left_come_from_the_session_s_clock():
    state = learnt([[HEADER, *RUN]])
    assert state.pace == 1.0
    assert state.seconds_left == 40.0
    assert state.latest == 60.0
    resumed = learnt([[HEADER, *RUN[:50]], [HEADER, RUN[50]]])
    assert resumed.pace is None
    assert resumed.seconds_left is None


def test_generations_come_in_order():
    generations = [toy_generation(number, 4 * number + 4) for number in range(3)]
    assert learnt([[HEADER, *generations]]).generations == tuple(generations)
