from evodesign.analysis.choice import Choice, Order, choose
from evodesign.analysis.conditions import conditions, quantities
from evodesign.analysis.front import front
from tests.analysis.designs import numbers
from tests.runlog.toys import toy_evaluations, toy_header

HEADER = toy_header(dimension=3)
RUN = toy_evaluations(HEADER, 60)
WHOLE = front(HEADER.objectives, RUN)


def chosen(**wishes):
    return choose(HEADER.objectives, RUN, Choice(**wishes))


def test_without_wishes_the_whole_front_comes_best_first_in_its_first_objective():
    found = chosen()
    torques = [each.assessment.objectives["robot_torque"] for each in found.designs]
    assert torques == sorted(torques)
    assert sorted(numbers(found.designs)) == numbers(WHOLE)
    assert len(WHOLE) > 3


def test_a_limit_cuts_the_end_and_says_what_there_was():
    found = chosen(limit=2)
    assert found.designs == chosen().designs[:2]
    assert found.found == len(WHOLE)
    assert found.front == WHOLE


def test_a_condition_is_a_constraint_of_the_front():
    where = conditions("arm.1 > 1.3 and robot_torque < 50", quantities(HEADER, RUN[0]), "--where")
    meeting = [
        each
        for each in RUN
        if each.assessment.design["arm.1"] > 1.3
        and each.assessment.objectives.get("robot_torque", 99.0) < 50.0
    ]
    found = chosen(where=where)
    assert found.front == front(HEADER.objectives, meeting)
    assert not set(numbers(found.front)) <= set(numbers(WHOLE)), "one that only a forbidden design beats"


def test_every_order_chooses_from_the_front():
    for order in Order:
        found = chosen(order=order, aspiration={"reach_height": 1.5}, limit=3)
        assert set(numbers(found.designs)) <= set(numbers(WHOLE))
        assert 0 < len(found.designs) <= 3


def test_nothing_evaluated_leaves_nothing_to_choose():
    for order in Order:
        wish = Choice(order=order, aspiration={"reach_height": 1.5}, limit=3)
        assert choose(HEADER.objectives, [], wish).designs == ()
