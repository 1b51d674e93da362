"""Which of several solves becomes the posture: the cheapest that holds, or one that gets better than it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evodesign.nlp.solver import Multipliers, RawSolution
from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.candidate import Candidate, Finishing, Trial, case_solution, cheapest, checked
from evodesign.posture.terms.base import Residual
from evodesign.records import Case, Hold, Status

NOTHING = np.zeros(0)
OVERLAP = Residual("overlap", 0.01, "m", "shank and thigh apart", LimitGroup.COLLISIONS, posture_only=True)


def ended(cost: float, status: Status = Status.SOLVED) -> RawSolution:
    multipliers = Multipliers(NOTHING, NOTHING)
    return RawSolution({}, status, "", 1, 0.0, cost, NOTHING, multipliers)


def ended_at(raw: RawSolution, cost: float) -> RawSolution:
    failed = Status.SOLVED if np.isfinite(cost) else Status.ITERATION_LIMIT
    return replace(raw, cost=cost, status=failed)


class Asked:
    """Solves that get better as a table has it, and how they were asked to.

    Args:
        costs: of the better solves, by cost.
        refused: costs of what the check refuses.
        settled: what solves cost that are settled, by cost; infinite for those that fail.
        apart: costs of solves in which the check finds bodies in each other, with what they cost when these
            are apart; infinite where they cannot be.
    """

    def __init__(
        self,
        costs: dict[float, float],
        refused: tuple[float, ...] = (),
        settled: dict[float, float] | None = None,
        apart: dict[float, float] | None = None,
    ) -> None:
        self.asked: list[tuple[float, float]] = []
        self.settled: list[float] = []
        self.patient: list[bool] = []
        self.gone_on: list[float] = []
        self.cleared: list[float] = []
        self._costs, self._refused, self._settled, self._apart = costs, refused, settled or {}, apart or {}

    def trial(self, *costs: float) -> Trial:
        ends = [(f"start {number}", ended(cost)) for number, cost in enumerate(costs, 1)]
        return cheapest("joint", ends, Finishing(self.settle, self.better, self.finish, self.clear))

    def trial_with_given_up(self, solved: float, *given_up: float, early: bool = True) -> Trial:
        ends = [("start 0", ended(solved))]
        ends += [(f"start {n}", ended(cost, Status.ITERATION_LIMIT)) for n, cost in enumerate(given_up, 1)]
        go_on = self.go_on if early else None
        return cheapest("joint", ends, Finishing(self.settle, self.better, self.finish, self.clear, go_on))

    def go_on(self, raw: RawSolution) -> RawSolution:
        self.gone_on.append(raw.cost)
        return replace(raw, status=Status.SOLVED, cost=self._costs.get(raw.cost, raw.cost))

    def settle(self, raw: RawSolution, *, patient: bool) -> RawSolution:
        self.settled.append(raw.cost)
        self.patient.append(patient)
        return ended_at(raw, self._settled.get(raw.cost, raw.cost))

    def clear(self, raw: RawSolution) -> RawSolution:
        self.cleared.append(raw.cost)
        return ended_at(raw, self._apart[raw.cost])

    def better(self, raw: RawSolution, least: float) -> RawSolution:
        self.asked.append((raw.cost, round(least, 9)))
        return replace(raw, cost=self._costs.get(raw.cost, raw.cost))

    def finish(self, start: str, raw: RawSolution) -> Candidate:
        attempt = checked("joint", start, raw, ())
        if raw.cost in self._refused:
            attempt = replace(attempt, status=Status.NUMERICAL_FAILURE)
        residuals = (OVERLAP,) if raw.cost in self._apart else ()
        if residuals:
            attempt = checked("joint", start, raw, residuals)
        return Candidate(attempt, (), residuals, raw)


def best_of(trial: Trial) -> tuple[str, float]:
    assert trial.best is not None
    return trial.best.attempt.start, trial.best.raw.cost


def test_a_runner_up_that_gets_better_than_the_cheapest_takes_its_place() -> None:
    asked = Asked({10.5: 9.0})
    trial = asked.trial(10.0, 10.5, 10.2)
    assert best_of(trial) == ("start 2", 9.0)
    assert asked.asked == [(10.2, 0.2), (10.5, 0.5)], "by more than what they cost more"
    assert [attempt.cost for attempt in trial.attempts] == [10.0, 9.0, 10.2]


def test_later_runners_up_must_get_better_than_earlier_ones() -> None:
    asked = Asked({10.2: 9.5, 10.5: 9.7})
    assert best_of(asked.trial(10.0, 10.2, 10.5)) == ("start 2", 9.5)
    assert asked.asked == [(10.2, 0.2), (10.5, 1.0)]


def test_the_same_optimum_and_ones_that_cost_much_more_are_not_asked() -> None:
    asked = Asked({})
    assert best_of(asked.trial(10.0, 10.0, 10.3, 10.3, 10.0 * (1.0 + BUDGET.may_gain) + 0.1)) == (
        "start 1",
        10.0,
    )
    assert asked.asked == [(10.3, 0.3)]


def test_a_better_solve_that_the_check_refuses_is_not_taken() -> None:
    asked = Asked({10.2: 9.0}, refused=(9.0,))
    trial = asked.trial(10.0, 10.2)
    assert best_of(trial) == ("start 1", 10.0)
    assert trial.attempts[1].status is Status.NUMERICAL_FAILURE


def test_what_the_check_refuses_makes_room_for_the_next() -> None:
    asked = Asked({}, refused=(10.0, 10.1))
    assert best_of(asked.trial(10.0, 10.1, 10.2)) == ("start 3", 10.2)
    assert asked.patient == [False, False, True], "the last one that is left may take long"
    refused = Asked({}, refused=(10.0,)).trial(10.0)
    assert refused.best is None
    assert not refused.overlaps


def test_all_are_settled_where_the_best_costs_far_more_than_the_cheapest_end_promised() -> None:
    asked = Asked({}, settled={1.0: 5.0, 6.0: 2.0, 7.0: 8.0})
    assert best_of(asked.trial(1.0, 6.0, 7.0)) == ("start 2", 2.0)
    assert sorted(asked.settled) == [1.0, 6.0, 7.0]
    near = Asked({}, settled={1.0: 1.4, 6.0: 0.5})
    assert best_of(near.trial(1.0, 6.0)) == ("start 1", 1.4)
    assert near.settled == [1.0]


def test_what_was_given_up_at_a_little_less_cost_goes_on() -> None:
    asked = Asked({95.0: 96.0})
    trial = asked.trial_with_given_up(100.0, 95.0, 99.9, 101.0, 50.0)
    assert best_of(trial) == ("start 1", 96.0)
    assert asked.gone_on == [95.0], "what promises more or hardly anything does not"
    assert [attempt.status for attempt in trial.attempts[2:]] == [Status.ITERATION_LIMIT] * 3


def test_what_has_gone_on_and_is_settled_at_more_cost_is_not_taken() -> None:
    asked = Asked({}, settled={95.0: 110.0})
    assert best_of(asked.trial_with_given_up(100.0, 95.0)) == ("start 0", 100.0)
    assert asked.gone_on == [95.0]


def test_nothing_goes_on_where_no_solve_was_given_up_early() -> None:
    asked = Asked({95.0: 96.0})
    assert best_of(asked.trial_with_given_up(100.0, 95.0, early=False)) == ("start 0", 100.0)
    assert asked.gone_on == []


def test_what_the_check_refuses_for_its_bodies_goes_on_with_them_apart() -> None:
    """Once each; it counts at what it costs then, which may be more than another one does."""
    asked = Asked({}, apart={10.0: 10.1})
    assert best_of(asked.trial(10.0, 12.0)) == ("start 1", 10.1)
    dearer = Asked({}, apart={10.0: 11.0})
    assert best_of(dearer.trial(10.0, 10.5)) == ("start 2", 10.5)
    again = Asked({}, apart={10.0: 10.1, 10.1: 10.2})
    trial = again.trial(10.0)
    assert (trial.best, trial.overlaps, again.cleared) == (None, True, [10.0])
    better = Asked({10.5: 9.0}, apart={9.0: 9.5})
    assert best_of(better.trial(10.0, 10.5)) == ("start 2", 9.5)
    worse = Asked({10.5: 9.0}, apart={9.0: 10.2})
    assert best_of(worse.trial(10.0, 10.5)) == ("start 1", 10.0)


def test_a_trial_is_doubtful_where_an_end_that_promised_less_led_nowhere() -> None:
    assert not Asked({}).trial(10.0, 12.0).is_doubtful
    assert not Asked({}, settled={10.0: 11.0}).trial(10.0, 12.0).is_doubtful, "rows cost what they cost"
    assert Asked({}, settled={10.0: np.inf}).trial(10.0, 12.0).is_doubtful
    assert not Asked({}, settled={10.0: np.inf}).trial(10.0, 10.05).is_doubtful, "within 1 %"
    assert Asked({}, apart={10.0: np.inf}).trial(10.0, 12.0).is_doubtful
    assert Asked({}, settled={10.0: np.inf}).trial(10.0).is_doubtful, "there is none"


def test_two_trials_are_one_with_the_best_of_both() -> None:
    one, other = Asked({}).trial(10.0), Asked({}).trial(9.0)
    assert best_of(one.beside(other)) == best_of(other.beside(one)) == ("start 1", 9.0)
    assert len(one.beside(other).attempts) == 2
    none = Asked({}, apart={10.0: np.inf}).trial(10.0)
    assert best_of(none.beside(other)) == ("start 1", 9.0)
    assert not none.beside(other).overlaps
    assert none.beside(Asked({}, refused=(10.0,)).trial(10.0)).overlaps


def test_a_case_without_a_posture_counts_each_reason_once() -> None:
    trial = Asked({}, refused=(10.0,)).trial(10.0)
    (attempt,) = trial.attempts
    once, twice = (case_solution(Case(task=Hold(height_m=0.8)), [trial] * times).reason for times in (1, 2))
    assert once == f"no posture found at 0.8 m: {attempt.reason}"
    assert twice == f"{once} (2 times)"
