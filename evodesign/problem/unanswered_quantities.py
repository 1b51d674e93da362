"""Quantities that a problem file asks for and its robot or people cannot answer, refused in a sentence."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.errors import InputError
from evodesign.hardware.catalogue import catalogue
from evodesign.hardware.structure import STRENGTHS
from evodesign.human.back import FLEXION, LUMBAR
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.lumbar_load import has_lumbar_disc
from evodesign.problem.file import ProblemFile
from evodesign.quantities.hardware_quantities import (
    COST,
    FATIGUE,
    NEED_ACTUATORS,
    NEED_WALLS,
    OF_BEAMS,
    WINDING,
)
from evodesign.quantities.motion_quantities import NEED_LIFTS, OF_HOLDS, SPINE
from evodesign.quantities.objectives import NEED_PEOPLE, NEED_ROBOTS, NEED_STRENGTHS, split_name
from evodesign.quantities.person_quantities import BACK
from evodesign.records import ProblemSource


def refuse_unanswered_quantity(
    key: str, name: str, tables: ProblemFile, source: ProblemSource, people: Sequence[Agent]
) -> None:
    """Refuse a quantity that needs robots, people, strengths, actuators, walls or lifts that are not there.

    Args:
        key: where the problem file names it.
        name: of the quantity.
        tables: the problem file.
        source: the problem, for messages.
        people: all that the problem has.
    Raises:
        InputError: naming the quantity, and the person who lacks what it needs.
    """
    _refuse_without_hardware(key, name, tables, source)
    _refuse_still(key, name, tables, source)
    if split_name(name)[1] in NEED_ROBOTS and not tables.robots:
        raise InputError(source.path, key, f"a [robot] for '{name}'", "people alone")
    if name.endswith(NEED_PEOPLE) and not people:
        raise InputError(source.path, key, f"a [human] for '{name}'", "a robot alone")
    for person in people:
        _refuse_without_spine(key, name, source, person)
        if name.endswith(NEED_STRENGTHS) and not any(joint in person.strengths for joint in person.joints):
            wanted = "people of known strength (stature_m, mass_kg and sex, or strengths_n_m)"
            found = f"'{name}' with a person '{person.tree.name}' of unknown strength"
            raise InputError(source.path, key, wanted, found)


def _refuse_without_hardware(key: str, name: str, tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse a quantity of actuators or walls where there are none, or of another material."""
    if (name == COST or name.endswith(NEED_ACTUATORS)) and not tables.design.actuator:
        raise InputError(source.path, key, f"a [[design.actuator]] for '{name}'", "none")
    if name.endswith(WINDING) and tables.duty is None:
        raise InputError(source.path, key, f"a [duty] for '{name}'", "none")
    if name == FATIGUE and (tables.duty is None or tables.duty.life_shifts is None):
        raise InputError(source.path, key, f"a [duty] with life_shifts for '{name}'", "none")
    if name == COST:
        _refuse_without_prices(key, tables, source)
    if name.endswith(NEED_WALLS) and not tables.design.wall:
        raise InputError(source.path, key, f"a [[design.wall]] for '{name}'", "none")
    able = [each for each, has in STRENGTHS.items() if name != FATIGUE or has.fatigue]
    for position, wall in enumerate(tables.design.wall if name.endswith(OF_BEAMS) else ()):
        if wall.material is not None and wall.material not in able:
            wanted = f"one of {', '.join(able)}, as '{name}' is asked for"
            raise InputError(source.path, f"design.wall[{position}].material", wanted, f"'{wall.material}'")


def _refuse_without_prices(key: str, tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse a cost where an actuator is no model, or a model has no price."""
    known = {**catalogue(), **{row.model: row for row in tables.actuator}}
    for position, table in enumerate(tables.design.actuator):
        where = f"design.actuator[{position}]"
        if table.models is None:
            wanted = f"models with a price_eur in {where} for '{COST}'"
            raise InputError(source.path, key, wanted, "sizes of the law, which has no prices")
        for model in table.models:
            if known[model].price_eur is None:
                wanted = f"a price_eur of every model in {where} for '{COST}', in an [[actuator]] table"
                raise InputError(source.path, key, wanted, f"none of '{model}'")


def _refuse_still(key: str, name: str, tables: ProblemFile, source: ProblemSource) -> None:
    """Refuse a quantity of moving loads where none moves, and of still ones where one does."""
    if name.endswith(NEED_LIFTS) and not tables.task.lift:
        raise InputError(source.path, key, f"a [[task.lift]] for '{name}'", "none")
    if name in OF_HOLDS and tables.task.lift:
        raise InputError(source.path, key, f"loads held still for '{name}'", "a [[task.lift]]")


def _refuse_without_spine(key: str, name: str, source: ProblemSource, person: Agent) -> None:
    """Refuse a quantity of the back for a person without joints at L5/S1, or whose flexion there is fixed."""
    wanted = ""
    if name.endswith(SPINE) and not any(joint.startswith(LUMBAR) for joint in person.joints):
        wanted = f"people with joints named {LUMBAR}... for '{name}'"
    if name.endswith(BACK) and not has_lumbar_disc(person):
        wanted = f"people whose joint {FLEXION} moves for '{name}'"
    if wanted:
        raise InputError(source.path, key, wanted, f"'{person.tree.name}' without")
