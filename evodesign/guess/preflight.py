"""What could be wrong with a robot though its files can be read, looked at before anything long begins.

Each item either passes, with what was found, or fails with a sentence that names key, fault and remedy.
Places are those with all joints at zero. The last items solve (`heights_held`).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from evodesign.body.inertia import total
from evodesign.body.placement import Vector, rotate
from evodesign.collision.shapes import solids_of
from evodesign.design.parameter import DesignParameter
from evodesign.errors import InputError, listed
from evodesign.guess.body_plan import body_plan, opposite_knees
from evodesign.guess.heights_held import holds, people_hold
from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.scene import Scene
from evodesign.problem.agent_tables import Facing
from evodesign.problem.build import DesignProblem
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml
from evodesign.searches.registry import make_asynchronous_search, make_search
from evodesign.tree.model import Tree
from evodesign.tree.welded import WeldedTree, without_frames

LIGHTEST, HEAVIEST = 1.0, 500.0
"""Masses [kg] between which a robot is one that people build."""

UPRIGHT = 0.8
"""Least cosine between up and the way from the soles to the centre of mass, and a sole's z axis."""

UNEVEN = 0.05
"""Largest difference of the soles' heights with all joints at zero [m]."""

FEWEST_JOINTS = 3
"""Joints between hand and trunk."""

LONGER, LEAST_CHANGE = 1.1, 1e-6
"""Multiplier with which a parameter is tried, and a change of the mass [kg] that is one."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One item: what was found, and the sentence that says what is wrong, empty if nothing is."""

    item: str
    found: str
    fault: str = ""


def preflight(problem: DesignProblem) -> tuple[Finding, ...]:
    """Every item in turn; what solves comes only after all others have passed."""
    if not problem.scene.robots:
        return _solved(problem)
    problem = _without_frames(problem)
    robot, space = problem.scene.robot, problem.space
    welded = WeldedTree(robot.tree)
    equipped = WeldedTree(space.resized(robot.tree, space.given(space.unscaled(robot.tree), {})))
    items: dict[str, Callable[[], str]] = {
        "stands on its soles" if robot.on_feet else "stands on its wheels": lambda: _stands(robot, welded),
        "faces the load": lambda: _faces(problem),
        "has hands": lambda: _hands(robot, welded),
        "masses and limits": lambda: _masses(robot),
        "has shapes": lambda: _shapes(robot.tree),
    }
    for index, parameter in enumerate(space.parameters):
        if (parameter.links or parameter.joints) and not parameter.is_fixed:
            words, value = _other(parameter, space.unscaled(robot.tree)[index])
            items[f"{parameter.name} {words}"] = functools.partial(_changes, problem, equipped, index, value)
    if space.free:
        items["can be searched"] = lambda: _search(problem)
    found = [_tried(name, item) for name, item in items.items()]
    return tuple(found) if any(finding.fault for finding in found) else (*found, *_solved(problem))


def _without_frames(problem: DesignProblem) -> DesignProblem:
    """The problem whose designed robot has no links without a mass, but for those that something names."""
    tree, named = problem.scene.designed_tree, set[str]()
    for parameter in problem.space.parameters:
        joints = (*parameter.joints, *(change.joint for change in parameter.changes))
        named |= {*parameter.links, *(tree.joint_by_name[name].child for name in joints)}
    for robot in problem.scene.designed[:1]:
        named |= {*(contact.frame for contact in robot.contacts), *robot.trunk}
    bare = without_frames(tree, named)

    def of(scene: Scene) -> Scene:
        agents = (replace(each, tree=bare) if each.designed else each for each in scene.agents)
        return scene.with_agents(*agents)

    return replace(problem, scenes=tuple(map(of, problem.scenes)))


def _solved(problem: DesignProblem) -> tuple[Finding, ...]:
    """The items that solve."""
    both = problem.scene.robots and problem.scene.people
    items = {"holds the load": holds} | ({"people reach it": people_hold} if both else {})
    return tuple(_tried(name, functools.partial(item, problem)) for name, item in items.items())


def _tried(name: str, item: Callable[[], str]) -> Finding:
    try:
        return Finding(name, item())
    except InputError as error:
        return Finding(name, "", str(error))


def _stands(robot: Agent, welded: WeldedTree) -> str:
    key = "robot.soles" if robot.on_feet else "robot.base"
    bodies = [welded.body_of(foot.frame) for foot in robot.feet]
    if robot.on_feet and bodies[0] is bodies[1]:
        wanted = "frames under two feet that move against each other"
        raise InputError("robot.soles", "", wanted, f"two of '{bodies[0].name}'")
    places = [welded.places[foot.frame] for foot in robot.feet]
    middle = [sum(along) / len(places) for along in zip(*(p.translation for p in places), strict=True)]
    center = total([body.inertia for body in welded.bodies.values() if body.inertia.mass]).center
    up = float(center[2] - middle[2]) / max(math.dist(center, middle), 1e-9)
    if up < UPRIGHT:
        wanted = "a robot upright on its soles while all joints are at zero, z up in its root link"
        if not robot.on_feet:
            wanted = "a frame on the ground below the robot, z up in it and in the root link"
        found = f"its centre of mass {math.degrees(math.acos(max(-1.0, up))):.0f} degrees off the vertical"
        raise InputError(key, "", wanted, found)
    for foot, place in zip(robot.feet, places, strict=True):
        if place.rotation[2][2] < UPRIGHT:
            wanted = "a frame with z up and x ahead under the foot, such as one of [[robot.frames]]"
            where = f"{key}.{foot.side or 'frame'}"
            raise InputError(where, "", wanted, f"'{foot.frame}', whose z axis is not up")
    if not robot.on_feet:
        return f"centre of mass {center[2] - middle[2]:.2f} m above the ground"
    above = abs(places[0].translation[2] - places[1].translation[2])
    if above > UNEVEN:
        wanted = "soles at one height while all joints are at zero"
        raise InputError("robot.soles", "", wanted, f"one {above:.2f} m above the other")
    _refuse_exchanged("robot.soles", *(place.translation for place in places))
    return f"centre of mass {center[2] - middle[2]:.2f} m above them"


def _refuse_exchanged(key: str, left: Vector, right: Vector) -> None:
    if left[1] <= right[1]:
        wanted = "the left one to the left of the right one, as the robot looks along x"
        raise InputError(key, "", wanted, "them exchanged")


def _faces(problem: DesignProblem) -> str:
    try:
        plan = body_plan(problem.scene.designed_tree)
    except InputError:
        return "not known: no two legs of three joints"
    if knees := opposite_knees(plan):
        found = f"'{knees[0]}' and '{knees[1]}', whose axes or limits bend one ahead and one back"
        raise InputError("robot.urdf", "", "knees that bend to one side", found)
    if plan.facing in (Facing.FORWARD, None):
        return plan.why
    tables = decode_toml(problem.source.text, problem.source.path, ProblemFile)
    facing = Facing.FORWARD if tables.designed is None else tables.designed.facing
    ahead = rotate(facing.axes, plan.facing.ahead)
    remedy = next(each for each in Facing if math.dist(each.ahead, ahead) < 0.5)
    found = f"a robot that looks along {plan.facing}: {plan.why}"
    raise InputError("robot.facing", "", f'"{remedy}"', found)


def _hands(robot: Agent, welded: WeldedTree) -> str:
    frames = {hand.side: hand.frame for hand in robot.hands}
    bodies = {side: welded.body_of(frame) for side, frame in frames.items()}
    if len(bodies) > 1 and bodies["left"] is bodies["right"]:
        wanted = "frames in two hands that move against each other"
        raise InputError("robot.hands", "", wanted, f"two of '{bodies['left'].name}'")
    trunk = {body.name for name in robot.trunk for body in welded.chain(welded.body_of(name).name)}
    for side, body in bodies.items():
        chain = (each for each in welded.chain(body.name) if each.name not in trunk)
        moving = sum(each.joint is not None and each.joint.name in robot.joints for each in chain)
        if moving < FEWEST_JOINTS:
            wanted = f"a hand with at least {FEWEST_JOINTS} of robot.joints between it and the trunk"
            found = f"{moving} before '{frames[side]}'"
            raise InputError(f"robot.hands.{side}", "", wanted, found)
    if len(frames) == 1:
        return f"the {robot.hands[0].side} one alone"
    left, right = (welded.places[frames[side]].translation for side in SIDES)
    _refuse_exchanged("robot.hands", left, right)
    return f"{math.dist(left, right):.2f} m apart"


def _masses(robot: Agent) -> str:
    mass = float(robot.tree.mass)
    if not LIGHTEST <= mass <= HEAVIEST:
        raise InputError("robot.urdf", "", f"a robot of {LIGHTEST:g} to {HEAVIEST:g} kg", f"{mass:.4g} kg")
    moving = [robot.tree.joint_by_name[name] for name in robot.joints]
    for joint in moving:
        if joint.lower == joint.upper:
            found = f"'{joint.name}', whose limits are both {joint.lower:g}"
            raise InputError("robot.joints", "", "joints that can move; leave others out", found)
    endless = [joint.name for joint in moving if not math.isfinite(joint.upper - joint.lower)]
    without = f", {len(endless)} of them without limits: {listed(endless)}" if endless else ""
    return f"{mass:.4g} kg, {len(robot.joints)} joints that move{without}"


def _shapes(tree: Tree) -> str:
    """How many links with a mass have a shape or a mesh; what has none meets nothing and is not seen."""
    heavy = [link for link in tree.links if link.inertia.mass]
    shaped = sum(bool(solids_of(link)) for link in heavy)
    without = "" if shaped else ": collisions and pictures leave the robot out"
    return f"{shaped} of {len(heavy)} links with a mass{without}"


def _search(problem: DesignProblem) -> str:
    """What searches, made as a search begins with it."""
    settings = problem.settings()
    make = make_asynchronous_search if settings.asynchronous else make_search
    make(settings)
    return f"by {settings.algorithm}; free parameters: {settings.dimension}"


def _other(parameter: DesignParameter, value: float) -> tuple[str, float]:
    """A value beside the unscaled robot's, in words as well: the next model, or a tenth more."""
    if not parameter.models:
        return f"+ {LONGER - 1.0:.0%}", value * LONGER
    names, place = parameter.choice_names, parameter.choice_names.index(parameter.nearest(value)[0])
    other = place + 1 if place + 1 < len(names) else place - 1
    return f"{names[place]} to {names[other]}", parameter.choices[other]


def _changes(problem: DesignProblem, before: WeldedTree, index: int, value: float) -> str:
    """What another value of a parameter changes, in the root's frame."""
    robot, space = problem.scene.robot, problem.space
    values = [*space.unscaled(robot.tree)]
    values[index] = value
    after = WeldedTree(space.resized(robot.tree, space.given(values, {})))
    mass = float(after.tree.mass) - float(before.tree.mass)
    moved = {
        name: 1000.0 * math.dist(before.places[link].translation, after.places[link].translation)
        for name, link in (("hands", robot.hands[0].frame), ("soles", robot.feet[0].frame))
    }
    parts = [f"{name} by {distance:.0f} mm" for name, distance in moved.items() if distance >= 0.5]
    if not parts and abs(mass) < LEAST_CHANGE:
        wanted = "a parameter that changes a length or a mass"
        raise InputError(f"design ({space.parameters[index].name})", "", wanted, "neither")
    return ", ".join((*parts, f"{mass:+.2g} kg"))
