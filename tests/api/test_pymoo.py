"""pymoo's algorithms on problems with infeasible designs: sound to their end, or refused in one sentence."""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray
from pymoo.algorithms.moo.ctaea import CTAEA
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.algorithms.moo.rvea import RVEA
from pymoo.algorithms.moo.sms import SMSEMOA
from pymoo.algorithms.moo.spea2 import SPEA2
from pymoo.algorithms.moo.unsga3 import UNSGA3
from pymoo.algorithms.soo.nonconvex.cmaes import CMAES
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.algorithms.soo.nonconvex.sres import SRES
from pymoo.optimize import minimize
from pymoo.util.ref_dirs import get_reference_directions

from evodesign.api import pymoo_problem
from evodesign.api.design import Design
from evodesign.api.problem import Problem
from evodesign.api.pymoo_problem import ALGORITHMS, PymooProblem, as_pymoo_problem
from evodesign.errors import EvodesignError, InputError
from evodesign.pool.base import Finished
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.source import read_source
from evodesign.records import Assessment, Objective, Parameter, Sense, Status

pytestmark = pytest.mark.slow

Make = Callable[[int], Any]


def directions(population: int) -> NDArray[np.float64]:
    """At most so many reference directions of three objectives."""
    partitions = max(n for n in range(1, 9) if (n + 1) * (n + 2) // 2 <= population)
    found: NDArray[np.float64] = get_reference_directions("das-dennis", 3, n_partitions=partitions)
    return found


def age_moea(population: int) -> Any:
    pytest.importorskip("numba", reason="AGE-MOEA of pymoo needs numba")
    from pymoo.algorithms.moo.age import AGEMOEA

    return AGEMOEA(pop_size=population)


SOUND: Mapping[str, Make] = {
    "NSGA2": lambda population: NSGA2(pop_size=population),
    "NSGA3": lambda population: NSGA3(directions(population), pop_size=population),
    "UNSGA3": lambda population: UNSGA3(directions(population), pop_size=population),
    "SMSEMOA": lambda population: SMSEMOA(pop_size=population, normalize=False),
    "SPEA2": lambda population: SPEA2(pop_size=population),
    "AGEMOEA": age_moea,
}
REFUSED: Mapping[str, Make] = {
    "SMSEMOA": lambda population: SMSEMOA(pop_size=population),
    "CTAEA": lambda population: CTAEA(directions(population)),
    "RVEA": lambda population: RVEA(directions(population)),
    "MOEAD": lambda population: MOEAD(directions(population)),
}
SINGLE: Mapping[str, Make] = {
    "GA": lambda population: GA(pop_size=population),
    "DE": lambda population: DE(pop_size=population),
    "PSO": lambda population: PSO(pop_size=population),
    "CMAES": lambda population: CMAES(popsize=population),
}


class ToyProblem:
    """A problem of four parameters: designs of all kinds, and nothing to solve."""

    def __init__(self, objectives: int) -> None:
        self.constraints = ()
        self.parameters = tuple(Parameter(f"length.{i}", 0.5, 2.0, "1") for i in range(4))
        senses = (Sense.MINIMISE, Sense.MINIMISE, Sense.MAXIMISE)
        self.objectives = tuple(
            Objective(f"value_{i}", sense, "1") for i, sense in enumerate(senses[:objectives])
        )

    def evaluate(self, design: Mapping[str, float] | Sequence[float]) -> Design:
        """Nearly half infeasible by a known distance, a seventh by an unknown one."""
        row = design.values() if isinstance(design, Mapping) else design
        a, b, c, d = (value - 0.5 for value in row)
        values = (40.0 + 10.0 * a**2 + 20.0 * d, 7.0 + (1.0 - a) ** 2 + b * c, 1.0 + a)
        violation, unknown = max(0.0, 0.6 - a), b > 1.3
        exists = 2 if violation > 0.0 or (unknown and d > 0.7) else 0
        named = {each.name: value for each, value in zip(self.objectives, values, strict=False)}
        assessment = Assessment(
            design={},
            objectives=dict(list(named.items())[exists:]),
            violation=None if unknown and d <= 0.7 else violation,
            status=Status.SOLVED,
            reason="",
        )
        return Design(None, assessment)


class WithNumbers(PymooProblem):
    """Gives infeasible designs objectives out of nowhere, and keeps what it is asked."""

    def __init__(self, problem: Any, number: float) -> None:
        super().__init__(problem)
        self.number = number
        self.asked: list[NDArray[np.float64]] = []

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
        super()._evaluate(x, out, *args, **kwargs)
        self.asked.extend(x.copy())
        out["F"][np.isnan(out["F"])] = self.number


@pytest.fixture
def fixed_ties(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some of pymoo's tournaments decide ties by a generator without a seed."""
    made = np.random.default_rng
    monkeypatch.setattr(np.random, "default_rng", lambda seed=None: made(0 if seed is None else seed))


def searched(
    make: Make, objectives: int, number: float = math.nan, seed: int = 1
) -> tuple[Any, NDArray[np.float64]]:
    problem: Any = ToyProblem(objectives)
    asked = WithNumbers(problem, number)
    result = minimize(asked, make(12), ("n_gen", 10), seed=seed)
    return result, np.array(asked.asked)


@pytest.mark.usefixtures("fixed_ties")
@pytest.mark.parametrize("name", [*SOUND, *SINGLE])
def test_it_searches_and_never_reads_objectives_that_do_not_exist(name: str) -> None:
    """Whatever stands in their place, the same designs are asked for."""
    make, objectives = (SOUND[name], 3) if name in SOUND else (SINGLE[name], 1)
    result, asked = searched(make, objectives)
    assert np.isfinite(result.F).all()
    toy: Any = ToyProblem(objectives)
    for row, values in zip(np.atleast_2d(result.X), result.problem.natural(result.F), strict=True):
        design = toy.evaluate(row.tolist())
        assert design.feasible
        assert dict(design.objectives) == pytest.approx(values)
    kinds = {PymooProblem(toy).evaluate(row)[1].item() for row in asked}
    assert math.inf in kinds, "designs of unknown violation"
    assert any(0.0 < violation < 1.0 for violation in kinds), "infeasible designs"
    for number in (1e6, -1e6):
        assert np.array_equal(searched(make, objectives, number)[1], asked)


@pytest.mark.usefixtures("fixed_ties")
@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_does_read_them(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the refusal it fails, gives a design without objectives, or depends on what is not there."""
    monkeypatch.setattr(pymoo_problem, "ALGORITHMS", {})
    try:
        sound = all(
            np.isfinite(result.F).all() and np.array_equal(asked, searched(REFUSED[name], 3, 1e6, seed)[1])
            for seed in range(1, 5)
            for result, asked in [searched(REFUSED[name], 3, seed=seed)]
        )
    except (ValueError, AssertionError):
        sound = False
    assert not sound


@pytest.mark.parametrize("name", REFUSED)
def test_refusal_says_why_and_which_algorithms_can(name: str) -> None:
    toy: Any = ToyProblem(3)
    for_pymoo = PymooProblem(toy)
    sentence = rf"algorithm: wanted one of GA, .*NSGA2, .*SPEA2.*, found {name}, which "
    with pytest.raises(InputError, match=sentence):
        for_pymoo.minimize(REFUSED[name](12), ("n_gen", 1))
    if name == "MOEAD":
        return  # pymoo itself asks for a problem without constraints before it evaluates
    with pytest.raises(InputError, match=sentence):
        minimize(for_pymoo, REFUSED[name](12), ("n_gen", 1))


def test_algorithms_derived_from_a_known_one_count_as_it() -> None:
    toy: Any = ToyProblem(1)

    class Mine(SRES):  # type: ignore[misc]
        pass

    with pytest.raises(InputError, match="found SRES, which orders infeasible designs"):
        PymooProblem(toy).minimize(Mine(), ("n_gen", 1))


def test_unknown_algorithms_are_let_through() -> None:
    toy: Any = ToyProblem(3)

    class OfSomebodyElse:
        pass

    pymoo_problem.refuse_unsound(OfSomebodyElse())
    assert PymooProblem(toy).evaluate(np.full(4, 1.3))[0].shape == (3,)


def test_every_note_is_tried() -> None:
    assert set(ALGORITHMS) == {*SOUND, *SINGLE, *REFUSED, "SRES"}


def test_history_shares_the_problem() -> None:
    """pymoo copies the algorithm with its problem after each generation: that must not build it anew."""
    toy: Any = ToyProblem(3)
    for_pymoo = PymooProblem(toy)
    result = for_pymoo.minimize(NSGA2(pop_size=4), ("n_gen", 3), seed=1, save_history=True)
    assert [entry.problem for entry in result.history] == [for_pymoo] * 3
    assert copy.deepcopy(for_pymoo) is for_pymoo


@pytest.fixture(scope="module")
def opened(repository: Path, known: Precomputed) -> Problem:
    """The point-grasp problem, without compiling: that takes longer than it saves these tests."""
    assert known.postures, "worked out before, so that the problem finds it in the cache"
    source = read_source(repository / "problems" / "point_grasp.toml")
    return Problem(msgspec.structs.replace(source, text=f"{source.text}\n[solver]\ncompile = false\n"))


def test_results_on_a_robot_are_what_its_evaluation_gives(opened: Problem) -> None:
    """Of one algorithm; the others are compared on the toy problem."""
    result = as_pymoo_problem(opened).minimize(SOUND["NSGA2"](6), ("n_gen", 2), seed=1)
    assert np.isfinite(result.F).all()
    for row, values in zip(np.atleast_2d(result.X), result.problem.natural(result.F), strict=True):
        design = opened.evaluate(row.tolist())
        assert design.feasible
        assert dict(design.objectives) == pytest.approx(values)
    infeasible = result.pop[~result.pop.get("FEAS")[:, 0]]
    assert all(np.isnan(values).all() for values in infeasible.get("F"))


@pytest.fixture(scope="module")
def on_two(opened: Problem) -> Iterator[PymooProblem]:
    with as_pymoo_problem(opened, jobs=2) as for_pymoo:
        yield for_pymoo


def test_processes_give_what_one_process_gives(opened: Problem, on_two: PymooProblem) -> None:
    unscaled = list(opened.unscaled.values())
    lowest = [parameter.lower for parameter in opened.parameters]
    rows = np.array([unscaled, lowest, [1.01 * value for value in unscaled]])
    for alone, together in zip(as_pymoo_problem(opened).evaluate(rows), on_two.evaluate(rows), strict=True):
        assert np.array_equal(alone, together, equal_nan=True)
    assert on_two.evaluate(rows)[1].tolist()[0] == [0.0], "the processes are used again"


def test_wrong_values_are_refused_before_a_process_sees_them(on_two: PymooProblem) -> None:
    with pytest.raises(InputError, match=r"wanted a positive number, found -1\.0"):
        on_two.evaluate(np.full((1, on_two.n_var), -1.0))


def ended(**how: Any) -> Finished[Any]:
    return Finished(0, None, "why", **{"worker_lost": False, "seconds": 1.0, "worker": "local-1", **how})


@pytest.mark.parametrize("how", ["worker_lost", "out_of_time", "out_of_memory"])
def test_evaluation_that_was_ended_has_an_unknown_violation(
    opened: Problem, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    with as_pymoo_problem(opened, jobs=2) as for_pymoo:
        monkeypatch.setattr(for_pymoo._pool, "run", lambda factory, rows: iter([ended(**{how: True})]))
        values, violations = for_pymoo.evaluate(np.array([list(opened.unscaled.values())]))
    assert np.isnan(values).all()
    assert violations.tolist() == [[math.inf]]


def test_evaluation_that_raises_raises_from_processes_too(
    opened: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    with as_pymoo_problem(opened, jobs=2) as for_pymoo:
        monkeypatch.setattr(for_pymoo._pool, "run", lambda factory, rows: iter([ended()]))
        with pytest.raises(EvodesignError, match="a design could not be evaluated: why"):
            for_pymoo.evaluate(np.array([list(opened.unscaled.values())]))


def test_it_can_be_sent_to_another_process(on_two: PymooProblem) -> None:
    with pickle.loads(pickle.dumps(on_two)) as again:
        assert (again.problem.source, again.jobs) == (on_two.problem.source, 2)


def test_fewer_than_one_job_is_refused(opened: Problem) -> None:
    with pytest.raises(InputError, match="wanted a whole number from 1, found 0"):
        as_pymoo_problem(opened, jobs=0)
