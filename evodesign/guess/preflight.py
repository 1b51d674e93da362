"""What could be wrong with a robot though its files can be read, looked at before anything long begins.

Each item either passes, with what was found, or fails with a sentence that names key, fault and remedy.
Places are those with all joints at zero. The last item solves: the reach of the robot as it is in its file,
and the posture at one height within. It does so without `[collisions]`, of which the robot's colliding pairs
would have to be found first, in a minute.
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
from evodesign.errors import InputError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.guess.body_plan import body_plan
from evodesign.mechanics.agent import SIDES, Agent
from evodesign.mechanics.scene import Scene
from evodesign.problem.agent_tables import Facing
from evodesign.problem.build import DesignProblem
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml
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
        return (_tried("holds the load", lambda: _holds(problem)),)
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
    found = [_tried(name, item) for name, item in items.items()]
    if not any(finding.fault for finding in found):
        found.append(_tried("holds the load", lambda: _holds(problem)))
    return tuple(found)


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
    for name in robot.joints:
        joint = robot.tree.joint_by_name[name]
        if joint.lower == joint.upper:
            found = f"'{name}', whose limits are both {joint.lower:g}"
            raise InputError("robot.joints", "", "joints that can move; leave others out", found)
    return f"{mass:.4g} kg, {len(robot.joints)} joints that move"


def _shapes(tree: Tree) -> str:
    """How many links with a mass have a shape or a mesh; what has none meets nothing and is not seen."""
    heavy = [link for link in tree.links if link.inertia.mass]
    shaped = sum(bool(solids_of(link)) for link in heavy)
    without = "" if shaped else ": collisions and pictures leave the robot out"
    return f"{shaped} of {len(heavy)} links with a mass{without}"


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


def _holds(problem: DesignProblem) -> str:
    options = replace(problem.options, compiled=False)
    scene, bare = problem.scene, problem.scene.designed_tree
    for robot in scene.designed[:1]:
        bare = without_frames(bare, (*(contact.frame for contact in robot.contacts), *robot.trunk))

    def freed(scene: Scene) -> Scene:
        free = (replace(each, collisions=None) for each in scene.agents)
        return scene.with_agents(*(replace(each, tree=bare) if each.designed else each for each in free))

    alone = replace(
        problem,
        scenes=tuple(map(freed, problem.scenes[:1] if scene.robots else problem.scenes)),
        options=options,
        start_portfolio=False,
        whole_reach=True,
    )
    unscaled = problem.space.unscaled(scene.designed_tree)
    middle = problem.holds[len(problem.holds) // 2]
    result = Evaluator(replace(alone, tasks=(middle,))).solve(unscaled)
    case, reach = result.cases[0], result.reach
    if reach.lowest is None or reach.highest is None:
        key, who = ("robot.hands", "the robot") if scene.robots else ("payload", "people")
        wanted = f"hands that can hold the load in front of {who} at some height"
        raise InputError(key, "", wanted, f"none ({reach.reason})")
    within = tuple(task for task in problem.holds if reach.beyond(task.heights) == 0.0)
    beyond = ", ".join(f"{task.height_m:g}" for task in problem.holds if task not in within)
    found = f"from {reach.lowest:.2f} to {reach.highest:.2f} m"
    if not within:
        who = "the robot reaches" if scene.robots else "everyone reaches"
        raise InputError("task.heights_m", "", f"a height that {who}, {found}", beyond)
    if middle not in within:
        case = Evaluator(replace(alone, tasks=within[:1])).solve(unscaled).cases[0]
    if not case.solved:
        wanted = f"a posture with the load at {case.case.task}"
        raise InputError("task.heights_m", "", wanted, f"{case.status}: {case.reason}")
    out = f"; out of reach unless a design reaches farther: {beyond} m" if beyond else ""
    apart = "" if scene.agents[0].collisions is None else ", [collisions] aside"
    return f"{found}; a posture at {case.case.task} is solved{apart}{out}"
