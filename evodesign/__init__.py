"""Humanoid robots designed by evolution for low joint torques of robot and person who hold a load together.

From Python:

    run = evodesign.open_run("runs/first")              front, table, designs, postures
    problem = evodesign.open_problem("problem.toml")    designs evaluated one at a time
    evodesign.as_pymoo_problem(problem)                 for pymoo's algorithms

What a name needs is loaded when it is used: opening a run loads no solver.
"""

from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from evodesign.api.problem import open_problem
    from evodesign.api.pymoo_problem import as_pymoo_problem
    from evodesign.api.run import open_run

__version__ = version("evodesign")
__all__ = ["__version__", "as_pymoo_problem", "open_problem", "open_run"]

HOMES = {
    "as_pymoo_problem": "evodesign.api.pymoo_problem",
    "open_problem": "evodesign.api.problem",
    "open_run": "evodesign.api.run",
}
"""Where each public name lives."""


def __getattr__(name: str) -> Any:
    if name not in HOMES:
        raise AttributeError(f"module 'evodesign' has no attribute '{name}'")
    return getattr(import_module(HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
