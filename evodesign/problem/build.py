"""From a problem's text to a problem: every name resolved, every number checked.

Beyond 300 lines: a problem's record and the function that fills it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import msgspec

from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.mechanics.stance_case import StanceCase
from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.solver import available
from evodesign.pool.base import Limits
from evodesign.posture.allocation import EffortWeights
from evodesign.posture.formulations.codesign import JointSettings
from evodesign.posture.postures import Symmetry
from evodesign.problem.agents import human_agents, robot_agents
from evodesign.problem.collisions import with_collisions
from evodesign.problem.constraints import constraints_of, refuse_constraints, with_what_can_be_built
from evodesign.problem.design_geometry import joint_ranges_of
from evodesign.problem.design_space import check_allocations, effort_weights, refuse_choices, robot_share
from evodesign.problem.designs import read_designs, start_genomes, unscaled_genome
from evodesign.problem.file import ProblemFile, SearchTable
from evodesign.problem.from_tables import (
    LOWEST_REACH,
    ground_of,
    objectives_of,
    pushes_of,
    search_descriptors,
    space_of,
    tasks_of,
    worker_limits,
)
from evodesign.problem.joint_settings import joint_settings, joint_start
from evodesign.problem.loads import held_by, payloads, refuse_stiff_arms, scene_disturbances
from evodesign.problem.samples import samples_of
from evodesign.problem.source import decode_toml
from evodesign.problem.stance_limits import stance_of
from evodesign.problem.standing_cases import standing_cases
from evodesign.problem.symmetric import resolved_symmetry
from evodesign.problem.teams import refuse_what_teams_lack, teams_of
from evodesign.problem.torque_limits import refuse_unlimited
from evodesign.problem.unknown_names import refuse_unlisted
from evodesign.quantities.objectives import SHARED_REACH
from evodesign.quantities.push_quantities import PushSettings
from evodesign.records import (
    SUM,
    Case,
    Constraint,
    Genome,
    Hold,
    Lift,
    Objective,
    ProblemSource,
    SearchSettings,
    Sense,
    Task,
)
from evodesign.searches.base import GRADIENT_SEARCHES, JOINT_STARTS, POPULATIONS, USUAL_POPULATION

BELOW = 0.1
"""How far below the lowest height of a task it is asked whether the robot holds the load [m]."""


@dataclass(frozen=True, slots=True)
class DesignProblem:
    """Robots, people if there are any, loads, tasks, and the hardware that may change.

    Args:
        name: of the problem.
        source: its files, from which any worker builds it again.
        scenes: every team with every load, ground and stance; all loads of a team in a row.
        space: design parameters.
        tasks: what everyone does with every load.
        weights: of the agents' efforts in the posture problem.
        objectives: in the file's order, minimised ones first.
        constraints: bounds of quantities, in the file's order.
        options: of the inner solver.
        limits: of one evaluation.
        symmetry: which postures are looked for: on, off or polish.
        symmetry_notes: what was averaged for them, or why they are whole.
        start_portfolio: whether solves begin at the problem's start portfolio.
        search: the file's `[search]` table.
        start: genomes that a search begins with; the unscaled robot is the first wherever it is a design.
        joint: the paper's joint problem.
        joint_start: genomes that its starts begin with.
        stances: postures in which the robot stands alone, for what they ask of actuators.
        samples: how many people of measured distributions answer for a front; 0 for none.
        pushes: that are simulated; None where no quantity asks for them.
        whole_reach: whether the lowest load of all is asked for, and not only what tasks need.
    """

    name: str
    source: ProblemSource
    scenes: tuple[Scene, ...]
    space: DesignSpace
    tasks: tuple[Task, ...]
    weights: EffortWeights
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...]
    options: SolverOptions
    limits: Limits
    symmetry: Symmetry
    symmetry_notes: tuple[str, ...]
    start_portfolio: bool
    search: SearchTable
    start: tuple[Genome, ...]
    joint: JointSettings
    joint_start: tuple[Genome, ...]
    stances: tuple[StanceCase, ...] = ()
    samples: int = 0
    pushes: PushSettings | None = None
    whole_reach: bool = False

    def __repr__(self) -> str:
        return f"<built problem {self.name}: {len(self.space.parameters)} parameters>"

    @property
    def scene(self) -> Scene:
        """The first scene: all of them have its robots, ground and stance."""
        return self.scenes[0]

    @property
    def person_reaches(self) -> bool:
        """Whether the people's own reach counts: it is asked for, or there are several of them."""
        several = len({scene.pair[0] for scene in self.scenes}) > 1
        names = {each.name for each in self.objectives} | {each.name for each in self.constraints}
        return several or SHARED_REACH in names

    @property
    def middle(self) -> Scene:
        """The scene in the middle of the list, which stands for all where one must do."""
        return self.scenes[len(self.scenes) // 2]

    @property
    def holds(self) -> tuple[Hold, ...]:
        """The loads held still: those asked for, and both ends of every lift."""
        lifts = [task for task in self.tasks if isinstance(task, Lift)]
        ends = [Hold(height_m=height) for lift in lifts for height in lift.heights]
        return tuple(dict.fromkeys([*(task for task in self.tasks if isinstance(task, Hold)), *ends]))

    @property
    def lowest_asked(self) -> float:
        """Height of the load [m] below which nobody asks whether the robot holds it."""
        names = {name for each in self.search.descriptor for name in each.name.split(SUM)}
        if self.whole_reach or LOWEST_REACH in names:
            return 0.0
        return max(min(height for task in self.tasks for height in task.heights) - BELOW, 0.0)

    @property
    def named_heights(self) -> dict[str, float]:
        """Every height [m] that the problem asks for, by its key in the file."""
        holds = [task for task in self.tasks if isinstance(task, Hold)]
        lifts = [task for task in self.tasks if isinstance(task, Lift)]
        found = {f"task.heights_m[{place}]": task.height_m for place, task in enumerate(holds)}
        for place, task in enumerate(lifts):
            found |= {f"task.lift[{place}].from_m": task.from_m, f"task.lift[{place}].to_m": task.to_m}
        return found

    @property
    def moves(self) -> bool:
        """Whether a load is lifted."""
        return any(isinstance(task, Lift) for task in self.tasks)

    @property
    def cases(self) -> tuple[Case, ...]:
        """Every undisturbed case: all tasks of a person with a load in a row."""
        return tuple(scene.case(task) for scene in self.scenes for task in self.tasks)

    def scene_of(self, case: Case) -> Scene:
        """The scene of a case."""
        return scene_of(self.scenes, case.pair)

    def settings(
        self,
        algorithm: str | None = None,
        population: int | None = None,
        seed: int | None = None,
        asynchronous: bool | None = None,
    ) -> SearchSettings:
        """Settings of a search over this problem: those given, and the file's for the others.

        Raises:
            InputError: starts of the joint problem, and a density of materials or a constraint.
        """
        table = self.search
        if not self.space.free:
            raise InputError(
                self.source.path, "design", "a robot and a parameter of it to search", "people alone"
            )
        algorithm = table.algorithm if algorithm is None else algorithm
        if algorithm == JOINT_STARTS:
            refuse_constraints(self.constraints, self.source)
            refuse_choices(self.space, self.source)
        if population is None:
            population = (
                POPULATIONS.get(algorithm, USUAL_POPULATION) if table.population is None else table.population
            )
        if self.moves and algorithm == JOINT_STARTS:
            found = f"'{algorithm}'"
            raise InputError(self.source.path, "search.algorithm", "another where a load is lifted", found)
        gradients = algorithm in GRADIENT_SEARCHES if table.gradients is None else table.gradients
        return SearchSettings(
            algorithm=algorithm,
            dimension=len(self.space.free),
            objectives=len(self.objectives),
            population=population,
            seed=table.seed if seed is None else seed,
            start=self.joint_start if algorithm == JOINT_STARTS else self.start,
            asynchronous=table.asynchronous if asynchronous is None else asynchronous,
            choices=self.space.counts if any(self.space.counts) else msgspec.UNSET,
            reference=self._reference(),
            descriptors=search_descriptors(
                table.descriptor,
                self.space.parameters,
                (*self.objectives, *self.constraints),
                (task.name for task in self.tasks),
                self.source.path,
            ),
            gradients=True if gradients and algorithm != JOINT_STARTS else msgspec.UNSET,
        )

    def _reference(self) -> tuple[float | None, ...] | msgspec.UnsetType:
        """The reference point that the file gives, as objectives are minimised."""
        given = self.search.reference
        signs = {each.name: -1.0 if each.sense is Sense.MAXIMISE else 1.0 for each in self.objectives}
        for name in given:
            wanted = f"one of the objectives {', '.join(signs)}"
            refuse_unlisted(self.source.path, f"search.reference.{name}", name, signs, wanted)
        if not given:
            return msgspec.UNSET
        return tuple(sign * given[name] if name in given else None for name, sign in signs.items())


def build_problem(source: ProblemSource) -> DesignProblem:
    """The problem of a source.

    Raises:
        InputError: naming file, key, what was wanted and what was found.
    """
    tables = decode_toml(source.text, source.path, ProblemFile)
    robots, ground, stance = robot_agents(tables, source), ground_of(tables), stance_of(tables, source)
    for robot in robots[:1]:
        refuse_unlimited(tables, source, robot)
    people, loads = human_agents(tables, source), payloads(tables, source)
    teams = teams_of(tables, source, robots, people)
    refuse_what_teams_lack(tables, source, teams[0])
    loads = tuple(held_by(load, teams[0]) for load in loads)
    refuse_stiff_arms(source, loads, (*robots, *people))
    disturbances = scene_disturbances(tables, source, (*robots, *people), loads)
    scenes = tuple(Scene(team, load, ground, stance, disturbances) for team in teams for load in loads)
    check_allocations(tables, source)
    scenes = tuple(replace(scene, robot_share=robot_share(tables, source, scene)) for scene in scenes)
    space = space_of(tables, source, scenes[0].designed_tree)
    scenes = tuple(
        scene.with_agents(
            *(replace(robot, chosen_ranges=joint_ranges_of(space, robot, source)) for robot in scene.designed)
        )
        if any(parameter.changes for parameter in space.parameters)
        else scene
        for scene in scenes
    )
    resolved = resolved_symmetry(tables, source, scenes, space)
    scenes = with_collisions(tables, source, resolved.scenes, space)
    tree = scenes[0].designed_tree
    people = tuple({id(person): person for scene in scenes for person in scene.people}.values())
    start: dict[str, Genome] = {}
    if tables.search.start is not None:
        name = tables.search.start
        designs = read_designs(source.files[name], name, space, tree)
        start = dict(zip(designs, start_genomes(designs, space, name), strict=True))
    unscaled = unscaled_genome(space, tree)
    first = () if unscaled is None else (unscaled,)
    weights = effort_weights(tables)
    options = SolverOptions(
        iterations=tables.solver.iterations,
        seconds=tables.solver.seconds,
        compiled=tables.solver.compile,
        method=tables.solver.method if source.method is None else MethodName(source.method),
    )
    options = available(options)
    constraints = constraints_of(tables, source, robots[:1], people)
    objectives = objectives_of(tables, source, scenes)
    asked = [*(each.name for each in objectives), *(each.name for each in constraints)]
    return DesignProblem(
        name=tables.name,
        source=msgspec.structs.replace(source, method=options.method),
        scenes=scenes,
        space=space,
        tasks=tasks_of(tables, source),
        weights=weights,
        objectives=objectives,
        constraints=with_what_can_be_built(constraints, scenes[0].designed, space),
        options=options,
        limits=worker_limits(tables),
        symmetry=resolved.symmetry,
        symmetry_notes=resolved.notes,
        start_portfolio=tables.solver.start_portfolio,
        search=tables.search,
        start=tuple(dict.fromkeys((*first, *start.values()))),
        joint=joint_settings(tables, source, space, weights, resolved.symmetry),
        joint_start=joint_start(tables, source, start),
        stances=standing_cases(tables, source, scenes[0].designed),
        samples=samples_of(tables, source),
        pushes=pushes_of(tables, source, scenes, asked),
    )
