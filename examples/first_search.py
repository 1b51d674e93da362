"""A first search: 24 robots, and the best of them as files. About two minutes; later runs take seconds.

python examples/first_search.py [EVALUATIONS]
"""

import sys

import evodesign

if __name__ == "__main__":  # the processes of a search import this file
    evaluations = int(sys.argv[1]) if len(sys.argv) > 1 else 24
    run = evodesign.search(
        "point-grasp", "runs/first", evaluations=evaluations, population=6, jobs=2, progress=True
    )
    print(run)
    for design in run.front:
        print(design.number, {name: round(value, 2) for name, value in design.objectives.items()})
    run.plot_front("first_front.html")
    run.front[0].export("first_robot")
