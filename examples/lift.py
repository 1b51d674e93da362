"""A robot and a person lift a box in 1.5 s: torques and power over time. A minute or two the first time.

The robot has longer legs than it was built with; its motion is solved and checked as a search would.

    python examples/lift.py [PROBLEM]
"""

import sys

import numpy as np

import evodesign


def main() -> None:
    problem = evodesign.open_problem(*sys.argv[1:] or ["icub-lift"])
    longer = {parameter.name: 1.0 for parameter in problem.parameters if parameter.name.startswith("length.")}
    design = problem.evaluate(longer | {"length.shank": 1.3, "length.thigh": 1.3})
    if not design.postures:
        print(f"no lift: {design.reason}")
        return
    (motion,) = design.postures
    print(f"{motion.case.task}: {design.objectives}")
    print("time [s]  height [m]  robot [N m]  person [N m]  robot's joints [W]")
    for moment in motion.moments:
        robot, person = (np.array([*moment.agents[name].torques_n_m.values()]) for name in ("robot", "human"))
        power = robot @ np.array([*moment.agents["robot"].speeds_rad_s.values()])
        norms = f"{np.linalg.norm(robot):11.2f}  {np.linalg.norm(person):12.2f}"
        print(f"{moment.time_s:8.2f}  {moment.height_m:10.3f}  {norms}  {power:18.2f}")


if __name__ == "__main__":
    main()
