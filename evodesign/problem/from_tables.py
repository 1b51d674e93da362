"""Parts of a problem, each from the tables of its file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from evodesign.control.gains import Feedback
from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError, offered
from evodesign.mechanics.contact import Ground
from evodesign.mechanics.scene import Scene
from evodesign.pool.base import Limits
from evodesign.problem.design_geometry import joint_parameters, section_parameters
from evodesign.problem.design_hardware import actuator_parameters, wall_parameters, walls_of
from evodesign.problem.design_space import density_parameters
from evodesign.problem.file import DescriptorTable, ProblemFile
from evodesign.problem.unanswered_quantities import refuse_unanswered_quantity
from evodesign.problem.unknown_names import refuse_unknown, refuse_unlisted
from evodesign.quantities.objectives import OTHERWISE_CALLED, objective_kind, objective_kinds
from evodesign.quantities.push_quantities import SIMULATED, PushSettings
from evodesign.records import SUM, Constraint, Descriptor, Hold, Lift, Objective, ProblemSource, Sense, Task
from evodesign.simulation.pushable import refuse_unpushable
from evodesign.tree.model import Tree

GIGABYTE = 10**9


def ground_of(tables: ProblemFile) -> Ground:
    """Friction and least forces on the ground."""
    limits = tables.limits
    return Ground(limits.friction, limits.torsional_friction_m, limits.least_foot_force_n)


def worker_limits(tables: ProblemFile) -> Limits:
    """What one evaluation may take of time and memory."""
    solver = tables.solver
    return Limits(seconds=solver.evaluation_seconds, memory=int(solver.evaluation_memory_gb * GIGABYTE))


def tasks_of(tables: ProblemFile, source: ProblemSource) -> tuple[Task, ...]:
    """Holds, then lifts.

    Raises:
        InputError: there is none, or one twice.
    """
    heights = tables.task.heights_m or ()
    if not heights and not tables.task.lift:
        raise InputError(source.path, "task", "heights_m, a [[task.lift]], or both", "neither")
    for position, height in enumerate(heights):
        if height in heights[:position]:
            raise InputError(
                source.path, f"task.heights_m[{position}]", "each height once", f"{height:g} twice"
            )
    lifts: dict[str, Lift] = {}
    for position, table in enumerate(tables.task.lift):
        key = f"task.lift[{position}]"
        if table.from_m == table.to_m:
            found = f"{table.to_m:g}"
            raise InputError(source.path, f"{key}.to_m", "another height than from_m", found)
        lift = Lift(table.from_m, table.to_m, table.seconds, table.profile, table.knots)
        if lift.name in lifts:
            raise InputError(source.path, key, "each lift once", f"{lift} twice")
        lifts[lift.name] = lift
    return (*(Hold(height_m=height) for height in heights), *lifts.values())


def space_of(tables: ProblemFile, source: ProblemSource, tree: Tree) -> DesignSpace:
    """The hardware that may change, and the allocation of the load.

    Raises:
        InputError: no parameter, or one that the tree has no use for.
    """
    parameters = [
        DesignParameter(ParameterKind.LENGTH, t.name, t.links, t.lower, t.upper, keeps_mass=t.keep_mass)
        for t in tables.design.length
    ]
    _refuse_kept_mass(tables, source)
    parameters += density_parameters(tables, source)
    parameters += section_parameters(tables, source, tree)
    joints = joint_parameters(tables, source, tree)
    parameters += wall_parameters(tables, source)
    parameters += actuator_parameters(tables, source, tree)
    parameters += [
        DesignParameter(ParameterKind.ALLOCATION, t.name, (), t.lower, t.upper)
        for t in tables.design.allocation
    ]
    if not tables.robots:
        if parameters or tables.design.joint:
            raise InputError(source.path, "design", "a [robot] that it changes", "people alone")
        return DesignSpace(())
    if not parameters and not joints:
        raise InputError(source.path, "design", "a parameter, such as a length", "none")
    seen: dict[tuple[ParameterKind, str], str] = {}
    positions = dict.fromkeys(ParameterKind, 0)
    for parameter in parameters:
        key = f"design.{parameter.kind}[{positions[parameter.kind]}]"
        positions[parameter.kind] += 1
        _check_parameter(parameter, key, source, tree, seen)
    space = DesignSpace((*parameters, *joints), walls_of(tables, source, tree))
    if space.margins and tables.task.lift:
        actuators = enumerate(tables.design.actuator)
        position = next(number for number, table in actuators if table.margin is not None)
        wanted = "rated_torque_n_m or models, as a load is lifted"
        raise InputError(source.path, f"design.actuator[{position}].margin", wanted, "a margin")
    try:
        space.check(tree)
    except InputError as error:
        raise InputError(source.path, f"design ({error.key})", error.wanted, error.found) from error
    return space


def _refuse_kept_mass(tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse links that keep their masses and get others from a density or a wall."""
    others = {
        link: f"[[design.{kind}]] '{each.name}'"
        for kind, of_kind in (("density", tables.design.density), ("wall", tables.design.wall))
        for each in of_kind
        for link in each.links
    }
    for position, table in enumerate(tables.design.length):
        for link in table.links:
            if table.keep_mass and link in others:
                wanted = f"false, as {others[link]} gives '{link}' its mass"
                raise InputError(source.path, f"design.length[{position}].keep_mass", wanted, "true")


def _check_parameter(
    parameter: DesignParameter,
    key: str,
    source: ProblemSource,
    tree: Tree,
    seen: dict[tuple[ParameterKind, str], str],
) -> None:
    if parameter.lower >= parameter.upper and parameter.kind is not ParameterKind.MARGIN:
        unit = "_kg_per_m3" if parameter.kind is ParameterKind.DENSITY else ""
        wanted = f"less than upper{unit} ({parameter.upper:g})"
        raise InputError(source.path, f"{key}.lower{unit}", wanted, f"{parameter.lower:g}")
    for position, link in enumerate(parameter.links):
        where = f"{key}.links[{position}]"
        refuse_unknown(source, where, "link", link, tree.link_by_name, tree.name)
        if (parameter.kind, link) in seen:
            found = f"'{link}' also in {seen[parameter.kind, link]}"
            raise InputError(source.path, where, "a link in one parameter of a kind", found)
        seen[parameter.kind, link] = key
    if (parameter.kind, f"name {parameter.group}") in seen:
        raise InputError(source.path, f"{key}.name", "a unique name", f"'{parameter.group}' twice")
    seen[parameter.kind, f"name {parameter.group}"] = key


def objectives_of(
    tables: ProblemFile, source: ProblemSource, scenes: Sequence[Scene]
) -> tuple[Objective, ...]:
    """What a search improves.

    Raises:
        InputError: there is none, one twice, one that is not known, or one that lacks what it is a value of.
    """
    chosen = [
        *((Sense.MINIMISE, position, name) for position, name in enumerate(tables.objectives.minimise)),
        *((Sense.MAXIMISE, position, name) for position, name in enumerate(tables.objectives.maximise)),
    ]
    if not chosen:
        raise InputError(source.path, "objectives", "at least one objective", "none")
    names = [name for _, _, name in chosen]
    people = [person for scene in scenes for person in scene.people]
    objectives = []
    for sense, position, name in chosen:
        key = f"objectives.{sense}[{position}]"
        kind = objective_kind(name)
        if kind is None:
            known, found = offered(objective_kinds(), name, OTHERWISE_CALLED.get(name, name))
            raise InputError(source.path, key, f"one of {known}", found)
        if names.count(name) > 1:
            raise InputError(source.path, key, "each objective once", f"'{name}' twice")
        refuse_unanswered_quantity(key, name, tables, source, people)
        objectives.append(Objective(name=name, sense=sense, unit=kind.unit))
    return tuple(objectives)


def pushes_of(
    tables: ProblemFile, source: ProblemSource, scenes: Sequence[Scene], asked: Iterable[str]
) -> PushSettings | None:
    """The settings of simulated pushes; None where nothing asks for them.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        scenes: of the problem.
        asked: names of objectives and of constrained quantities.
    Raises:
        InputError: a simulated quantity without `[push]`, or nobody whom controllers can keep upright.
    """
    name = next((each for each in asked if each in SIMULATED), None)
    if name is None:
        return None
    if tables.push is None:
        raise InputError(source.path, "push", f"a [push] for '{name}'", "none")
    for scene in scenes:
        refuse_unpushable(scene, source.path, "push")
    feedback = Feedback(tables.push.frequency_rad_s, tables.push.damping_ratio)
    return PushSettings(tables.push.impulse_n_s, feedback)


LOWEST_REACH = "lowest_reach"
REACHES = (LOWEST_REACH, "highest_reach")
TORQUES = ("robot_torque", "human_torque")


def search_descriptors(
    tables: Sequence[DescriptorTable],
    parameters: Sequence[DesignParameter],
    quantities: Iterable[Objective | Constraint],
    tasks: Iterable[str],
    source: str,
) -> tuple[Descriptor, ...] | msgspec.UnsetType:
    """The descriptors of a search; sums of parameters have the sums of their bounds where none are given.

    Args:
        tables: of the file.
        parameters: of the design.
        quantities: objectives and constraints.
        tasks: their names, with which torques have names.
        source: the file, for messages.
    Raises:
        InputError: an unknown name, the same descriptor twice, or bounds that hold nothing.
    """
    bounds = {each.name: (each.lower, each.upper) for each in parameters}
    torques = [f"{name}@{task}" for task in tasks for name in TORQUES]
    known = [*bounds, *dict.fromkeys(each.name for each in quantities), *REACHES, *torques]
    found: list[Descriptor] = []
    for index, table in enumerate(tables):
        key, names = f"search.descriptor[{index}]", table.name.split(SUM)
        for name in names:
            wanted = f"a sum such as 'a{SUM}b' of {', '.join(known)}"
            refuse_unlisted(source, f"{key}.name", name, known, wanted)
        if table.name in [each.name for each in found]:
            raise InputError(source, f"{key}.name", "every descriptor once", f"'{table.name}' twice")
        lower, upper = table.lower, table.upper
        if all(name in bounds for name in names):
            lower = sum(bounds[name][0] for name in names) if lower is None else lower
            upper = sum(bounds[name][1] for name in names) if upper is None else upper
        if lower is not None and upper is not None and lower >= upper:
            raise InputError(source, f"{key}.upper", f"more than the lower bound {lower:g}", f"{upper:g}")
        found.append(Descriptor(table.name, lower, upper, table.cells))
    return tuple(found) or msgspec.UNSET
