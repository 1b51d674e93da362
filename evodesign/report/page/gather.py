"""From a run's log to what stands in its page.

Beyond 300 lines: one function for each part of the page's data.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from msgspec import to_builtins
from msgspec.structs import replace

from evodesign.analysis.active_limits import frequent_limits
from evodesign.analysis.failures import causes_of_infeasibility
from evodesign.analysis.families import families, families_json
from evodesign.analysis.front import front
from evodesign.analysis.gains import Gains, gains
from evodesign.analysis.growth import growth
from evodesign.analysis.importance import Importance, importance, slices
from evodesign.analysis.importance_json import importance_json
from evodesign.analysis.people_spread import all_spreads_json, spread_of_run
from evodesign.errors import EvodesignError, RunError
from evodesign.evaluation.clearance import Clearances
from evodesign.evaluation.factory import evaluator_of
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.evaluation.sensitivities import Sensitivities
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.designs import unscaled_genome
from evodesign.problem.left_out import left_out
from evodesign.problem.notes import assumed_heights
from evodesign.records import Detail, Evaluation, Hold, Lift, Task, evenly
from evodesign.report.page import marks
from evodesign.report.page.bodies import bodies, changes
from evodesign.report.page.card import StaticTorques, effort_content, hardware_content, over_people
from evodesign.report.page.content import (
    CauseContent,
    ClearanceContent,
    Content,
    DesignContent,
    Facts,
    Mark,
    StopContent,
)
from evodesign.report.page.downloads import Downloads, rounded
from evodesign.report.page.marks import MOST_POINTS, chosen_points, points
from evodesign.report.page.postures import MOMENTS, details_shown, shown_cases
from evodesign.report.subset import subsample
from evodesign.runlog.run import RunLog
from evodesign.runlog.sampled_file import read_sampled
from evodesign.tree.urdf_write import urdf_text
from evodesign.tree.words import words_of

MOST_LEARNT = 2_000
"""Evaluations that tell what matters in the page; beyond this number they are thinned out evenly."""

Gradients = dict[str, dict[str, float]]
"""Derivatives by objective, then by parameter."""


def page_content(run: RunLog, asked: Collection[int] = ()) -> Content:
    """What stands in the page of a run.

    Args:
        run: whole or cut off anywhere.
        asked: numbers of evaluations to mark, whose postures must be there.
    Raises:
        InputError: an asked number is not in the run.
    """
    problem, notes = _problem(run)
    best = front(run.header.objectives, run.evaluations)
    on_front = {evaluation.number for evaluation in best}
    gained = gains(run)
    marked = _marks(run, problem, best, gained, asked)
    kinds = families(run.header, run.evaluations)
    needed = {mark.number for mark in marked}
    elites = {kind.elite.number for kind in kinds.kinds}
    if len(needed | elites) < MOST_POINTS:
        needed |= elites
    shown = chosen_points(run.evaluations, on_front, needed, MOST_POINTS)
    opened, more_notes = details_shown(run.details, marked, shown, on_front)
    found = importance(run.header, subsample(run.evaluations, MOST_LEARNT))
    known = growth(run.generations)
    sampled, strange = read_sampled(run)
    spread = spread_of_run(run, sampled)
    cases = dict.fromkeys(outcome.case for each in run.evaluations for outcome in each.assessment.cases)
    tasks = tuple(dict.fromkeys(case.task for case in cases)) if problem is None else problem.tasks
    return Content(
        facts=_facts(run, len(best)),
        objectives=run.header.objectives,
        constraints=run.header.constrained,
        parameters=run.header.parameters,
        people=tuple(dict.fromkeys(case.person for case in cases)) or ("",),
        payloads=tuple(dict.fromkeys(case.payload for case in cases)) or ("",),
        heights_m=tuple(dict.fromkeys(height for task in tasks for height in task.heights)),
        stops=_stops(tasks),
        points=points(run.header, shown, on_front),
        marks=marked,
        generations=run.generations,
        growth="" if known is None else known.sentence,
        failures=tuple(
            CauseContent(cause=each.cause, count=each.count, example=each.example, reason=each.reason)
            for each in causes_of_infeasibility(run.evaluations, run.header.constrained)
        ),
        importance=importance_json(found),
        families=families_json(kinds),
        bodies=None if problem is None else bodies(problem),
        words={} if problem is None else _words(problem),
        urdf="" if problem is None else urdf_text(problem.scene.designed_tree),
        designs=_designs(run, problem, found, shown, opened, marked, on_front),
        notes=(
            *run.notes,
            *notes,
            *(() if gained is None else (gained.sentence,)),
            *_unscaled_note(run, problem, marked),
            *(() if problem is None else assumed_heights(problem)),
            *_thinned_note(run, shown),
            *(() if problem is None else more_notes),
            *(each.sentence for each in frequent_limits(run)),
            *left_out(run.header.problem),
            *strange,
        ),
        spread=None if spread is None else all_spreads_json(spread),
    )


def _words(problem: DesignProblem) -> dict[str, str]:
    """What joints and links of the people are called; a robot's keep their names."""
    trees = {id(person.tree): person.tree for scene in problem.scenes for person in scene.people}
    return {name: words for tree in trees.values() for name, words in words_of(tree).items()}


def _problem(run: RunLog) -> tuple[DesignProblem | None, tuple[str, ...]]:
    """The run's problem, rebuilt from the log; or a note on why this evodesign cannot."""
    try:
        return build_problem(run.header.problem), ()
    except EvodesignError as error:
        return None, (f"no robot is drawn, because the log's problem cannot be rebuilt: {error}",)


def _marks(
    run: RunLog,
    problem: DesignProblem | None,
    best: Sequence[Evaluation],
    gained: Gains | None,
    asked: Collection[int],
) -> tuple[Mark, ...]:
    first = () if problem is None else marks.unscaled(problem, run.evaluations)
    named = marks.asked(asked, run.evaluations)
    near = () if best else marks.nearest_to_feasible(run.evaluations)
    return (*first, *named, *marks.chosen(run.header.objectives, best), *marks.gained(gained), *near)


def _unscaled_note(run: RunLog, problem: DesignProblem | None, marked: Sequence[Mark]) -> tuple[str, ...]:
    if problem is None or not run.evaluations or any(mark.kind == "unscaled" for mark in marked):
        return ()
    if unscaled_genome(problem.space, problem.scene.designed_tree) is None:
        return ("the unscaled robot is no design of this problem: it is out of bounds or no choice",)
    return ("no evaluation of this run is of the unscaled robot",)


def _facts(run: RunLog, on_front: int) -> Facts:
    header = run.header
    return Facts(
        problem=header.problem_name,
        directory=str(run.directory),
        algorithm=header.search.algorithm,
        population=header.search.population,
        seed=header.search.seed,
        budget=header.budget,
        started=header.started,
        versions=header.versions,
        git=header.git,
        evaluations=len(run.evaluations),
        feasible=sum(evaluation.feasible for evaluation in run.evaluations),
        front=on_front,
        seconds=sum(evaluation.seconds for evaluation in run.evaluations),
        problem_text=header.problem.text,
    )


def _stops(tasks: Iterable[Task]) -> tuple[StopContent, ...]:
    """Every load held still, and the moments of every lift."""
    tasks = tuple(tasks)
    alone = sum(isinstance(task, Lift) for task in tasks) < 2
    decimals = max(
        [1, *(len(str(task.height_m).partition(".")[2]) for task in tasks if isinstance(task, Hold))]
    )
    found: list[StopContent] = []
    for task in tasks:
        told, name = task.result_times if isinstance(task, Lift) else task.times, str(task)
        for moment, place in enumerate(evenly(len(told), MOMENTS)):
            if isinstance(task, Hold):
                text = f"{task.height_m:.{decimals}f} m"
            else:
                text = f"{told[place]:.2f} s" if alone else f"{told[place]:.2f} s of {task.name}"
            height, time = task.heights[0], told[place]
            found.append(
                StopContent(task=task, moment=moment, height_m=height, time_s=time, text=text, name=name)
            )
    return tuple(found)


def _thinned_note(run: RunLog, shown: Sequence[Evaluation]) -> tuple[str, ...]:
    if len(shown) == len(run.evaluations):
        return ()
    return (
        f"{len(shown)} of {len(run.evaluations)} evaluations are in this page: the marked designs, then the "
        "front, then the others, evenly thinned; figures over evaluations and failures count all of them",
    )


def _designs(
    run: RunLog,
    problem: DesignProblem | None,
    found: Importance,
    shown: Sequence[Evaluation],
    opened: dict[int, Detail],
    marked: Sequence[Mark],
    on_front: Collection[int],
) -> dict[int, DesignContent]:
    """The front and the marked designs, these with slices through them."""
    recorded = {mark.number for mark in marked}
    known = None if problem is None else _Known.of(problem, run)
    header = run.header
    quantities = [*(each.name for each in header.objectives), *(each.name for each in header.constrained)]
    return {
        evaluation.number: replace(
            _design(known, evaluation, opened.get(evaluation.number), recorded),
            people=over_people(quantities, evaluation.assessment.cases),
            weakest=evaluation.assessment.weakest_pushes,
            slices=to_builtins(slices(found, header.parameters, evaluation))
            if evaluation.number in recorded
            else [],
        )
        for evaluation in shown
        if evaluation.number in recorded or evaluation.number in on_front
    }


@dataclass(frozen=True, slots=True)
class _Known:
    """What the run's problem, built again, tells of its designs."""

    problem: DesignProblem
    clearances: Clearances
    statics: StaticTorques
    downloads: Downloads

    @classmethod
    def of(cls, problem: DesignProblem, run: RunLog) -> _Known:
        scenes = problem.scenes
        return cls(problem, Clearances(scenes), StaticTorques(scenes), Downloads(problem, run))


def _design(
    known: _Known | None,
    evaluation: Evaluation,
    detail: Detail | None,
    recorded: Collection[int],
) -> DesignContent:
    cases = tuple(replace(case, disturbed={}) for case in evaluation.assessment.cases)
    if known is None or detail is None:
        return rounded(DesignContent(cases=cases))
    problem = known.problem
    space, assessment = problem.space, evaluation.assessment
    values = space.given(space.values_of(assessment.design), assessment.rated_torques)
    links, joints = changes(problem, values)
    robot = problem.space.resized(problem.scene.designed_tree, values)
    postures = shown_cases(detail.cases)
    try:
        found = known.clearances.of(robot, detail.cases)
        static_torques, limits = known.statics.of(robot, postures)
        efforts = effort_content(problem.scenes, detail.cases)
    except RunError:  # postures of strangers, whom the page does not draw
        found, static_torques, limits, efforts = [], (), {}, ()
    nearest = tuple(
        ClearanceContent(first=each.first, second=each.second, distance_m=each.distance) for each in found
    )
    return rounded(
        DesignContent(
            cases=cases,
            postures=postures,
            clearances=nearest,
            efforts=efforts,
            static_torques=static_torques,
            torque_limits=limits,
            links=links,
            joints=joints,
            hardware=hardware_content(problem, robot, detail.cases),
            urdf=known.downloads.urdf(robot),
            replay=known.downloads.replay(robot, detail) if evaluation.number in recorded else "",
        )
    )


def with_gradients(content: Content, run: RunLog, jobs: int, progress: PrecomputeProgress) -> Content:
    """The page with the gradients of its marked designs; arguments as in `gradients_of`."""
    numbers = dict.fromkeys(mark.number for mark in content.marks if mark.number in content.designs)
    found = gradients_of(run, numbers, jobs, progress)
    designs = {
        number: replace(design, gradients=found.get(number, {})) for number, design in content.designs.items()
    }
    return replace(content, designs=designs)


def gradients_of(
    run: RunLog, numbers: Iterable[int], jobs: int, progress: PrecomputeProgress
) -> dict[int, Gradients]:
    """The gradients of some designs of a run, solved anew; objectives that have none are left out.

    Args:
        run: whose problem is built again.
        numbers: of evaluations.
        jobs: that work out what the problem needs once.
        progress: is shown what is worked out.
    """
    problem = build_problem(run.header.problem)
    evaluator = evaluator_of(problem, jobs, progress)
    derivatives = Sensitivities(problem, evaluator.known)
    genomes = {evaluation.number: evaluation.genome for evaluation in run.evaluations}
    found = {}
    for number in numbers:
        values = problem.space.values(genomes[number])
        sensitivities = derivatives.at(values, evaluator.solve(values)).sensitivities()
        found[number] = {
            name: dict(each.gradient) for name, each in sensitivities.items() if each.gradient is not None
        }
    return found
