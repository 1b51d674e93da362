"""pymoo searches a problem: SPEA2, its populations evaluated in two processes. About two minutes.

python examples/with_pymoo.py [GENERATIONS]
"""

import sys

from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.spea2 import SPEA2
from pymoo.util.ref_dirs import get_reference_directions

import evodesign
from evodesign.errors import InputError

if __name__ == "__main__":
    generations = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    problem = evodesign.open_problem("point-grasp")
    with evodesign.as_pymoo_problem(problem, jobs=2) as for_pymoo:
        result = for_pymoo.minimize(SPEA2(pop_size=8), ("n_gen", generations), seed=1)
        for values in for_pymoo.natural(result.F) if result.F is not None else ():
            print({name: round(value, 2) for name, value in values.items()})
        print(f"{result.algorithm.evaluator.n_eval} designs")

        try:  # infeasible designs have no objectives, and not every algorithm can do without
            for_pymoo.minimize(MOEAD(get_reference_directions("das-dennis", 3, n_partitions=3)))
        except InputError as refusal:
            print(refusal)
