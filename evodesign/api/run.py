"""A run in a notebook: its front, its evaluations as a table, its designs and postures.

Reading a run loads no solver; only postures that the log does not hold are solved anew.

Beyond 300 lines: a user's methods with their docstrings; each calls another module.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evodesign.analysis.choice import Choice, Order, choose
from evodesign.analysis.conditions import Quantity, all_conditions, quantities
from evodesign.analysis.people_spread import all_spreads_json, spread_of_run
from evodesign.api.columns import Column, case_columns, evaluation_columns
from evodesign.api.design import Design
from evodesign.errors import InputError, on_one_line
from evodesign.files import write_whole
from evodesign.records import CaseDetail, Constraint, Evaluation, Objective, Parameter
from evodesign.runlog.run import RunLog, read_run
from evodesign.runlog.sampled_file import read_sampled

if TYPE_CHECKING:
    from optuna import Study
    from optuna.storages import BaseStorage


def open_run(path: str | os.PathLike[str]) -> Run:
    """Open a run's directory, also one that was cut off or is still being written.

    Raises:
        RunError: it is not a run, or cannot be read.
    Example:
        >>> evodesign.open_run("runs/first")
        <run of golden-lifting in runs/first: 5 evaluations, 3 on the front>
    """
    return Run(read_run(Path(path)))


class Run:
    """What a run found; its length is the number of evaluations.

    Args:
        log: as it was read.
    Attributes:
        log: the records as they are.
    Example:
        >>> run = evodesign.open_run("runs/first")
        >>> len(run), [design.number for design in run.front]
        (5, [4, 2, 1])
    """

    def __init__(self, log: RunLog) -> None:
        self.log = log
        self._details = {detail.evaluation: detail.cases for detail in log.details}

    def __repr__(self) -> str:
        return (
            f"<run of {on_one_line(self.name)} in {self.log.directory}: {len(self)} evaluations, "
            f"{len(self.front)} on the front>"
        )

    def __len__(self) -> int:
        return len(self.log.evaluations)

    @property
    def name(self) -> str:
        """Of the problem."""
        return self.log.header.problem_name

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The design parameters, each with bounds in its own unit."""
        return self.log.header.parameters

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """The objectives, with senses and units."""
        return self.log.header.objectives

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """The constraints, with bounds and units."""
        return self.log.header.constrained

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence for everything that is missing or strange in the log."""
        return self.log.notes

    @property
    def damaged(self) -> bool:
        """Whether evaluations or files of the run are lost, so that its front may be another one."""
        return self.log.damaged

    @property
    def designs(self) -> tuple[Design, ...]:
        """Every evaluated design, in order of number."""
        return tuple(self._design(evaluation) for evaluation in self.log.evaluations)

    @property
    def front(self) -> tuple[Design, ...]:
        """The designs that no other one dominates, best first in the first objective."""
        return self.choose()

    @property
    def spread(self) -> dict[str, Any] | None:
        """How designs spread over samples of people, as `evodesign spread --json`; None without samples.

        Example:
            >>> run.spread is None
            True
        """
        found = spread_of_run(self.log, read_sampled(self.log)[0])
        return None if found is None else all_spreads_json(found)

    def design(self, number: int) -> Design:
        """The design of a number.

        Raises:
            InputError: the run has no such design.
        Example:
            >>> run.design(4).parameters["length.shank"]
            1.489...
        """
        return self._design(self.log.evaluation(number))

    def matters(self, through: int | None = None) -> dict[str, Any]:
        """What matters: each parameter's share of every objective's variance, as `evodesign matters --json`.

        Args:
            through: number of a design of the run, to add slices through it along every parameter.
        Example:
            >>> [each["reason"] for each in run.matters()["objectives"]][0]
            '5 evaluated designs have it, and at least 60 are wanted'
        """
        from evodesign.analysis.importance_json import matters_json  # SciPy's statistics take time to load

        return matters_json(self.log, through)

    def choose(
        self,
        *,
        where: str | Sequence[str] = (),
        knee: bool = False,
        near: Mapping[str, float] | None = None,
        different: bool = False,
        limit: int | None = None,
    ) -> tuple[Design, ...]:
        """Designs of the front, as `evodesign front` chooses them.

        Args:
            where: a condition such as `reach_height >= 1.5 and robot_torque@1.2 < 10`, or a list of them; the
                front is that of the designs that meet all.
            knee: only knees, sharpest first.
            near: closest first to these values of objectives, in their units.
            different: the most different designs, as many as the limit says.
            limit: at most so many.
        Raises:
            InputError: more than one way to choose, or a name that the run does not know.
        Example:
            >>> [design.number for design in run.choose(where="reach_height >= 1.34")]
            [4, 2]
            >>> [design.number for design in run.choose(where=["reach_height >= 1.34", "robot_torque < 1.7"])]
            [4]
            >>> [design.number for design in run.choose(near={"reach_height": 1.4}, limit=1)]
            [2]
        """
        orders = {Order.KNEE: knee, Order.NEAR: near is not None, Order.DIFFERENT: different}
        asked = [order for order, wanted in orders.items() if wanted]
        if len(asked) > 1:
            raise InputError("choose", "", "one of knee, near and different", " and ".join(asked))
        texts = ([where] if where.strip() else []) if isinstance(where, str) else where
        choice = Choice(
            where=all_conditions(texts, self._quantities, "where"),
            order=asked[0] if asked else Order.FIRST_OBJECTIVE,
            aspiration=near or {},
            limit=limit,
        )
        chosen = choose(self.objectives, self.log.evaluations, choice)
        return tuple(self._design(evaluation) for evaluation in chosen.designs)

    def plot_front(self, path: str | os.PathLike[str]) -> Path:
        """Write a figure of the front: a page for a browser, with which one can zoom and read off numbers.

        Args:
            path: of the HTML file.
        Returns:
            The path.
        Raises:
            InputError: the file cannot be written; or the run has no feasible design, or one objective, or
                more than three.
        Example:
            >>> run.plot_front("front.html")
            PosixPath('front.html')
        """
        from evodesign.report.front_figure import front_html  # plotly takes its time to load

        page = front_html(self.log.header, self.log.evaluations)
        try:
            write_whole(Path(path), page.encode())
        except OSError as error:
            raise InputError(
                "path", "", "a file that can be written", f"'{path}' ({error.strerror})"
            ) from error
        return Path(path)

    def table(self, designs: Sequence[Design] | None = None) -> dict[str, Column]:
        """Designs as columns: `pandas.DataFrame(run.table())`.

        Args:
            designs: of this run; left out, all evaluations.
        Returns:
            Columns by name: number, generation, feasible, status, violation, seconds, objectives, constrained
            quantities, ends of the reach [m], torque norms by height and by case [N m], parameters; not a
            number where a value does not exist.
        Raises:
            InputError: a design that is none of this run.
        Example:
            >>> table = run.table(run.front)
            >>> table["number"].tolist(), table["feasible"].tolist()
            ([4, 2, 1], [True, True, True])
        """
        return evaluation_columns(self._evaluations(designs), self._quantities)

    def cases(self, designs: Sequence[Design] | None = None) -> dict[str, Column]:
        """Every case of designs as columns, a row per design, person, load and task.

        Args:
            designs: of this run; left out, all evaluations.
        Returns:
            Columns by name: number, human, payload (empty where the problem has one), task, height [m] (of a
            lift that at its end), status, reason, robot_torque and human_torque [N m] (of a lift the
            largest), residual; not a number where a value does not exist.
        Raises:
            InputError: a design that is none of this run.
        Example:
            >>> cases = run.cases([design])
            >>> [*zip(cases["human"].tolist(), cases["height"].tolist())]
            [('short', 0.8), ('short', 1.0), ('tall', 0.8), ('tall', 1.0)]
        """
        return case_columns(self._evaluations(designs))

    def to_optuna(
        self, storage: str | os.PathLike[str] | BaseStorage | None = None, study_name: str | None = None
    ) -> Study:
        """All evaluations as trials of a new study of Optuna, for its plots, dashboard and samplers.

        A design with all objectives is a complete trial, and the others have failed, with the reason in
        `user_attrs`. The study's `best_trials` are the front, and designs equal to those in every objective.

        Args:
            storage: of Optuna, its URL, or the path of an SQLite file; left out, the memory.
            study_name: left out, names of the problem and of the run's directory.
        Raises:
            InputError: Optuna is not installed, the storage cannot be used, or it has a study of this name.
        Example:
            >>> study = run.to_optuna()
            >>> len(study.trials) == len(run)
            True
        """
        from evodesign.api.optuna_study import study_of  # takes its time to load

        return study_of(self.log, storage, study_name)

    def postures(self, number: int) -> tuple[CaseDetail, ...]:
        """How robot and person of a design stand in each case that was solved, with torques and wrenches.

        The log holds them for every design that was on the front when it was found. For another one they are
        solved anew, which takes seconds and needs the solver.

        Returns:
            Base positions [m] and angles [rad], joint positions [rad], joint torques [N m], forces [N] and
            moments [N m] at hands and feet of both agents.
        Raises:
            InputError: the run has no such design.
        Example:
            >>> posture = run.postures(4)[0]
            >>> posture.case.name, posture.agents["robot"].torques_n_m["l_elbow"]
            ('short, 0.8 m', -0.0546...)
        """
        design = self.design(number)
        if design.postures:
            return design.postures
        from evodesign.api.problem import Problem  # brings the solver

        return Problem(self.log.header.problem).evaluate(design.parameters).postures

    def _evaluations(self, designs: Sequence[Design] | None) -> Sequence[Evaluation]:
        """The evaluations of designs, or all."""
        if designs is None:
            return self.log.evaluations
        by_number = {evaluation.number: evaluation for evaluation in self.log.evaluations}
        for number in (design.number for design in designs):
            if number not in by_number:
                found = "one that was evaluated outside of it" if number is None else f"{number}"
                raise InputError("designs", "", f"designs of {self.log.directory}", found)
        return [by_number[design.number] for design in designs if design.number is not None]

    @property
    def _quantities(self) -> dict[str, Quantity]:
        first = self.log.evaluations[0] if self.log.evaluations else None
        return quantities(self.log.header, first)

    def _design(self, evaluation: Evaluation) -> Design:
        postures = self._details.get(evaluation.number, ())
        return Design(
            evaluation.number, evaluation.assessment, postures, self.constraints, (), partial(_same, self.log)
        )


def _same(log: RunLog) -> RunLog:
    return log
