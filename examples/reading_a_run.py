"""Reading a run: its front, a table of all designs, a few of them chosen, and the torques of one. A second.

python examples/reading_a_run.py RUN
"""

import sys

import pandas as pd

import evodesign

run = evodesign.open_run(sys.argv[1])  # also a damaged run, or one that is still being written
print(run, *run.notes, sep="\n")

table = pd.DataFrame(run.table()).set_index("number")
print(table[["feasible", *(objective.name for objective in run.objectives)]].round(2))
print("feasible:", f"{table['feasible'].mean():.0%}")

for words, chosen in {
    "the front": run.front,
    "knees": run.choose(knee=True, limit=2),
    "closest to 8 N m and 1.5 m": run.choose(near={"robot_torque": 8.0, "reach_height": 1.5}, limit=2),
    "the most different": run.choose(different=True, limit=3),
}.items():
    print(words, [design.number for design in chosen])

design = run.front[0]
torques = pd.DataFrame({str(p.case.task): p.agents["robot"].torques_n_m for p in run.postures(design.number)})
print(f"largest joint torques of design {design.number} [N m]")
print(torques.loc[torques.abs().max(axis=1).nlargest(5).index].round(2))
