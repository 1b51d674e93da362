"""Optuna's TPE searches a problem, and a run of evodesign becomes a study of Optuna. A minute.

python examples/with_optuna.py [TRIALS [RUN]]
"""

import sys

import optuna

import evodesign

optuna.logging.set_verbosity(optuna.logging.WARNING)
trials = int(sys.argv[1]) if len(sys.argv) > 1 else 20
problem = evodesign.open_problem("point-grasp")
objective = problem.optuna_objective()
study = optuna.create_study(directions=objective.directions, sampler=optuna.samplers.TPESampler(seed=1))
study.enqueue_trial(dict(problem.unscaled))  # begin with the robot as it is
study.optimize(objective, n_trials=trials)
for trial in study.best_trials:
    print(trial.number, [round(value, 2) for value in trial.values])
for trial in study.get_trials(states=[optuna.trial.TrialState.PRUNED]):
    print(trial.number, "pruned:", trial.user_attrs["reason"])

if len(sys.argv) > 2:
    run = evodesign.open_run(sys.argv[2])
    exported = run.to_optuna("sqlite:///runs.db", study_name="first")
    assert {trial.user_attrs["number"] for trial in exported.best_trials} >= {d.number for d in run.front}
    print("runs.db: look at it with optuna-dashboard sqlite:///runs.db")
