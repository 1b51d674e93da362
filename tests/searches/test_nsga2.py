import numpy as np
from pymoo.core.population import Population

from evodesign.records import SearchSettings
from evodesign.searches.base import Outcome
from evodesign.searches.nsga2 import Nsga2

FAILED = Outcome(None, None)


def search(population=16, dimension=3, start=()):
    return Nsga2(
        SearchSettings(
            algorithm="nsga2",
            dimension=dimension,
            objectives=2,
            population=population,
            seed=4,
            start=start,
        )
    )


def trade(genome):
    return Outcome((genome[0] ** 2 + genome[1], (genome[0] - 1.0) ** 2 + genome[2]), 0.0)


def after(second_generation):
    """The third generation asked, when the first was feasible and the second is told as given."""
    nsga2 = search()
    nsga2.tell([trade(genome) for genome in nsga2.ask()])
    nsga2.tell([second_generation(index, genome) for index, genome in enumerate(nsga2.ask())])
    return nsga2.ask()


def test_failed_and_violated_designs_never_displace_feasible_ones():
    """Offspring depend on survivors alone: whatever is infeasible leaves the same trace, none."""
    all_failed = after(lambda index, genome: FAILED)
    assert after(lambda index, genome: Outcome(None, 1e-300)) == all_failed
    assert after(lambda index, genome: Outcome((-1e300, -1e300), 0.1 * index + 0.1)) == all_failed
    assert after(lambda index, genome: Outcome((-1e300, -1e300), None)) == all_failed
    assert after(lambda index, genome: Outcome(None, 0.0)) == all_failed
    assert after(lambda index, genome: trade(genome)) != all_failed


def test_crowding_of_the_feasible_ignores_what_is_infeasible():
    def half(violated):
        return lambda index, genome: trade(genome) if index % 2 else violated

    reference = after(half(FAILED))
    assert after(half(Outcome((1e300, -1e300), 3.0))) == reference
    assert after(half(Outcome((0.5, 0.5), 1e-9))) == reference


def survivors_when_a_quarter_is_feasible():
    nsga2 = search(population=8)
    first = nsga2.ask()
    told = [Outcome((1.0, 0.0), 0.0), Outcome((0.0, 1.0), 0.0), *[FAILED] * 6]
    nsga2.tell(told)
    second = nsga2.ask()
    nsga2.tell([FAILED] * 3 + [Outcome(None, 2.0), Outcome(None, 1.0)] + [FAILED] * 3)
    kept = {tuple(genome) for genome in nsga2._algorithm.pop.get("X").tolist()}
    return first, second, kept


def test_survival_prefers_feasible_then_least_violation_then_failures():
    first, second, kept = survivors_when_a_quarter_is_feasible()
    assert {first[0], first[1], second[3], second[4]} <= kept
    assert len(kept) == 8


def test_a_generation_is_topped_up_where_duplicates_were_eliminated():
    """Without crossover and mutation every offspring repeats a parent."""
    nsga2 = search()
    nsga2._algorithm.mating.crossover.prob.value = 0.0
    nsga2._algorithm.mating.mutation.prob.value = 0.0
    first = nsga2.ask()
    nsga2.tell([trade(genome) for genome in first])
    second = nsga2.ask()
    assert len(set(second)) == 16
    assert set(second).isdisjoint(first)
    for _ in range(3):
        nsga2.tell([trade(genome) for genome in nsga2.ask()])
        assert len(set(nsga2.ask())) == 16


def test_a_partly_eliminated_generation_keeps_its_offspring_first():
    nsga2 = search()
    few = Population.new(X=np.full((3, 3), 0.25) + np.arange(3)[:, None] / 10.0)
    nsga2._algorithm.ask = lambda: few
    nsga2.tell([trade(genome) for genome in nsga2.ask()])
    assert nsga2.ask()[:3] == ((0.25,) * 3, (0.35,) * 3, (0.45,) * 3)
    assert len(set(nsga2.ask())) == 16


def test_the_front_closes_in_on_the_best_trade_offs():
    """The trade-offs are y = z = 0, any x: f1 = x^2, f2 = (x - 1)^2."""
    nsga2 = search(population=20)
    for _ in range(40):
        nsga2.tell([trade(genome) for genome in nsga2.ask()])
    final = np.array(nsga2.ask())
    assert np.median(final[:, 1:]) < 0.01
    assert np.ptp(final[:, 0]) > 0.8
