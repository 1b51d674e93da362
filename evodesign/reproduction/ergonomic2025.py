"""The robots of 2025 beside the iCub, with the paper's person and measured ones, and two searches of ours.

The published robots differ from ours in where hips and chest are (`populations/sartore2025_robots.toml`), so
the problem gets these two offsets and the pelvis' length as parameters, which robots of the searches leave as
they are.
One search minimises the paper's cost. The other has the three objectives of this project; shown is its design
of least robot torque among those that reach as high as B and beside which the person needs no more torque.

Source: Sartore et al. 2025, published code (ami-iit/paper_sartore_2025_ergocub_nature_machine_intelligence).
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from evodesign.design.parameter import ParameterKind
from evodesign.errors import InputError
from evodesign.problem.build import DesignProblem
from evodesign.problem.designs import read_designs
from evodesign.problem.named_files import read_text
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.objectives import objective_value
from evodesign.records import Evaluation
from evodesign.report.csv_text import csv_text
from evodesign.reproduction.claims2022 import Claim
from evodesign.reproduction.claims2025 import (
    BY_COST,
    BY_FRONT,
    LOWER,
    OPTIMISED,
    ErgonomicRobot,
    cost_claim,
    front_claim,
    human_claim,
    reach_claim,
    robot_claim,
)
from evodesign.reproduction.experiment import (
    MEASURED,
    Experiment,
    changed_problem,
    chosen,
    reproduced,
    torque_norms,
    value_of,
)
from evodesign.reproduction.files2022 import ReproducedRobot, write_file, write_reproduction
from evodesign.runlog.run import RunLog

COST, HUMAN, ROBOT = "paper2025_cost", "human_torque", "robot_torque"
REACH = "reach_height"
OUR_OBJECTIVES = {"minimise": [ROBOT, HUMAN], "maximise": [REACH]}
DEFAULT = "icub-lifting"
"""The problem whose people are the measured ones beside the paper's."""

ROBOTS = SHIPPED.parent / "populations" / "sartore2025_robots.toml"
UP, FARTHEST = [0.0, 0.0, 1.0], 0.03
JOINTS = [
    {"name": "hips", "joints": ["l_hip_pitch", "r_hip_pitch"]},
    {"name": "chest", "joints": ["torso_yaw"]},
]
"""Where the published robots' joints differ from ours, up or down by at most 30 mm."""

PELVIS = {"name": "pelvis", "links": ["root_link"], "lower": 0.5, "upper": 1.8, "keep_mass": True}
"""Their eighth length."""

AS_PUBLISHED, AS_MEASURED = "least torque", "measured posture"
"""The paper's person as the paper has it, and standing as people do who were measured."""


def as_published(problem: DesignProblem, tables: Mapping[str, Any] | None = None) -> DesignProblem:
    """The problem with all parameters of the published robots, and with other tables changed."""
    offsets = [{**joint, "offset_m": [-FARTHEST, FARTHEST], "along": UP} for joint in JOINTS]
    lengths = [*tomllib.loads(problem.source.text)["design"]["length"], PELVIS]
    return changed_problem(problem, {"design": {"length": lengths, "joint": offsets}, **(tables or {})})


def published_robots(problem: DesignProblem) -> dict[str, tuple[float, ...]]:
    """Parameter values of the iCub and of robots A, B and C, of the problem `as_published`."""
    text = read_text(ROBOTS, str(ROBOTS), "")
    return read_designs(text, str(ROBOTS), problem.space, problem.scene.designed_tree)


def ergonomic_reproduction(experiment: Experiment) -> ErgonomicReproduction:
    """Run everything.

    Raises:
        InputError: the problem does not minimise the cost of 2025, or has other parameters than lengths, or
            than its robots.
    """
    problem = experiment.problem
    if [objective.name for objective in problem.objectives] != [COST]:
        found = ", ".join(objective.name for objective in problem.objectives)
        raise InputError(problem.source.path, "objectives", COST, found)
    for parameter in problem.space.parameters:
        if parameter.kind is not ParameterKind.LENGTH:
            raise InputError(problem.source.path, "design", "lengths alone", parameter.name)
    offered = as_published(problem)
    designs = published_robots(offered)
    results = experiment.solved(offered, designs, "the robots of 2025")
    optimised = {name: results[name] for name in OPTIMISED}
    runs, found_by = _searches(experiment, optimised)
    unscaled = offered.space.named(offered.space.unscaled(offered.scene.designed_tree))
    ours = {
        name: tuple({**unscaled, **each.assessment.design}.values())
        for name, each in found_by.items()
        if each is not None
    }
    designs |= ours
    results |= experiment.solved(offered, ours, "the robots of our searches")
    others = _beside_others(experiment, designs)
    robots = {
        name: ErgonomicRobot(
            mass=float(result.tree.mass),
            highest=result.reach.highest,
            cost=objective_value(COST, result),
            by_person={
                AS_PUBLISHED: torque_norms(result),
                **{label: torque_norms(beside[name], person) for label, person, beside in others},
            },
        )
        for name, result in results.items()
    }
    return ErgonomicReproduction(
        robots=robots,
        pictured=tuple(reproduced(offered, name, f"robot {name}", each) for name, each in results.items()),
        designs={name: offered.space.named(values) for name, values in designs.items()},
        runs=runs,
        chosen={name: None if each is None else each.number for name, each in found_by.items()},
        claims=_claims(robots, problem, runs, optimised),
    )


def _searches(
    experiment: Experiment, optimised: Mapping[str, DesignResult]
) -> tuple[dict[str, RunLog], dict[str, Evaluation | None]]:
    """Our two searches, and the design of each that is shown; None of one without feasible designs."""
    effort, problem = experiment.effort, experiment.problem
    ours = replace(experiment, problem=changed_problem(problem, {"objectives": OUR_OBJECTIVES}))
    runs = {
        BY_COST: experiment.logged(BY_COST, problem.settings(seed=effort.seed), effort.evaluations, 0.5),
        BY_FRONT: ours.logged(
            BY_FRONT, ours.problem.settings("nsga2", 48, effort.seed), effort.evaluations, 1.0
        ),
    }
    torque, reach = (objective_value(each, optimised["B"]) for each in (HUMAN, REACH))
    cap = None if torque is None else torque * (1.0 + LOWER)

    def reaching(each: Evaluation) -> float:
        return value_of(HUMAN)(each) if value_of(REACH)(each) >= (reach or 0.0) else math.inf

    return runs, {
        BY_COST: chosen(runs[BY_COST], value_of(COST), None, value_of(COST)),
        BY_FRONT: chosen(runs[BY_FRONT], reaching, cap, value_of(ROBOT)),
    }


def _beside_others(
    experiment: Experiment, designs: Mapping[str, Sequence[float]]
) -> list[tuple[str, str | None, dict[str, DesignResult]]]:
    """The robots beside the paper's person in a measured posture, and beside the people of the default.

    Returns:
        Of each person a label, the name in the problem's cases, and the results of all robots.
    """
    standing = as_published(experiment.problem, MEASURED)
    people = as_published(experiment.problem, {"human": tomllib.loads(read_source(DEFAULT).text)["human"]})
    beside = experiment.solved(standing, designs, "beside a measured posture")
    found: list[tuple[str, str | None, dict[str, DesignResult]]] = [(AS_MEASURED, None, beside)]
    beside = experiment.solved(people, designs, f"beside the people of {DEFAULT}")
    names = dict.fromkeys(case.person for case in people.cases)
    return [*found, *((name, name, beside) for name in names)]


def _claims(
    robots: Mapping[str, ErgonomicRobot],
    problem: DesignProblem,
    runs: Mapping[str, RunLog],
    optimised: Mapping[str, DesignResult],
) -> tuple[Claim, ...]:
    people = [*next(iter(robots.values())).by_person]
    costs, front = (
        [each for each in runs[name].evaluations if each.feasible] for name in (BY_COST, BY_FRONT)
    )
    dominating = {name: sum(_dominates(each, result) for each in front) for name, result in optimised.items()}
    return (
        reach_claim(robots, [height for task in problem.tasks for height in task.heights]),
        *(human_claim(robots, person) for person in people),
        *(robot_claim(robots, person) for person in people),
        cost_claim(robots, [*map(value_of(COST), costs)]),
        front_claim(robots, dominating, len(front)),
    )


def _dominates(each: Evaluation, robot: DesignResult) -> bool:
    """Whether a design reaches as high with less robot torque and no more torque of the person."""
    torque, human, reach = (objective_value(name, robot) for name in (ROBOT, HUMAN, REACH))
    if torque is None or human is None or reach is None:
        return False
    return (
        value_of(ROBOT)(each) < torque * (1.0 - LOWER)
        and value_of(HUMAN)(each) < human * (1.0 + LOWER)
        and value_of(REACH)(each) >= reach
    )


TABLE = "robots.csv"
COLUMNS = ("robot", "person", "height_m", "robot_torque_n_m", "human_torque_n_m", "back_compression_n")


@dataclass(frozen=True, slots=True)
class ErgonomicReproduction:
    """Everything that is shown.

    Args:
        robots: the iCub, the published robots, then those of our searches, by name.
        pictured: the same with their postures beside the paper's person.
        designs: their parameters, by name.
        runs: our searches, by the name of their robot.
        chosen: number of that robot in its run; None where that has no feasible one.
        claims: each with its verdict.
    """

    robots: Mapping[str, ErgonomicRobot]
    pictured: tuple[ReproducedRobot, ...]
    designs: Mapping[str, Mapping[str, float]]
    runs: Mapping[str, RunLog]
    chosen: Mapping[str, int | None]
    claims: tuple[Claim, ...]


def write_ergonomic(directory: Path, done: ErgonomicReproduction) -> tuple[Path, ...]:
    """Write table, figures and robots into an existing directory.

    Raises:
        InputError: a file cannot be written.
    """
    rows = [
        (name, person, height, norms.robot, norms.human, norms.back)
        for name, robot in done.robots.items()
        for person, by_height in robot.by_person.items()
        for height, norms in by_height.items()
    ]
    table = write_file(directory / TABLE, csv_text([COLUMNS, *rows]))
    return table, *write_reproduction(directory, done.pictured, ())


def ergonomic_json(
    done: ErgonomicReproduction, directory: Path, files: Iterable[Path], seconds: float
) -> dict[str, Any]:
    """A reproduction of 2025 as a JSON object; its shape is a promise. [N m], [N], [kg], [m]."""
    return {
        "directory": str(directory),
        "robots": {
            name: {
                "mass": robot.mass,
                "highest": robot.highest,
                "cost": robot.cost,
                "by_person": {
                    person: [
                        {"height_m": height, **msgspec.to_builtins(norms)} for height, norms in held.items()
                    ]
                    for person, held in robot.by_person.items()
                },
                "parameters": dict(done.designs[name]),
            }
            for name, robot in done.robots.items()
        },
        "claims": msgspec.to_builtins(list(done.claims)),
        "searches": {
            name: {
                "run": str(run.directory),
                "evaluation": done.chosen[name],
                "evaluations": len(run.evaluations),
                "infeasible": sum(not each.feasible for each in run.evaluations),
            }
            for name, run in done.runs.items()
        },
        "files": [str(path) for path in files],
        "seconds": seconds,
    }
