import msgspec
import pytest

from evodesign.analysis.conditions import all_conditions, conditions, meeting, quantities
from evodesign.errors import InputError
from evodesign.records import Parameter
from tests.analysis.designs import numbers
from tests.runlog.toys import toy_evaluations, toy_header

HEADER = toy_header(dimension=3)
RUN = toy_evaluations(HEADER, 40)
KNOWN = quantities(HEADER, RUN[0])


def chosen(text):
    return numbers(meeting(RUN, conditions(text, KNOWN, "--where")))


def by_hand(wanted):
    return [each.number for each in RUN if wanted(each.assessment)]


def test_every_kind_of_number_can_be_asked_for():
    assert chosen("reach_height >= 1.5") == by_hand(lambda a: a.objectives["reach_height"] >= 1.5)
    assert chosen("arm.1 < 1.1") == by_hand(lambda a: a.design["arm.1"] < 1.1)
    assert chosen("highest_reach > 1.5") == by_hand(lambda a: a.reach.highest_m > 1.5)
    assert chosen("robot_torque@1 <= 35") == by_hand(
        lambda a: a.cases[0].robot_torque_norm is not None and a.cases[0].robot_torque_norm <= 35.0
    )
    assert 0 < len(chosen("robot_torque@1 <= 35")) < len(RUN)


def test_conditions_joined_by_and_hold_together():
    both = chosen("reach_height>=1.2 and robot_torque < 40")
    assert both == by_hand(
        lambda a: a.objectives["reach_height"] >= 1.2 and a.objectives.get("robot_torque", 99.0) < 40.0
    )
    assert both


def test_several_texts_hold_together_as_those_joined_by_and_do():
    texts = ["reach_height>=1.2", "robot_torque < 40 and arm.1 < 1.5"]
    found = all_conditions(texts, KNOWN, "where")
    assert found == conditions(" and ".join(texts), KNOWN, "where")
    assert all_conditions([], KNOWN, "where") == ()
    with pytest.raises(InputError, match="where: wanted a condition, or a list of conditions, found 3"):
        all_conditions(["reach_height>=1.2", 3], KNOWN, "where")


def test_a_number_that_does_not_exist_meets_no_condition():
    absent = by_hand(lambda a: "robot_torque" not in a.objectives)
    assert absent
    assert not set(absent) & set(chosen("robot_torque < 1e9"))
    assert not set(absent) & set(chosen("robot_torque > -1e9"))
    assert chosen("lowest_reach > 0") == []


@pytest.mark.parametrize(
    "text", ["", "reach_height", "reach_height = 1.5", "reach_height >= high",
             "reach_height >= nan", "reach_height >= 1 and"],
)  # fmt: skip
def test_what_is_no_condition_is_refused_in_one_sentence(text):
    with pytest.raises(InputError, match=r"^--where: wanted NAME < \| <= \| > \| >= NUMBER"):
        conditions(text, KNOWN, "--where")


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(InputError, match="did you mean 'reach_height'"):
        conditions("reach_heigth >= 1", KNOWN, "--where")
    with pytest.raises(InputError, match="did you mean 'reach_height'"):
        conditions("1.5 <= reach_height < 2", KNOWN, "--where")


def test_a_name_may_hold_signs_and_spaces():
    name = "length.<b>x & y</b>"
    header = msgspec.structs.replace(
        HEADER, parameters=(Parameter(name=name, lower=0.0, upper=1.0, unit="1"),)
    )
    (condition,) = conditions(f"{name} >= 0.5", quantities(header, None), "--where")
    assert condition.name == name


def test_a_condition_reads_as_it_was_written():
    (condition,) = conditions(" reach_height>=1.50", KNOWN, "--where")
    assert str(condition) == "reach_height >= 1.5"
