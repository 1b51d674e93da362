"""Hardware of a problem file: actuators of joints, walls of links.

An actuator's rated torque lies within bounds and it follows the law of its gear, or it is one of some models,
from the catalogue and the problem's own `[[actuator]]` tables together. A wall has a fixed thickness or
bounds of it; its material is named, or chosen by a density parameter of the same links. Every contradiction
is refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from evodesign.body.material import Material
from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.design.walls import Wall
from evodesign.errors import InputError
from evodesign.hardware.actuators import (
    Actuator,
    PowerLaw,
    actuator_of_row,
    friction_law,
    friction_of_row,
    gears_with_a_law,
)
from evodesign.hardware.catalogue import CatalogueRow, Gear, catalogue
from evodesign.hardware.friction import GearFriction
from evodesign.hardware.heat import Duty
from evodesign.hardware.structure import STRENGTHS
from evodesign.problem.design_space import known_materials
from evodesign.problem.design_table import ActuatorTable, WallTable
from evodesign.problem.file import ProblemFile
from evodesign.problem.mountings import mountings_of
from evodesign.problem.unknown_names import (
    of_catalogue,
    refuse_unfit_choices,
    refuse_unknown,
    refuse_unlisted,
)
from evodesign.records import ProblemSource
from evodesign.tree.model import Tree

GEAR_FRICTION = "hardware.gear_friction"


def actuator_parameters(tables: ProblemFile, source: ProblemSource, tree: Tree) -> list[DesignParameter]:
    """The parameters of the `[[design.actuator]]` tables.

    Raises:
        InputError: an unknown joint or model, a joint twice, or not one way to choose a size.
    """
    known, seen, duty = _known_actuators(tables, source), dict[str, str](), duty_of(tables, source)
    found = []
    for position, table in enumerate(tables.design.actuator):
        key = f"design.actuator[{position}]"
        for place, joint in enumerate(table.joints):
            where = f"{key}.joints[{place}]"
            refuse_unknown(source, where, "moving joint", joint, tree.actuated, tree.name)
            if joint in seen:
                raise InputError(
                    source.path, where, "a joint in one actuator", f"'{joint}' also in {seen[joint]}"
                )
            seen[joint] = key
        parameter = _actuator(table, key, source, known, tables.hardware.gear_friction)
        found.append(replace(parameter, mountings=mountings_of(table, key, source, tree), duty=duty))
    return found


def duty_of(tables: ProblemFile, source: ProblemSource) -> Duty | None:
    """The rhythm of the `[duty]` table; None where there is none.

    Raises:
        InputError: nothing that works in it, or more seconds of holding than an hour has.
    """
    table = tables.duty
    if table is None:
        return None
    if not tables.design.actuator:
        raise InputError(source.path, "duty", "a [[design.actuator]] that gets warm", "none")
    if tables.task.lift:
        raise InputError(source.path, "duty", "loads that are held still", "a [[task.lift]]")
    if table.hold_s * table.lifts_per_hour > 3600.0:
        wanted = f"at most {3600.0 / table.lifts_per_hour:g} s, with {table.lifts_per_hour:g} lifts per hour"
        raise InputError(source.path, "duty.hold_s", wanted, f"{table.hold_s:g} s")
    return Duty(
        holds_per_hour=table.lifts_per_hour,
        hold=table.hold_s,
        shift=table.shift_h,
        air=table.air_c,
        limit=table.winding_limit_c,
        time_constant=table.thermal_time_constant_s,
    )


def _known_actuators(tables: ProblemFile, source: ProblemSource) -> Mapping[str, CatalogueRow]:
    known = dict(catalogue())
    for position, row in enumerate(tables.actuator):
        key = f"actuator[{position}]"
        if row.model in known:
            where = "the catalogue" if row.model in catalogue() else "an earlier [[actuator]]"
            raise InputError(source.path, f"{key}.model", "a new name", f"'{row.model}', which is in {where}")
        if row.rated_torque_n_m is not None and row.rated_torque_n_m > row.peak_torque_n_m:
            wanted = f"at most the peak torque, {row.peak_torque_n_m:g}"
            raise InputError(source.path, f"{key}.rated_torque_n_m", wanted, f"{row.rated_torque_n_m:g}")
        if list(row.torques) != sorted(row.torques):
            wanted = "rated, repeated peak, peak, momentary peak and ratcheting torque that rise"
            raise InputError(source.path, key, wanted, ", ".join(f"{torque:g}" for torque in row.torques))
        known[row.model] = row
    return known


def _actuator(
    table: ActuatorTable, key: str, source: ProblemSource, known: Mapping[str, CatalogueRow], friction: bool
) -> DesignParameter:
    ways = ("rated_torque_n_m", "models", "margin")
    given = [way for way in ways if getattr(table, way) is not None]
    if len(given) != 1:
        raise InputError(source.path, key, f"one of {', '.join(ways)}", " and ".join(given) or "none")
    for kind, way in ((ParameterKind.ACTUATOR, "rated_torque_n_m"), (ParameterKind.MARGIN, "margin")):
        if way in given:
            ends = _ends(getattr(table, way), f"{key}.{way}", source)
            if kind is ParameterKind.MARGIN and not 1.0 <= ends[0] <= ends[1] < math.inf:
                found = " to ".join(dict.fromkeys(f"{end:g}" for end in ends))
                raise InputError(source.path, f"{key}.{way}", "numbers of at least 1", found)
            gear = _gear(table.gear, f"{key}.gear", source)
            law = _friction_law(gear, source) if friction else None
            return DesignParameter(kind, table.name, (), *ends, joints=table.joints, gear=gear, friction=law)
    if table.gear is not None:
        wanted = "no gear beside models, which have their own"
        raise InputError(source.path, f"{key}.gear", wanted, f"'{table.gear}'")
    models = _models(table.models or (), f"{key}.models", source, known, friction)
    ends = (models[0].rated, models[-1].rated)
    return DesignParameter(ParameterKind.ACTUATOR, table.name, (), *ends, joints=table.joints, models=models)


def _gear(name: str | None, key: str, source: ProblemSource) -> Gear:
    """The kind of gear whose law an actuator follows."""
    if name is None:
        return Gear.PLANETARY
    kinds = gears_with_a_law()
    if name not in kinds:
        raise InputError(source.path, key, f"a gear with a law: {', '.join(kinds)}", f"'{name}'")
    return Gear(name)


def _friction_law(gear: Gear, source: ProblemSource) -> PowerLaw:
    """Of gears of a kind."""
    law = friction_law(gear)
    if law is None:
        kinds = ", ".join(kind for kind in gears_with_a_law() if friction_law(kind))
        wanted = f"gears whose friction the catalogue knows: {kinds}, or models with a friction_torque_n_m"
        raise InputError(source.path, GEAR_FRICTION, wanted, f"'{gear}'")
    return law


def _friction(row: CatalogueRow, key: str, source: ProblemSource) -> GearFriction:
    found = friction_of_row(row)
    if found is None:
        wanted = f"models whose friction is known, as {GEAR_FRICTION} is true"
        raise InputError(source.path, key, wanted, f"'{row.model}', without a friction_torque_n_m")
    return found


def _ends(given: float | tuple[float, float], key: str, source: ProblemSource) -> tuple[float, float]:
    """Bounds that are given, or a value twice."""
    return _rising(given, key, source) if isinstance(given, tuple) else (given, given)


def _rising(pair: tuple[float, float], key: str, source: ProblemSource) -> tuple[float, float]:
    if pair[0] >= pair[1]:
        raise InputError(source.path, key, "a rising pair", f"[{pair[0]:g}, {pair[1]:g}]")
    return pair


def _models(
    names: Sequence[str],
    key: str,
    source: ProblemSource,
    known: Mapping[str, CatalogueRow],
    friction: bool,
) -> tuple[Actuator, ...]:
    """Models by name, the weakest first."""
    refuse_unfit_choices(source, key, "model", names, known)
    rows = [known[name] for name in names]
    chosen = [
        replace(actuator_of_row(row), friction=_friction(row, key, source) if friction else None)
        for row in rows
    ]
    models = sorted(chosen, key=lambda model: model.rated)
    for one, other in pairwise(models):
        if one.rated == other.rated:
            found = f"'{one.model}' and '{other.model}', both of {one.rated:g} N m"
            raise InputError(source.path, key, "models of different rated torques", found)
    return tuple(models)


def wall_parameters(tables: ProblemFile, source: ProblemSource) -> list[DesignParameter]:
    """The parameters of the `[[design.wall]]` tables whose thickness a design chooses.

    Raises:
        InputError: bounds that do not rise.
    """
    found = []
    for position, table in enumerate(tables.design.wall):
        given = table.thickness_m if isinstance(table.thickness_m, tuple) else (table.thickness_m,)
        for thickness in given:
            if thickness <= 0.0:
                key = f"design.wall[{position}].thickness_m"
                raise InputError(source.path, key, "a positive number", f"{thickness:g}")
        if isinstance(table.thickness_m, tuple):
            ends = _rising(table.thickness_m, f"design.wall[{position}].thickness_m", source)
            found.append(DesignParameter(ParameterKind.WALL, table.name, table.links, *ends))
    return found


def walls_of(tables: ProblemFile, source: ProblemSource, tree: Tree) -> tuple[Wall, ...]:
    """The walls of a problem.

    Raises:
        InputError: an unknown link or material, a link or name twice, not one material of every link, or a
            wall that cannot be made.
    """
    known, names, seen = known_materials(tables, source), set[str](), dict[str, str]()
    walls, duty = [], tables.duty
    life = None if duty is None else duty.life_shifts
    cycles = duty.lifts_per_hour * duty.shift_h * life if duty and life else None
    for position, table in enumerate(tables.design.wall):
        key = f"design.wall[{position}]"
        if table.name in names:
            raise InputError(source.path, f"{key}.name", "a unique name", f"'{table.name}' twice")
        names.add(table.name)
        for place, link in enumerate(table.links):
            where = f"{key}.links[{place}]"
            refuse_unknown(source, where, "link", link, tree.link_by_name, tree.name)
            if link in seen:
                raise InputError(source.path, where, "a link in one wall", f"'{link}' also in {seen[link]}")
            seen[link] = key
        material = _material(table, key, source, known, tables)
        least = _least_wall(table, key, source, tables)
        walls.append(
            Wall(
                group=table.name,
                links=table.links,
                thickness=None if isinstance(table.thickness_m, tuple) else table.thickness_m,
                material=table.material,
                density=None if material is None else material.density,
                share=tables.hardware.non_structural_share,
                least=least,
                cycles=cycles,
            )
        )
    return tuple(walls)


def _material(
    table: WallTable, key: str, source: ProblemSource, known: Mapping[str, Material], tables: ProblemFile
) -> Material | None:
    """What a wall is made of; None where density parameters choose."""
    chosen = set(_links_of_density(tables))
    if table.material is None:
        for link in table.links:
            if link not in chosen:
                wanted = f"a material, or a [[design.density]] of '{link}'"
                raise InputError(source.path, f"{key}.material", wanted, "neither")
        return None
    wanted = of_catalogue("material", table.material, known)
    refuse_unlisted(source.path, f"{key}.material", table.material, known, wanted)
    for link in table.links:
        if link in chosen:
            wanted = f"either a material or a [[design.density]] of '{link}'"
            raise InputError(source.path, f"{key}.material", wanted, "both")
    return known[table.material]


def _least_wall(table: WallTable, key: str, source: ProblemSource, tables: ProblemFile) -> float:
    """The least thickness that can be made [m], of the material that needs most; zero where none is known."""
    chosen = [each.materials or () for each in tables.design.density if {*each.links} & {*table.links}]
    materials = [table.material] if table.material else [name for names in chosen for name in names]
    known = [(STRENGTHS[name].least_wall, name) for name in materials if name in STRENGTHS]
    least, name = max(known, default=(0.0, ""))
    why = f"the least wall of {name} that can be made ({STRENGTHS[name].wall_source})" if name else ""
    if tables.hardware.least_wall_m is not None:
        least, why = tables.hardware.least_wall_m, "hardware.least_wall_m"
    thinnest = table.thickness_m[0] if isinstance(table.thickness_m, tuple) else table.thickness_m
    if 0.0 < thinnest < least:
        raise InputError(source.path, f"{key}.thickness_m", f"at least {least:g} m, {why}", f"{thinnest:g} m")
    return least


def _links_of_density(tables: ProblemFile) -> Iterator[str]:
    for table in tables.design.density:
        yield from table.links
