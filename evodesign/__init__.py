"""Humanoid robots designed by evolution for low joint torques of robot and person who hold a load together.

    run = evodesign.search("icub-lifting", "runs/first", evaluations=240, jobs=2)
    run.plot_front("front.html")                        the Pareto front
    run.front[0].export("best")                         URDF, MJCF, postures, replay of a design
    run = evodesign.open_run("runs/first")              front, table, designs, postures of any run
    problem = evodesign.open_problem("problem.toml")    designs evaluated one at a time
    evodesign.lift(problem, from_m=0.8, to_m=1.2)       the load lifted in time
    evodesign.simulate(problem)                         holds or lifts in MuJoCo, as a referee
    evodesign.as_pymoo_problem(problem)                 for pymoo's algorithms

What a name needs is loaded when it is used: opening a run loads no solver.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    from evodesign.api.design import Design
    from evodesign.api.problem import Problem, open_problem, problems
    from evodesign.api.pymoo_problem import as_pymoo_problem
    from evodesign.api.run import Run, open_run
    from evodesign.api.search import resume, search
    from evodesign.api.simulate import lift, simulate
    from evodesign.api.spread import spread

HOMES = {
    "Design": "evodesign.api.design",
    "Problem": "evodesign.api.problem",
    "Run": "evodesign.api.run",
    "as_pymoo_problem": "evodesign.api.pymoo_problem",
    "lift": "evodesign.api.simulate",
    "open_problem": "evodesign.api.problem",
    "open_run": "evodesign.api.run",
    "problems": "evodesign.api.problem",
    "resume": "evodesign.api.search",
    "search": "evodesign.api.search",
    "simulate": "evodesign.api.simulate",
    "spread": "evodesign.api.spread",
}
"""Where each public name lives."""

__all__ = [
    "Design",
    "Problem",
    "Run",
    "__version__",
    "as_pymoo_problem",
    "lift",
    "open_problem",
    "open_run",
    "problems",
    "resume",
    "search",
    "simulate",
    "spread",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version  # here, because a command line must heed Ctrl-C before

        return version("evodesign")
    if name not in HOMES:
        raise AttributeError(f"module 'evodesign' has no attribute '{name}'")
    return getattr(import_module(HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
