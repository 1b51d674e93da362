"""How much work goes into a posture or a lift, and how small a difference counts, in one place.

What goes into portfolios of starts is `start_training.Training`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from evodesign.nlp.method import SolverOptions


@dataclass(frozen=True, slots=True)
class Budget:
    """The figures by which solutions are sought; a cost is of squared torques.

    Args:
        rounds: how often rows are switched on, one solve after the other.
        brief: iterations after which one of several solves is given up: 9 of 10 that succeed take less than
            50.
        brief_lifts: likewise of lifts, which take less than 60 (docs/motion.md).
        free: share of its cost that a solution must save per metre [1/m] by a row's yielding, for the row to
            hold it.
        part_better: share of its cost that a posture must gain by parting bodies in other ways to be solved
            again.
        part_lifts_better: likewise of a lift.
        same: share of its cost by which one optimum must exceed another not to be the same.
        may_gain: by how much of the best one's cost others may cost more and are looked at for ways to cost
            less.
        far: how many times the cheapest end of all the best posture may cost before all other ends are
            settled, too: rows that are switched on may lead far away from what a start promised, and others
            less far.
        promising: shares of the best one's cost between which solves that were given up must cost to go on:
            what costs much less is far from holding the constraints.
        exchange: share of the least effort found that the robot of one posture beside the person of another
            must promise to be tried. Of 598 cases of the default problem 77 had such a pair; it was better by
            more than 0.2 % in 4 of them, and in none of the 58 others with a promise below 0.995.
        other_way: angle [rad] by which a joint of the robot must differ between two cases of a task for each
            to be solved from the other's posture. Of 300 cases of the default problem nine in ten differ by
            less than 0.4; those that gained differed by more than 1.4.
        people: of other starts, who are put beside the best robot found so far (docs/benchmarks.md).
        near: how far above the best optimum of a posture another one is still good: 1 %; near zero 0.1 N m.
        part_farther: how much farther [m] another way to part bodies must let the load go to be tried.
        near_height: how far [m] from the best known extreme another one is still good.
        same_height: difference of heights [m] above which two extremes are not the same.
    """

    rounds: int = 6
    brief: int = 60
    brief_lifts: int = 100
    free: float = 1e-4
    part_better: float = 1e-3
    part_lifts_better: float = 1e-4
    same: float = 1e-5
    may_gain: float = 0.15
    far: float = 1.5
    promising: tuple[float, float] = (0.93, 0.995)
    exchange: float = 0.95
    other_way: float = 0.5
    people: int = 16
    near: tuple[float, float] = (0.01, 1e-4)
    part_farther: float = 1e-3
    near_height: float = 0.005
    same_height: float = 1e-6

    def briefly(self, options: SolverOptions) -> SolverOptions:
        """Options of one of several solves."""
        return replace(options, iterations=min(self.brief, options.iterations))


BUDGET = Budget()
