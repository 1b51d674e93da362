"""One design of a run: its evaluation and postures, and its robot where that is needed."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from evodesign.analysis.front import front
from evodesign.analysis.people_spread import PeopleSpread, spread_of_run
from evodesign.errors import EvodesignError, InputError, RunError, on_one_line
from evodesign.records import Case, CaseDetail, Detail, Evaluation, RunHeader
from evodesign.report.scene_models import SceneSet
from evodesign.runlog.run import RunLog
from evodesign.runlog.sampled_file import read_sampled
from evodesign.searches.base import JOINT_STARTS

if TYPE_CHECKING:
    from evodesign.collision.clearance import BodyDistance
    from evodesign.evaluation.evaluate import Evaluator
    from evodesign.evaluation.progress import PrecomputeProgress
    from evodesign.mechanics.agent import Agent
    from evodesign.motion.solution import LiftSolution
    from evodesign.problem.build import DesignProblem
    from evodesign.quantities.ergonomics import Ergonomics
    from evodesign.tasks import Lift


class RebuiltProblem:
    """The problem of a run, built from the header's text when it is first asked for, and once."""

    def __init__(self, header: RunHeader) -> None:
        self._header = header

    @cached_property
    def problem(self) -> DesignProblem:
        """The problem."""
        from evodesign.problem.build import build_problem  # CasADi takes its time to load

        return build_problem(self._header.problem)

    @property
    def can_be_built(self) -> bool:
        """Whether this evodesign can build it."""
        try:
            return bool(self.problem)
        except EvodesignError:
            return False

    @cached_property
    def people(self) -> Mapping[str, tuple[Agent, ...]]:
        """Who holds a load together, by what a case calls them.

        Where nobody is a URDF and all take turns, faster than the whole problem.
        """
        from evodesign.problem.agents import everyone, human_agents  # CasADi takes its time to load
        from evodesign.problem.file import ProblemFile
        from evodesign.problem.source import decode_toml

        source = self._header.problem
        tables = decode_toml(source.text, source.path, ProblemFile)
        given = [table for _, table in everyone(tables, source)]
        if any(table.urdf is not None for table in given) or len({table.side for table in given}) > 1:
            return {scene.pair[0]: scene.people for scene in self.problem.scenes if scene.people}
        return {person.label: (person,) for person in human_agents(tables, source)}


@dataclass(frozen=True, slots=True)
class OpenedDesign:
    """One design of a run.

    Args:
        run: that holds it.
        evaluation: as logged.
        cases: its postures, from the log or solved anew.
        on_front: whether no design of the run beats it.
        rebuilt: the run's problem.
    """

    run: RunLog
    evaluation: Evaluation
    cases: tuple[CaseDetail, ...]
    on_front: bool
    rebuilt: RebuiltProblem

    def scene_set(self) -> SceneSet:
        """Robot of the design, people and loads, built from the problem in the run's header."""
        problem = self.rebuilt.problem
        assessment = self.evaluation.assessment
        design = assessment.design  # what a start of the joint problem led to, not its genome
        space = problem.space
        values = space.given(space.values_of(design), assessment.rated_torques)
        return SceneSet.of(problem.scenes, problem.space.resized(problem.scene.designed_tree, values))

    def lifts(
        self, asked: Lift, jobs: int, progress: PrecomputeProgress
    ) -> dict[tuple[str, str], LiftSolution]:
        """A lift with every person and load, solved anew, by their names."""
        from evodesign.evaluation.factory import evaluator_of
        from evodesign.evaluation.lifts import Lifts

        problem = self.rebuilt.problem
        evaluator = evaluator_of(problem, jobs, progress, [asked])
        values = problem.space.values_of(self.evaluation.assessment.design)
        return Lifts(evaluator, evaluator.known).solve(values, asked)

    def spread(self) -> PeopleSpread | None:
        """Of the run's designs over samples of people; None where this one has none."""
        found = spread_of_run(self.run, read_sampled(self.run)[0])
        return found if found is not None and self.evaluation.number in found.designs else None

    def bill(self) -> dict[str, Any]:
        """Its bill of materials; empty where the problem has no hardware."""
        from evodesign.evaluation.bill import bill_of_materials

        return bill_of_materials(self.rebuilt.problem, self.scene_set().robot, self.cases)

    def body_distances(self) -> dict[Case, BodyDistance]:
        """The nearest two bodies in each of its postures."""
        from evodesign.evaluation.clearance import Clearances

        problem, robot = self.rebuilt.problem, self.scene_set().robot
        found = Clearances(problem.scenes).of(robot, self.cases)
        return {detail.case: each for detail, each in zip(self.cases, found, strict=True)}

    def ergonomics(self) -> tuple[Ergonomics, ...]:
        """What the design's postures ask of the people, one for each case: in a lift at the hardest moment.

        Of several people who hold the load together it is that of the one whose back bears most.

        Raises:
            InputError: the people cannot be told from the header's problem.
            RunError: it has not the person of a case.
        """
        if not self.cases:
            return ()
        from evodesign.quantities.ergonomics import of_most_loaded_back  # CasADi takes its time to load

        people = self.rebuilt.people
        if not people:
            return ()
        stranger = next((each.case.person for each in self.cases if each.case.person not in people), None)
        if stranger is not None:
            name = on_one_line(stranger)
            raise RunError(
                f"{self.run.directory}: its problem has no person '{name}', of whom it has postures"
            )
        hardest = [detail.hardest for detail in self.cases]
        if any(person.name not in each.agents for each in hardest for person in people[each.case.person]):
            raise RunError(f"{self.run.directory}: its problem has people, and a posture is of nobody")
        return tuple(of_most_loaded_back(people[each.case.person], each.agents) for each in hardest)


def open_design(run: RunLog, number: int, jobs: int, progress: PrecomputeProgress) -> OpenedDesign:
    """A design of a run by the number of its evaluation; one without logged postures is solved anew.

    Args:
        run: that holds it.
        number: of the evaluation.
        jobs: that may work out what a solve needs first.
        progress: is shown what is worked out, and that it has to be.
    Raises:
        RunError: the run holds no evaluation yet.
        InputError: it holds no evaluation of that number.
    """
    if not run.evaluations:
        raise RunError(f"{run.directory}: holds no evaluation yet, so there is no design to open")
    by_number = {evaluation.number: evaluation for evaluation in run.evaluations}
    if number not in by_number:
        wanted = f"the number of an evaluation, {min(by_number)} to {max(by_number)}"
        raise InputError("DESIGN", "", wanted, f"{number}")
    evaluation = by_number[number]
    rebuilt = RebuiltProblem(run.header)
    logged = {detail.evaluation: detail.cases for detail in run.details}
    cases = logged[number] if number in logged else _solved(run, [evaluation], rebuilt, jobs, progress)[0]
    return OpenedDesign(
        run, evaluation, cases, evaluation in front(run.header.objectives, run.evaluations), rebuilt
    )


def with_postures(run: RunLog, numbers: Collection[int], jobs: int, progress: PrecomputeProgress) -> RunLog:
    """The run with the postures of some designs, solved anew where the log holds none.

    Args:
        run: that holds them.
        numbers: of evaluations; those that the run has not are passed over.
        jobs: that may work out what a solve needs first.
        progress: is shown what is worked out, and of which designs.
    Returns:
        The run; as it is where its problem cannot be built here.
    """
    logged = {detail.evaluation for detail in run.details}
    bare = [each for each in run.evaluations if each.number in numbers and each.number not in logged]
    rebuilt = RebuiltProblem(run.header)
    if not bare or not rebuilt.can_be_built:
        return run
    solved = _solved(run, bare, rebuilt, jobs, progress)
    details = (Detail(evaluation=each.number, cases=cases) for each, cases in zip(bare, solved, strict=True))
    return replace(run, details=(*run.details, *details))


def _solved(
    run: RunLog,
    bare: Sequence[Evaluation],
    rebuilt: RebuiltProblem,
    jobs: int,
    progress: PrecomputeProgress,
) -> list[tuple[CaseDetail, ...]]:
    """The postures of designs of which the log holds none."""
    from evodesign.evaluation.baseline import Baseline
    from evodesign.evaluation.factory import evaluator_of  # CasADi takes its time to load

    for evaluation in bare:
        progress.note(f"the log holds no postures of design {evaluation.number}, so it is solved anew")
    if run.header.search.algorithm == JOINT_STARTS:
        solver: Baseline | Evaluator = Baseline(rebuilt.problem)
    else:
        solver = evaluator_of(rebuilt.problem, jobs, progress)
    return [solver.assess(evaluation.genome).cases for evaluation in bare]
