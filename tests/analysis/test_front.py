import subprocess
import sys

from hypothesis import given
from hypothesis import strategies as st

from evodesign.analysis.front import RunningFront, front, minimised
from evodesign.records import Assessment, Evaluation, Objective, Sense, Status

TORQUE = Objective(name="torque", sense=Sense.MINIMISE, unit="N m")
REACH = Objective(name="reach", sense=Sense.MAXIMISE, unit="m")
MASS = Objective(name="mass", sense=Sense.MINIMISE, unit="kg")


def evaluation(number, violation=0.0, **objectives):
    assessment = Assessment(
        design={}, objectives=objectives, violation=violation, status=Status.SOLVED, reason=""
    )
    return Evaluation(
        number=number, generation=0, genome=(0.5,), assessment=assessment, seconds=0.0, worker="here"
    )


def numbers(evaluations):
    return [evaluation.number for evaluation in evaluations]


def test_maximised_values_are_negated_in_the_objectives_order():
    assessment = evaluation(0, torque=30.0, reach=1.4, mass=50.0).assessment
    assert minimised([REACH, TORQUE], assessment) == (-1.4, 30.0)


def test_an_absent_objective_leaves_nothing_to_compare():
    assert minimised([TORQUE, REACH], evaluation(0, reach=1.4).assessment) is None


def test_the_front_of_a_run_worked_by_hand():
    run = [
        evaluation(0, torque=30.0, reach=1.4),
        evaluation(1, torque=25.0, reach=1.2),
        evaluation(2, torque=31.0, reach=1.3),
        evaluation(3, torque=25.0, reach=1.1),
        evaluation(4, torque=40.0, reach=1.5),
    ]
    assert numbers(front([TORQUE, REACH], run)) == [0, 1, 4]
    assert numbers(front([TORQUE], run)) == [1]
    assert numbers(front([REACH], run)) == [4]


def test_infeasible_failed_and_incomplete_designs_are_not_on_the_front():
    run = [
        evaluation(0, violation=0.01, torque=1.0, reach=9.0),
        evaluation(1, violation=None, torque=1.0, reach=9.0),
        evaluation(2, torque=1.0),
        evaluation(3, torque=30.0, reach=1.0),
    ]
    assert numbers(front([TORQUE, REACH], run)) == [3]


def test_of_equal_designs_the_earliest_stays_whatever_the_order():
    run = [evaluation(number, torque=30.0, reach=1.0) for number in (7, 3, 5)]
    run.append(evaluation(4, torque=20.0, reach=0.5))
    assert numbers(front([TORQUE, REACH], iter(run))) == [3, 4]


def test_nothing_feasible_has_no_front():
    assert front([TORQUE], []) == ()
    assert front([TORQUE], [evaluation(0, violation=1.0, torque=1.0)]) == ()


few = st.sampled_from([0.0, 1.0, 2.0, 3.0])
designs = st.builds(
    lambda violation, values: (violation, values),
    st.sampled_from([0.0, 0.0, 0.0, 0.2, None]),
    st.fixed_dictionaries({"torque": few, "reach": few}, optional={"mass": few}),
)


@given(st.lists(designs, max_size=14), st.sampled_from([(TORQUE,), (TORQUE, REACH), (REACH, TORQUE, MASS)]))
def test_the_front_is_what_no_design_dominates(drawn, objectives):
    def better(objective, a, b):
        a, b = a.assessment.objectives[objective.name], b.assessment.objectives[objective.name]
        return a < b if objective.sense is Sense.MINIMISE else a > b

    def dominates(a, b):
        return any(better(o, a, b) for o in objectives) and not any(better(o, b, a) for o in objectives)

    def equal(a, b):
        return not any(better(o, a, b) or better(o, b, a) for o in objectives)

    run = [evaluation(number, violation, **values) for number, (violation, values) in enumerate(drawn)]
    takes_part = [
        one
        for one in run
        if one.assessment.violation == 0.0 and all(o.name in one.assessment.objectives for o in objectives)
    ]
    expected = [
        one.number
        for one in takes_part
        if not any(dominates(other, one) for other in takes_part)
        and not any(equal(other, one) and other.number < one.number for other in takes_part)
    ]
    assert numbers(front(objectives, reversed(run))) == expected


def test_fronts_are_found_without_robots():
    script = (
        "import sys\n"
        "import evodesign.analysis.front, evodesign.analysis.hypervolume\n"
        "print([name for name in ('casadi', 'pinocchio', 'pymoo', 'cma') if name in sys.modules])\n"
    )
    done = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


@given(st.lists(designs, max_size=14), st.sampled_from([(TORQUE,), (TORQUE, REACH), (REACH, TORQUE, MASS)]))
def test_a_design_enters_the_running_front_when_none_before_dominates_it(drawn, objectives):
    run = [evaluation(number, violation, **values) for number, (violation, values) in enumerate(drawn)]
    running = RunningFront(objectives)
    for count, newest in enumerate(run, 1):
        unequal = [
            one for one in run[: count - 1] if values_of(one, objectives) != values_of(newest, objectives)
        ]
        assert running.enters(newest) == (newest in front(objectives, [*unequal, newest]))


def values_of(one, objectives):
    return [one.assessment.objectives.get(objective.name) for objective in objectives]
