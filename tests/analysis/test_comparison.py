from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.comparison import best_designs, compare
from evodesign.analysis.front import front
from evodesign.analysis.hypervolume import PLACES, best, curve, hypervolume, reference_point
from evodesign.records import Objective, Sense
from evodesign.runlog.run import RunLog
from tests.runlog.toys import toy_evaluations, toy_header


def run(seed=1, count=30, algorithm="toy", name="toy", text="", objectives=None):
    header = toy_header(seed=seed)
    header = msgspec.structs.replace(
        header,
        problem_name=name,
        problem=msgspec.structs.replace(header.problem, text=text),
        search=msgspec.structs.replace(header.search, algorithm=algorithm),
        objectives=header.objectives if objectives is None else objectives,
    )
    evaluations = tuple(toy_evaluations(header, count))
    place = Path(f"{algorithm}-{seed}")
    return RunLog(place, header, evaluations, (), (), (), complete=True, notes=())


RUNS = [run(1), run(2), run(3, count=50), run(1, algorithm="other", count=40)]
OBJECTIVES = RUNS[0].header.objectives


def test_runs_are_measured_on_one_reference_after_equally_many_evaluations():
    (found,) = compare(RUNS)
    everything = [each for one in RUNS for each in one.evaluations]
    assert found.reference == reference_point(OBJECTIVES, everything)
    assert found.evaluations == 30
    for compared, one in zip(found.runs, RUNS, strict=True):
        counted = one.evaluations[:30]
        assert compared.run is one
        assert compared.hypervolume == hypervolume(OBJECTIVES, counted, found.reference)
        assert compared.best == best(OBJECTIVES, counted)
        assert compared.front == front(OBJECTIVES, counted)
    union = [each for one in RUNS for each in one.evaluations[:30]]
    whole = hypervolume(OBJECTIVES, union, found.reference)
    assert [each.share for each in found.runs] == pytest.approx(
        [each.hypervolume / whole for each in found.runs]
    )
    assert any("only the first 30 evaluations" in note for note in found.notes)


def test_runs_that_differ_in_their_seed_alone_are_one_search():
    (found,) = compare(RUNS)
    assert {name: len(members) for name, members in found.searches.items()} == {"toy 4": 3, "other 4": 1}
    (test,) = found.tests
    assert test.samples == ("toy 4", "other 4")
    assert test.p is None


def test_problems_stand_side_by_side_under_their_names():
    (found,) = compare([run(1), run(1, name="other problem")])
    assert list(found.searches) == ["toy: toy 4", "other problem: toy 4"]


def test_a_changed_problem_of_the_same_name_is_another_search():
    (found,) = compare([run(1), run(1, text="changed"), run(2, text="changed")])
    assert {name: len(members) for name, members in found.searches.items()} == {"toy 4": 1, "toy 4 (2)": 2}


def test_the_same_seed_counts_once():
    (found,) = compare([run(1), run(1), run(2)])
    assert any("seed 1 of toy 4 came before" in note for note in found.notes)


def test_other_objectives_make_another_comparison():
    mass = (Objective(name="reach_height", sense=Sense.MAXIMISE, unit="m"),)
    first, second = compare([run(1), run(1, objectives=mass), run(2)])
    assert len(first.runs) == 2
    assert len(second.runs) == 1
    assert second.attainments == ()


def test_without_feasible_designs_nothing_is_measured():
    one = run(1)
    infeasible = tuple(each for each in one.evaluations if not each.feasible)
    bare = RunLog(one.directory, one.header, infeasible, (), (), (), complete=True, notes=())
    empty = RunLog(Path("empty"), one.header, (), (), (), (), complete=True, notes=())
    (found,) = compare([bare, empty])
    assert found.reference is None
    assert [each.hypervolume for each in found.runs] == [None, None]
    assert found.tests == ()
    assert best_designs(found) == ()


def test_best_designs_are_those_of_all_runs_together():
    (found,) = compare(RUNS)
    designs = best_designs(found)
    everything = [each for one in RUNS for each in one.evaluations[:30]]
    expected = best(OBJECTIVES, everything)
    for each in designs[:2]:
        name = each.reason.removeprefix("best ")
        assert each.evaluation.assessment.objectives[name] == expected[name]
        assert each.evaluation in each.run.run.evaluations
    assert {each.reason for each in designs[2:]} == {"knee"}


@pytest.mark.parametrize("count", [0, 1, 7, 200])
def test_a_curve_holds_what_was_best_after_so_many_evaluations(count):
    evaluations = run(3, count=200).evaluations[:count]
    reference = {"robot_torque": 60.0, "reach_height": 0.9}
    found = curve(OBJECTIVES, evaluations, reference)
    assert len(found.evaluations) == min(count, PLACES)
    assert found.evaluations[-1:] == ((count,) if count else ())
    for place, volume, torque in zip(
        found.evaluations, found.hypervolume, found.best["robot_torque"], strict=True
    ):
        assert volume == pytest.approx(hypervolume(OBJECTIVES, evaluations[:place], reference))
        assert torque == best(OBJECTIVES, evaluations[:place]).get("robot_torque")
