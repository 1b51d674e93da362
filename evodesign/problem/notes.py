"""Things in a problem that are allowed but look like mistakes, or that were not taken as they are."""

from __future__ import annotations

import math
from collections.abc import Iterator

from evodesign.body.placement import dot
from evodesign.errors import listed
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex
from evodesign.human.body import human_tree
from evodesign.human.measured_posture import unmeasured_heights
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.balance import GRAVITY
from evodesign.problem.build import DesignProblem
from evodesign.problem.left_out import left_out
from evodesign.records import Lift
from evodesign.tasks.lift import LoadProfile
from evodesign.tree.model import Joint

ALIKE = math.radians(15.0)
"""Joint limits closer than this count as the same; they fit better if they are closer by this much."""

PEAK_ACCELERATION = {LoadProfile.MINIMUM_JERK: 10.0 / math.sqrt(3.0), LoadProfile.FREE: 4.0}
"""Largest acceleration of a lift as a multiple of its way over its squared time; of a free one at least."""

PARALLEL = math.cos(math.radians(10.0))
"""Joint axes whose directions have at least this cosine count as the same."""


def notes(problem: DesignProblem) -> tuple[str, ...]:
    """A sentence for each thing that a careful reader of the problem would ask about.

    What was not taken as the URDF files say it, joints that stand where they cannot, what was averaged to
    make postures symmetric or why they are whole, what the model leaves out, and limits of a person's joints
    that look as if their sign were wrong: only joints with the names of the generated person, in the same
    T-pose (x forward, y to the left, z up; docs/person.md), and whether or not the problem moves them. Limits
    do not depend on stature, mass or sex, so any person serves. Then heights at which nobody was measured,
    and lifts that are faster than a fall.
    """
    people = [person.tree for scene in problem.scenes for person in scene.people]
    anatomy = human_tree(Person(1.75, 75.0, Sex.MALE)).joint_by_name
    found = (
        _turned(human.name, joint, anatomy[joint.name])
        for human in people
        for joint in human.joints
        if joint.name in anatomy
    )
    trees = (*(robot.tree for robot in problem.scene.robots), *people)
    read = (f"{tree.name}: {sentence}" for tree in trees for sentence in tree.notes)
    wrong = (sentence for sentence in found if sentence)
    agents = (*problem.scene.robots, *(person for scene in problem.scenes for person in scene.people))
    still = (f"{agent.tree.name}: {sentence}" for agent in agents for sentence in _still(agent))
    left, assumed = left_out(problem.source), (*assumed_heights(problem), *_hasty_lifts(problem))
    return tuple(dict.fromkeys((*read, *still, *problem.symmetry_notes, *wrong, *assumed, *left)))


def _hasty_lifts(problem: DesignProblem) -> Iterator[str]:
    """A sentence for each lift whose load is accelerated downwards faster than it falls."""
    for place, lift in enumerate(task for task in problem.tasks if isinstance(task, Lift)):
        peak = PEAK_ACCELERATION[lift.profile] * abs(lift.to_m - lift.from_m)
        if peak > GRAVITY * lift.seconds**2:
            yield (
                f"task.lift[{place}].seconds: {lift} accelerates the load by "
                f"{peak / lift.seconds**2 / GRAVITY:.2g} g, so that hands must push it down; wanted at least "
                f"{math.sqrt(peak / GRAVITY):.2f} s"
            )


def assumed_heights(problem: DesignProblem) -> Iterator[str]:
    """A sentence for each person and hold whose measured posture rests on an assumption."""
    low, high = unmeasured_heights()
    everyone = [(scene, person) for scene in problem.scenes for person in scene.people]
    for scene, person in everyone:
        if person.measured is None:
            continue
        palm, stature = scene.payload.grasp_point(person, person.hands[0])[2], person.measured.stature
        holds = [hold.height_m for hold in problem.holds if low < (hold.height_m + palm) / stature < high]
        if holds:
            yield (
                f"{person.label or person.tree.name}: how measured people stand with the load at "
                f"{listed([f'{height:g}' for height in holds])} m is an assumption: nobody was measured who "
                f"held one between {low:.2f} and {high:.2f} of stature"
            )


def _still(agent: Agent) -> Iterator[str]:
    """A sentence on joints that are held where they cannot be."""
    moving = [agent.tree.joint_by_name[name] for name in agent.tree.actuated]
    held = [joint for joint in moving if joint.name not in agent.joints]
    outside = [joint for joint in held if not joint.lower <= 0.0 <= joint.upper]
    if outside:
        given = [f"{joint.name} ({joint.lower:g} to {joint.upper:g})" for joint in outside]
        yield f"held at zero, as `joints` does not name them, but outside of their ranges: {listed(given)}"


def _turned(person: str, joint: Joint, anatomical: Joint) -> str:
    """A sentence if limits fit the anatomical ones much better with their sign turned; otherwise nothing."""
    along = dot(joint.axis, anatomical.axis)
    if abs(along) < PARALLEL:
        return ""
    given, right = (joint.lower, joint.upper), (anatomical.lower, anatomical.upper)
    if along < 0.0:
        right = _negated(right)
    turned = _difference(_negated(given), right)
    if turned >= ALIKE or _difference(given, right) < turned + ALIKE:
        return ""
    return (
        f"{person}: joint {joint.name} turns from {_degrees(given)}, where a person's turns from "
        f"{_degrees(right)}: its limits seem to have the wrong sign"
    )


def _negated(limits: tuple[float, float]) -> tuple[float, float]:
    """The same range about the opposite axis."""
    return (-limits[1], -limits[0])


def _difference(limits: tuple[float, float], others: tuple[float, float]) -> float:
    """The larger difference of the two ends [rad]."""
    return max(abs(one - other) for one, other in zip(limits, others, strict=True))


def _degrees(limits: tuple[float, float]) -> str:
    return f"{math.degrees(limits[0]):.0f} to {math.degrees(limits[1]):.0f} degrees"
