"""Starts of lifts: motions of one solve put beside other robots, and portfolios of them."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from evodesign.evaluation.precompute import precompute_setting
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.motion import lift_starts as trained
from evodesign.motion.lift_program import LiftProgram, LiftStart
from evodesign.motion.lift_starts import lift_portfolio
from evodesign.motion.lifting import MOVED, _ends, lift_program, lift_starts
from evodesign.motion.solution import LiftSolution
from evodesign.nlp.method import Ending
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.pieces import encoded_piece, with_piece
from evodesign.posture.precompute.plan import Piece, Subject, lift_pieces
from evodesign.posture.precompute.precomputed import NOTHING_PRECOMPUTED
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.posture.seeking.start_training import Training
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status
from evodesign.tasks import Lift
from tests.motion.lifted import LIFT, Lifted


@pytest.fixture(scope="module")
def program(lifted: Lifted) -> LiftProgram:
    return lift_program(lifted.setting, LIFT.knots, symmetric=True)


@pytest.fixture(scope="module")
def found(solution: LiftSolution) -> LiftStart:
    """The solution, which may have more knots than were asked for, as a start."""
    assert solution.start is not None
    assert solution.ending is not None
    return replace(solution.start, symbols=solution.ending.symbols)


def test_both_agents_motions_are_a_start_but_for_the_load(
    lifted: Lifted, solution: LiftSolution, found: LiftStart
) -> None:
    own = lift_program(lifted.setting, solution.lift.knots, symmetric=True)
    blank = replace(found, symbols=np.zeros_like(found.symbols), hands=np.zeros_like(found.hands))
    moved = own.beside(own.beside(blank, own.motion_of(ROBOT, found)), own.motion_of(HUMAN, found))
    left = np.flatnonzero(np.abs(moved.symbols - found.symbols) > 1e-12)
    assert len(left) == solution.lift.knots, "the coefficients of the load's height"
    assert moved.hands.tolist() == found.hands.tolist()


def test_a_motion_of_other_knots_has_the_same_values_at_them(
    program: LiftProgram, lifted: Lifted, found: LiftStart, solution: LiftSolution
) -> None:
    own = lift_program(lifted.setting, solution.lift.knots, symmetric=True)
    finer = msgspec.structs.replace(solution.lift, knots=2 * solution.lift.knots - 1)
    other = lift_program(lifted.setting, finer.knots, symmetric=True)
    blank = other.followed(finer, lifted.hold(finer.from_m).postures, 0, lifted.design)
    moved = other.beside(blank, own.motion_of(HUMAN, found))
    course, again = own.course(solution.lift, found.symbols), other.course(finer, moved.symbols)
    for one, two in zip(
        course.instants(solution.lift.knot_times), again.instants(solution.lift.knot_times), strict=True
    ):
        assert one.postures[HUMAN].joints == pytest.approx(two.postures[HUMAN].joints, abs=1e-9)
        assert one.postures[HUMAN].torques == pytest.approx(two.postures[HUMAN].torques, abs=1e-9)


def test_a_robot_that_is_moved_by_nothing_begins_at_its_hold(
    program: LiftProgram, lifted: Lifted, found: LiftStart
) -> None:
    ends = [lifted.hold(height).postures for height in LIFT.heights]
    person = program.motion_of(HUMAN, program.followed(LIFT, ends[1], LIFT.knots - 1, lifted.design))
    still = {**person, MOVED: np.array([1.0, *np.zeros(3 + len(ends[1][ROBOT].joints))])}
    begun = lift_starts(program, LIFT, ends, lifted.design, [person, still])
    assert [*begun] == [
        "hold at the beginning, start 1",
        "hold at the end, start 1",
        "hold at the end, moved, start 2",
    ]
    moved, unmoved = begun["hold at the end, moved, start 2"], begun["hold at the end, start 1"]
    assert moved.symbols == pytest.approx(unmoved.symbols, abs=1e-6)


def test_a_hold_is_a_start_where_no_other_one_begins(
    program: LiftProgram, lifted: Lifted, found: LiftStart
) -> None:
    ends = [lifted.hold(height).postures for height in LIFT.heights]
    person = program.motion_of(HUMAN, found)
    moved = {**person, MOVED: np.array([1.0, *np.zeros(3 + len(ends[1][ROBOT].joints))])}
    both = ["hold at the beginning", "hold at the end"]
    for known, holds in (([], both), ([moved], both[:1]), ([person], []), ([moved, person], [])):
        begun = lift_starts(program, LIFT, ends, lifted.design, [*known, {}])
        assert [name for name in begun if name in both] == holds


@pytest.mark.slow
def test_a_chosen_start_leads_to_no_worse_a_lift_than_the_holds(
    lifted: Lifted, problem: DesignProblem, solution: LiftSolution, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trained, "TRAINING", Training(designs=1, begun=1, random=0, offers=1, portfolio=1))
    lift = LIFT.coarse
    compiled = replace(precompute_setting(problem), options=lifted.setting.options)
    portfolio = lift_portfolio(compiled, ("", ""), lift, NOTHING_PRECOMPUTED)
    assert portfolio.coverage.designs == 1
    known = with_piece(NOTHING_PRECOMPUTED, piece_of(problem, lift), encoded_piece(portfolio))
    assert known is not None
    chosen = known.lift_starts(("", ""), lift)
    assert len(chosen) == 1
    holds = [lifted.hold(height) for height in lift.heights]
    better = lifted.lifts.solve(lifted.design, lift, holds, lifted.robot, lifted.human, known=chosen)
    assert better.solved, better.reason
    begun = {each.start: each for each in better.attempts}
    assert [*begun][:2] == ["hold at the beginning, start 1", "hold at the end, start 1"]
    costs = [begun[name].cost for name in begun if "start 1" in name and begun[name].status is Status.SOLVED]
    before = [each.cost for each in solution.attempts if each.status is Status.SOLVED]
    assert min(costs) <= 1.01 * min(before)


def test_starts_of_a_lift_serve_any_number_of_knots(problem: DesignProblem) -> None:
    fine, coarse = Lift(0.8, 1.2, 1.5, knots=24), Lift(0.8, 1.2, 1.5)
    assert lift_pieces(precompute_setting(problem), [fine, coarse]) == [piece_of(problem, coarse)]
    content = encoded_piece(StartPortfolio(({"human.joints": [1.0]},), NOTHING_PRECOMPUTED.highest.coverage))
    known = with_piece(NOTHING_PRECOMPUTED, piece_of(problem, coarse), content)
    assert known is not None
    assert known.lift_starts(("", ""), fine) == ({"human.joints": [1.0]},)
    assert known.lift_starts(("", ""), Lift(0.8, 1.3, 1.5)) == ()


def test_starts_of_a_lift_are_kept_for_problems_of_the_same_holds(problem: DesignProblem) -> None:
    setting, piece = precompute_setting(problem), piece_of(problem, Lift(0.8, 1.2, 1.5))
    other = replace(setting, tasks=(*setting.tasks, Hold(height_m=1.05)))
    assert key_of(other, piece) != key_of(setting, piece)
    assert key_of(replace(setting, weights=setting.weights), piece) == key_of(setting, piece)


def piece_of(problem: DesignProblem, lift: Lift) -> Piece:
    return Piece(Subject.LIFT, problem.scene.pair, lift)


class Slow:
    """A program whose solves take as many iterations as their starts' names have letters, at most `most`."""

    def __init__(self, most: int) -> None:
        self.asked: list[tuple[str, bool]] = []
        self._most = most

    def solve(
        self, lift: Lift, start: str, design: object, mass: float, *, briefly: bool
    ) -> tuple[Ending, float]:
        self.asked.append((start, briefly))
        limit, nothing = 2 if briefly else self._most, np.zeros(0)
        word = "Solve_Succeeded" if len(start) <= limit else "Maximum_Iterations_Exceeded"
        return Ending(nothing, 1.0, word, min(len(start), limit), nothing, nothing, nothing), 0.0


def test_starts_that_take_long_are_given_up_unless_all_do() -> None:
    some, none = Slow(9), Slow(3)
    found = _ends(some, LIFT, {name: name for name in ("a", "long")}, (), 5.0)  # type: ignore[arg-type]
    assert [each.solved for each in found.values()] == [True, False]
    assert some.asked == [("a", True), ("long", True)]
    found = _ends(none, LIFT, {name: name for name in ("abc", "long")}, (), 5.0)  # type: ignore[arg-type]
    assert [(each.solved, each.ending.iterations) for each in found.values()] == [(True, 3), (False, 3)]
    assert none.asked[2:] == [("abc", False), ("long", False)]
