"""What a number of a problem file is worth: change it, build the problem again, solve again.

Nothing of multipliers is used: the least costs of two problems are subtracted.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace

import msgspec
import tomli_w

from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import StanceLimits
from evodesign.mechanics.scene import Scene
from evodesign.nlp.solver import SolverCache
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.joint import JointPostures
from evodesign.posture.precompute.meetings import with_meetings
from evodesign.posture.results import CaseSolution
from evodesign.posture.symmetry import symmetric_forms, whole
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.task_tables import CollisionsTable, LimitsTable
from evodesign.records import ActiveLimit

STEPS = {"m": 1e-4, "rad": 1e-4, "N": 0.05, "N m": 0.02, "1": 1e-4}

Number = tuple[str, bool]
"""A key of the problem file, and whether it is the most that is allowed."""


def prices(limits: tuple[ActiveLimit, ...]) -> dict[Number, tuple[float, float]]:
    """The price of each number of the problem file [N m per unit], of both agents, and the step to take."""
    found: dict[Number, tuple[float, float]] = {}
    for limit in limits:
        if limit.key:
            before = found.get((limit.key, limit.at_most), (0.0, 0.0))[0]
            found[limit.key, limit.at_most] = before + limit.price_n_m, STEPS[limit.unit]
    return found


def with_number(problem: DesignProblem, number: Number, step: float) -> DesignProblem:
    """The problem built from a file in which a number is larger by a step [SI]."""
    (key, at_most), tables = number, tomllib.loads(problem.source.text)
    *path, name = key.split(".")
    table = tables
    for part in path:
        table = table.setdefault(part, {})
    defaults = {**defaults_of(LimitsTable()), **defaults_of(CollisionsTable())}
    value = table.get(name, defaults.get(name))
    if value is None:  # of the size of who stands
        return _with_stance(problem, name.removesuffix("_m"), step, at_most=at_most)
    step = math.degrees(step) if name.endswith("_deg") else step
    if isinstance(value, list | tuple):
        place = 1 if at_most else 0
        table[name] = [each + step * (where == place) for where, each in enumerate(value)]
    else:
        table[name] = value + step
    return as_before(
        problem, build_problem(msgspec.structs.replace(problem.source, text=tomli_w.dumps(tables)))
    )


def _with_stance(problem: DesignProblem, name: str, step: float, *, at_most: bool) -> DesignProblem:
    """The problem with a limit of stance larger by a step [m], of robot and person."""

    def moved(stance: StanceLimits) -> StanceLimits:
        value = getattr(stance, name)
        if isinstance(value, tuple):
            return replace(
                stance, **{name: tuple(each + step * (at == at_most) for at, each in enumerate(value))}
            )
        return replace(stance, **{name: value + step})

    def changed(scene: Scene) -> Scene:
        own = [agent for agent in scene.agents if agent.stance is not None]
        changed = scene.with_agents(*(replace(agent, stance=moved(agent.stance)) for agent in own))
        return replace(changed, stance=moved(scene.stance))

    return as_before(problem, scene_with(problem, changed))


def defaults_of(table: msgspec.Struct) -> dict[str, object]:
    return msgspec.structs.asdict(table)


def as_before(problem: DesignProblem, other: DesignProblem) -> DesignProblem:
    """With the solver's options of a problem, without compiling."""
    return replace(other, options=replace(problem.options, compiled=False))


def with_robot_joint(problem: DesignProblem, joint: str, step: float, *, upper: bool) -> DesignProblem:
    """The problem built from a URDF in which one end of a joint's range is larger by a step [rad]."""
    (name,) = (name for name in problem.source.files if name.endswith("icub_shapes.urdf"))
    text = problem.source.files[name]
    end = "upper" if upper else "lower"
    found = re.search(rf'<joint name="{joint}".*?{end}="([^"]*)"', text, re.DOTALL)
    assert found is not None
    moved = f"{float(found[1]) + step!r}"
    text = text[: found.start(1)] + moved + text[found.end(1) :]
    files = {**problem.source.files, name: text}
    return as_before(problem, build_problem(msgspec.structs.replace(problem.source, files=files)))


def with_persons_joints(problem: DesignProblem, joints: dict[str, float], *, upper: bool) -> DesignProblem:
    """The problem with a person one end of whose joints' ranges is larger by steps [rad]."""
    human = problem.scene.human
    end = "upper" if upper else "lower"
    moved = tuple(
        replace(joint, **{end: getattr(joint, end) + joints[joint.name]}) if joint.name in joints else joint
        for joint in human.tree.joints
    )
    human = replace(human, tree=human.tree.reshaped(human.tree.links, moved))
    return replace(problem, scenes=tuple(scene.with_agents(human) for scene in problem.scenes))


def effort(evaluator: Evaluator, problem: DesignProblem, values: object, solution: CaseSolution) -> float:
    """The effort [N m] of the optimum of robot and person together next to a solution, in another problem."""
    scene = next(scene for scene in problem.scenes if scene.pair == solution.case.pair)
    scene = with_meetings(scene, evaluator.known.meetings)
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    assert solution.attempt is not None
    of_halves = solution.attempt.formulation != "whole"
    forms = symmetric_forms(scene) if of_halves else (whole(scene.robot), whole(scene.human))
    postures, raw = JointPostures("resolved", forms, setting, SolverCache()), solution.raw
    assert raw is not None
    found = postures.followed(values, solution, raw)  # type: ignore[arg-type]
    assert found is not None
    assert found.raw is not None
    return 10.0 * math.sqrt(found.raw.cost)


def slope(
    evaluator: Evaluator,
    changed: Callable[[float], DesignProblem],
    step: float,
    values: object,
    solution: CaseSolution,
) -> float:
    """d effort / d number by central differences [N m per unit]."""
    above, below = (effort(evaluator, changed(sign * step), values, solution) for sign in (1.0, -1.0))
    return (above - below) / (2.0 * step)


def scene_with(problem: DesignProblem, change: Callable[[Scene], Scene]) -> DesignProblem:
    return replace(problem, scenes=tuple(change(scene) for scene in problem.scenes))
