"""Teams: which robots and people hold a load together, and what a team may be asked for."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from evodesign.errors import InputError
from evodesign.mechanics.agent import SIDES, Agent, Role
from evodesign.mechanics.scene import Scene
from evodesign.problem.file import ProblemFile
from evodesign.records import ProblemSource
from evodesign.searches.base import JOINT_STARTS


def teams_of(
    tables: ProblemFile, source: ProblemSource, robots: Sequence[Agent], people: Sequence[Agent]
) -> tuple[tuple[Agent, ...], ...]:
    """Everyone who holds a load together, for every person of each side in turn.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        robots: who all hold it.
        people: those at one side are each other's alternatives, and have one name.
    Raises:
        InputError: two robots, or a robot and a person, at one side of the load.
    """
    taken: dict[int, str] = {}
    for key, table in tables.robots.items():
        for place, side in enumerate(table.sides):
            if side.quarters in taken:
                found = f"'{side}', where {taken[side.quarters]} stands"
                raise InputError(source.path, f"{key}.sides[{place}]", "a side of its own", found)
            taken[side.quarters] = f"a robot ({key})"
    for key, person in tables.people.items():
        if person.side.quarters in taken:
            found = f"'{person.side}', where {taken[person.side.quarters]} stands"
            raise InputError(source.path, f"{key}.side", "a side without a robot", found)
    if not robots and not people:
        raise InputError(source.path, "robot", "a [robot] or a [human] who holds the load", "neither")
    names = dict.fromkeys(person.name for person in people)
    sides = [[person for person in people if person.name == name] for name in names]
    return tuple((*robots, *chosen) for chosen in product(*sides))


def refuse_what_teams_lack(tables: ProblemFile, source: ProblemSource, team: Sequence[Agent]) -> None:
    """Refuse what only people answer of robots alone, and what only a pair does of other teams.

    Args:
        tables: the problem file.
        source: the problem, for messages.
        team: one of the problem's, which all have the same robots and as many people.
    Raises:
        InputError: naming the key.
    """
    robots = sum(len(table.sides) for table in tables.robots.values())
    people = len(team) - robots
    found = _who(robots, people)
    needing = _needing(tables)
    for key in () if robots else (key for key in OF_ROBOTS if needing[key]):
        raise InputError(source.path, key, "a [robot] with it", found)
    for key in () if people else (key for key in needing if needing[key]):
        alone = "a robot that holds the load alone" if robots == 1 else found
        raise InputError(source.path, key, "a [human] with it", alone)
    for key, load in tables.loads.items():
        for name, given, role in (
            ("robot_grasps_m", load.robot_grasps_m, Role.ROBOT),
            ("human_grasps_m", load.human_grasps_m, Role.PERSON),
        ):
            own = [agent for agent in team if agent.role is role]
            if given is None:
                continue
            if len(own) > 1:
                raise InputError(source.path, f"{key}.{name}", "one agent whose hands these are", found)
            sides = [side for side in SIDES if getattr(given, side) is not None]
            hands = [
                side for side in SIDES if any(hand.side == side for agent in own for hand in agent.hands)
            ]
            if sides != hands:
                wanted = f"a point for each hand: {', '.join(hands) or 'none'}"
                raise InputError(source.path, f"{key}.{name}", wanted, ", ".join(sides) or "none")
    if robots > 1 or people > 1:
        margins = {
            f"design.actuator[{position}].margin": actuator.margin is not None
            for position, actuator in enumerate(tables.design.actuator)
        }
        for key, asked in {**{key: needing[key] for key in OF_A_PAIR}, **margins}.items():
            if asked:
                raise InputError(source.path, key, "one robot and one person with it", found)


def refuse_lift(scene: Scene, source: ProblemSource) -> None:
    """Refuse a lift that is no robot's and person's.

    Raises:
        InputError: naming who holds the load.
    """
    robots, people = len(scene.robots), len(scene.people)
    if (robots, people) != (1, 1):
        raise InputError(source.path, "", "one robot and one person, who lift the load", _who(robots, people))


def _who(robots: int, people: int) -> str:
    return f"{_counted(robots, 'robot', 'robots')} and {_counted(people, 'person', 'people')}"


def _counted(number: int, one: str, several: str) -> str:
    return f"{number or 'no'} {one if number == 1 else several}"


OF_ROBOTS = ("task.robot_share", "task.lift")
"""Keys that need a robot."""

OF_A_PAIR = ("task.lift", "search.algorithm")
"""Keys that need one robot and one person."""


def _needing(tables: ProblemFile) -> dict[str, bool]:
    """Whether a file asks for what needs people, by key."""
    return {
        "task.lift": bool(tables.task.lift),
        "search.algorithm": tables.search.algorithm == JOINT_STARTS,
        "task.robot_share": tables.task.robot_share is not None,
        "task.effort_weights": tables.task.effort_weights is not None,
        "design.allocation": bool(tables.design.allocation),
    }
