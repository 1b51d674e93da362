"""An objective of your own, in a file of your own: the larger force on a foot of the robot. About a minute.

Its name in the problem is MODULE:NAME. Every process imports the module, this file, by that name; so it works
with any number of jobs, and a run can be resumed where the module can be imported. EVODESIGN_MODULES names
the modules that may be: a run that somebody sends executes nothing that you did not ask for.

    python examples/own_objective.py [EVALUATIONS]
"""

import os
import sys
import tomllib

import evodesign
from evodesign.quantities.design_result import CaseQuantity


def larger_foot_force(scene, postures):
    """The robot's larger foot force [N] in one posture: the mean over the heights is the objective."""
    wrenches = postures["robot"].wrenches
    return max(float(wrenches[name][2]) for name in ("left_foot", "right_foot"))


foot_force = CaseQuantity("N", larger_foot_force)

if __name__ == "__main__":
    evaluations = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    tables = tomllib.loads(evodesign.open_problem("point-grasp").source.text)
    tables["name"] = "light-footed"
    os.environ["EVODESIGN_MODULES"] = "own_objective"
    del tables["search"]["reference"]  # it names the objectives of the file
    tables["objectives"] = {"minimise": ["own_objective:foot_force", "robot_torque"]}
    problem = evodesign.Problem.from_dict(tables)
    run = evodesign.search(problem, "runs/light", evaluations=evaluations, population=6, jobs=2)
    for design in run.front:
        print(design.number, {name: round(value, 1) for name, value in design.objectives.items()})
