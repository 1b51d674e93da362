"""The design space of a problem file: densities and materials, and how robot and person divide the work.

A density lies within bounds or is that of a material, from `body.material.CATALOGUE` and the problem's own
`[[material]]` tables together. Every contradiction is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from evodesign.body.material import CATALOGUE, Material
from evodesign.design.parameter import ALLOCATIONS, EFFORT_RATIO, ROBOT_SHARE, DesignParameter, ParameterKind
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError
from evodesign.mechanics.load_share import share_interval
from evodesign.mechanics.scene import Scene
from evodesign.posture.allocation import EffortWeights
from evodesign.problem.design_table import AllocationTable, DensityTable
from evodesign.problem.file import ProblemFile
from evodesign.problem.unknown_names import refuse_unfit_choices, refuse_unlisted
from evodesign.records import ProblemSource

BOUNDS = ("lower_kg_per_m3", "upper_kg_per_m3")


def known_materials(tables: ProblemFile, source: ProblemSource) -> Mapping[str, Material]:
    """All materials that a problem may name.

    Raises:
        InputError: a material of a name that is taken.
    """
    known = dict(CATALOGUE)
    for position, table in enumerate(tables.material):
        if table.name in known:
            where = "the catalogue" if table.name in CATALOGUE else "an earlier [[material]]"
            key = f"material[{position}].name"
            raise InputError(source.path, key, "a new name", f"'{table.name}', which is in {where}")
        known[table.name] = Material(table.name, table.density_kg_per_m3, table.source)
    return known


def density_parameters(tables: ProblemFile, source: ProblemSource) -> list[DesignParameter]:
    """The parameters of the `[[design.density]]` tables.

    Raises:
        InputError: neither bounds nor materials, both of them, or materials between which there is no choice.
    """
    known = known_materials(tables, source)
    return [
        _parameter(table, f"design.density[{position}]", source, known)
        for position, table in enumerate(tables.design.density)
    ]


def _parameter(
    table: DensityTable, key: str, source: ProblemSource, known: Mapping[str, Material]
) -> DesignParameter:
    lower, upper = (getattr(table, bound) for bound in BOUNDS)
    if table.materials is not None:
        if lower is not None or upper is not None:
            raise InputError(source.path, f"{key}.materials", "either materials or bounds", "both")
        chosen = _chosen(table.materials, f"{key}.materials", source, known)
        ends = (chosen[0].density, chosen[-1].density)
        return DesignParameter(ParameterKind.DENSITY, table.name, table.links, *ends, chosen)
    if lower is None or upper is None:
        missing = BOUNDS[0] if lower is None else BOUNDS[1]
        raise InputError(source.path, f"{key}.{missing}", "this key, or materials", "nothing")
    return DesignParameter(ParameterKind.DENSITY, table.name, table.links, lower, upper)


def _chosen(
    names: Sequence[str], key: str, source: ProblemSource, known: Mapping[str, Material]
) -> tuple[Material, ...]:
    """Materials by name, the lightest first."""
    refuse_unfit_choices(source, key, "material", names, known)
    chosen = sorted((known[name] for name in names), key=lambda material: material.density)
    for one, other in pairwise(chosen):
        if one.density == other.density:
            found = f"'{one.name}' and '{other.name}', both of {one.density:g} kg/m^3"
            raise InputError(source.path, key, "materials of different densities", found)
    return tuple(chosen)


def refuse_choices(space: DesignSpace, source: ProblemSource) -> None:
    """Refuse materials for the paper's joint problem, in which densities are variables.

    Raises:
        InputError: naming a parameter.
    """
    for parameter in space.parameters:
        if parameter.kind is ParameterKind.MARGIN:
            wanted = f"rated_torque_n_m of {parameter.group} for the baseline, which sizes nothing"
            raise InputError(source.path, "design.actuator", wanted, "margin")
        if parameter.changes or parameter.sections:
            key = "design.joint" if parameter.changes else "design.section"
            wanted = "lengths and densities for the baseline, which changes neither joints nor sections"
            raise InputError(source.path, key, wanted, parameter.name)
        if parameter.choices:
            wanted = (
                f"bounds of {parameter.name} instead of materials for the baseline, which moves it smoothly"
            )
            raise InputError(source.path, "design.density", wanted, f"{len(parameter.choices)} materials")


def refuse_no_choice(parameter: DesignParameter, value: float, source: str, key: str) -> None:
    """Refuse a value that is none of a parameter's choices.

    Args:
        parameter: one without choices takes any value.
        value: in the parameter's unit.
        source: the file, for messages.
        key: where in it.
    Raises:
        InputError: naming the nearest material or model.
    """
    if parameter.choices and value not in parameter.choices:
        name, nearest = parameter.nearest(value)
        what = ("density", "material") if parameter.materials else ("rated torque", "model")
        wanted = f"the {what[0]} of a {what[1]} of {parameter.name}"
        found = f"{value:g} {parameter.record.unit}; the nearest {what[1]} is '{name}' with {nearest:g}"
        raise InputError(source, key, wanted, found)


SAME = 1e-6
"""Difference of two shares that counts as none."""


def check_allocations(tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse allocation parameters that do not exist, exceed their range, or are fixed as well.

    Raises:
        InputError: naming the allocation parameter.
    """
    fixed = {ROBOT_SHARE: tables.task.robot_share, EFFORT_RATIO: tables.task.effort_weights}
    keys = {ROBOT_SHARE: "task.robot_share", EFFORT_RATIO: "task.effort_weights"}
    for position, table in enumerate(tables.design.allocation):
        key = f"design.allocation[{position}]"
        refuse_unlisted(source.path, f"{key}.name", table.name, ALLOCATIONS)
        allocation = ALLOCATIONS[table.name]
        for bound, value in (("lower", table.lower), ("upper", table.upper)):
            if not allocation.means(value):
                raise InputError(source.path, f"{key}.{bound}", allocation.wanted, f"{value:g}")
        if fixed[table.name] is not None:
            found = f"both this and [[design.allocation]] {table.name}"
            raise InputError(source.path, keys[table.name], "either a fixed value or an allocation", found)


def effort_weights(tables: ProblemFile) -> EffortWeights:
    """The fixed weights of the efforts."""
    given = tables.task.effort_weights
    return EffortWeights() if given is None else EffortWeights(given.robot, given.human)


def robot_share(tables: ProblemFile, source: ProblemSource, scene: Scene) -> float | None:
    """The share that the scene's programs must be given; None where statics, the solver or a design decides.

    Args:
        tables: the problem file; its allocation parameters are sound.
        source: the problem, for messages.
        scene: agents and load.
    Raises:
        InputError: a share that the load's balance does not allow.
    """
    asked = _asked(tables)
    if not asked:
        return None
    low, high = share_interval(scene)
    free = high - low > SAME
    for disturbance in scene.disturbances.cases if free else ():
        ends = share_interval(replace(scene, payload=scene.payload.disturbed(disturbance)))
        low, high = max(low, ends[0]), min(high, ends[1])
    for key, share in asked.items():
        if not low - SAME <= share <= high + SAME:
            raise InputError(source.path, key, _allowed(scene, low, high), f"{share:g}")
    return tables.task.robot_share if free else None


def _asked(tables: ProblemFile) -> Mapping[str, float]:
    """Every share that is asked for, by its key."""
    if tables.task.robot_share is not None:
        return {"task.robot_share": tables.task.robot_share}
    allocations = [
        (i, table) for i, table in enumerate(tables.design.allocation) if table.name == ROBOT_SHARE
    ]
    return {key: value for i, table in allocations for key, value in _ends(i, table)}


def _ends(position: int, table: AllocationTable) -> tuple[tuple[str, float], ...]:
    key = f"design.allocation[{position}]"
    return (f"{key}.lower", table.lower), (f"{key}.upper", table.upper)


def _allowed(scene: Scene, low: float, high: float) -> str:
    """The shares that balance the load, in words."""
    label = scene.payload.label
    grasps = f"{scene.payload.grasp} grasps of '{label}'" if label else f"{scene.payload.grasp} grasps"
    if high < low:
        return f"{grasps} that balance the load at all"
    if high - low <= SAME:
        return f"the robot's share that {grasps} leave here, {low:g}"
    return f"a share from {max(low, 0.0):g} to {min(high, 1.0):g}, which {grasps} can hold here"
