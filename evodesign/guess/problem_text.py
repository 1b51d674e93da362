"""A problem file for a robot, from what its file says and what was guessed; each guess with its reason.

What could not be guessed is `FILL IN` in the file, which no key may be, so that `check` names its key.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from evodesign.guess.body_plan import BodyPlan, body_plan
from evodesign.guess.contacts import Contacts, GuessedContact, contacts, frame_xyz_rpy
from evodesign.guess.hardware_text import hardware_text
from evodesign.guess.heights import held_heights
from evodesign.guess.parameters import Group, LengthBound, LoadGuess, groups, length_bounds, load_guess
from evodesign.mechanics.agent import SIDES
from evodesign.problem.agent_tables import Facing
from evodesign.problem.table import FILL_IN
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import InertiaRule

KNEE_FLEXION = 15
"""Least angle of knees [deg]: our choice."""


@dataclass(frozen=True, slots=True)
class Guess:
    """What was guessed for a key, and why; `found` is nothing if it could not be."""

    key: str
    found: str
    why: str


@dataclass(frozen=True, slots=True)
class GuessedProblem:
    """A problem file's text and what is guessed in it."""

    text: str
    guesses: tuple[Guess, ...]


def guessed_problem(tree: Tree, urdf: str) -> GuessedProblem:
    """A problem for a robot.

    Args:
        tree: the robot, of numbers.
        urdf: its file's name, as the problem is to have it.
    Raises:
        ModelError: it has no two legs.
    """
    plan = body_plan(tree)
    found = contacts(plan)
    load = load_guess(plan, _ground(plan, found))
    segments = [_Segment(each, length_bounds(tree, each.links)) for each in groups(plan)]
    before = [*_head(tree, urdf), *_robot(plan, found)]
    after = [*_lengths(segments), *hardware_text(plan)]
    why = "from the hips to the shoulders"
    draft = _text(before, _others(load, why), after)
    if held := held_heights(draft, urdf, tree):
        load = replace(load, heights=held.heights)
        ends = f"{held.lowest:.2f} to {held.highest:.2f} m"
        why = f"robot and people hold {ends}; the taller one's hands hang at {held.hanging:.2f} m"
    return GuessedProblem(
        _text(before, _others(load, why), after),
        (*_guesses(plan, found, load, why), *(each.guess() for each in segments)),
    )


def _text(*parts: Iterable[str]) -> str:
    return "".join(f"{line}\n" for part in parts for line in part)


def _ground(plan: BodyPlan, found: Contacts) -> float:
    """Height of the soles in the root's frame [m], or of the lowest joint where they are not known."""
    if not found.soles:
        return min(float(leg.end.origin[2]) for leg in plan.legs.values())
    heights = []
    for side in SIDES:
        sole = found.soles[side]
        heights.append((plan.welded.places[sole.link] @ sole.place).translation[2])
    return sum(map(float, heights)) / len(heights)


def _head(tree: Tree, urdf: str) -> Sequence[str]:
    return (
        f"# A problem for {json.dumps(tree.name)}, guessed from its file by `evodesign init`.",
        "# `evodesign check` shows what the guesses mean; docs/problem_file.md has all keys.",
        f"name = {json.dumps(tree.name)}",
        "",
        "[robot]",
        f"urdf = {json.dumps(urdf)}",
    )


def inertia_rule(tree: Tree) -> InertiaRule:
    """The rule for a whole robot: its file's, where meshes show that its shapes are not all of it."""
    return InertiaRule.FILE if any(link.meshes for link in tree.links) else InertiaRule.AUTO


def _robot(plan: BodyPlan, found: Contacts) -> Iterable[str]:
    rule = inertia_rule(plan.welded.tree)
    if rule is not InertiaRule.AUTO:
        yield f'inertia = "{rule}"  # also of links without meshes'
    facing = "" if plan.facing else f"  # {FILL_IN} the direction in which the robot looks: {plan.why}"
    if plan.facing is not Facing.FORWARD:
        yield f'facing = "{plan.facing or Facing.FORWARD}"{facing}'
    hands = {side: found.hands[side].frame if found.hands else FILL_IN for side in SIDES}
    marked = "" if found.hands else f"  # {FILL_IN}: {found.why_hands}"
    yield f"hands = {_inline(hands)}{marked}"
    yield _soles(plan, found)
    yield f"trunk = {json.dumps(_trunk_frames(plan))}  # keeps a distance from the load"
    knees = [leg.bodies[leg.bend].joint for leg in plan.legs.values()]
    if all(knee is not None and math.isfinite(knee.upper - knee.lower) for knee in knees):
        yield f"knee_flexion_deg = {KNEE_FLEXION}  # at least: straight legs hold any load for nothing"
    else:
        yield "# no knee_flexion_deg: knees without limits may bend to either side"
    yield "joints = ["
    yield from (f"    {json.dumps(name)}," for name in plan.joints)
    yield "]"
    contacts_made = (*found.hands.values(), *found.soles.values())
    yield from (line for contact in contacts_made if contact.link for line in _frame(contact))


def _soles(plan: BodyPlan, found: Contacts) -> str:
    soles = {side: found.soles[side].frame if found.soles else FILL_IN for side in SIDES}
    length, width = found.sole_size
    if found.soles:
        return f"soles = {_inline(soles)[:-2]}, size_m = [{length:g}, {width:g}] }}  # length, width"
    feet = " and ".join(plan.legs[side].end.name for side in SIDES)
    why = f"{FILL_IN} frames under {feet}, such as [[robot.frames]], and length and width: {found.why_soles}"
    return f'soles = {_inline(soles)[:-2]}, size_m = "{FILL_IN}" }}  # {why}'


def _inline(names: dict[str, str]) -> str:
    return f"{{ {', '.join(f'{key} = {json.dumps(name)}' for key, name in names.items())} }}"


def _trunk_frames(plan: BodyPlan) -> list[str]:
    """The links with mass that hips and shoulders are joined to."""
    return [*dict.fromkeys(plan.welded.heaviest(body.links) for body in (plan.trunk[0], plan.trunk[-1]))]


def _frame(contact: GuessedContact) -> Sequence[str]:
    xyz, rpy = frame_xyz_rpy(contact)
    return (
        "",
        "[[robot.frames]]",
        f"name = {json.dumps(contact.frame)}",
        f"link = {json.dumps(contact.link)}",
        f"xyz_m = {[*xyz]}",
        f"rpy_rad = {[*rpy]}",
    )


def _others(load: LoadGuess, why_heights: str) -> Sequence[str]:
    return (
        "",
        "[[human]]  # the two ends of nine in ten adults: small and weak, tall and heavy",
        'population = { sex = "female", percentiles = [5] }',
        'posture = "measured"  # drawn to postures in which people were measured',
        "#spread = 10  # after a search: its front beside ten who stand otherwise (write it twice)",
        "",
        "[[human]]",
        'population = { sex = "male", percentiles = [95] }',
        'posture = "measured"',
        "#spread = 10",
        "",
        "[payload]",
        f"size_m = {[*load.size]}  # depth (robot to person), width, height",
        f"mass_kg = {load.mass}  # a tenth of the robot's, from 1 to 15",
        'grasp = "rigid"  # hands pass moments: either agent may carry more than half',
        "# So that either carries up to three quarters: mass x g x depth / 16, at most 7, what wrists bear",
        "# (Delp, Grierson and Buchanan 1996); more than it takes would hold up forearms at no cost.",
        f"hand_moment_n_m = {load.hand_moment:g}",
        "",
        "[task]",
        f"heights_m = {[*load.heights]}  # {why_heights}",
        "",
        "[collisions]  # nothing passes through anything",
        "",
        "[objectives]",
        'minimise = ["robot_torque", "human_torque"]',
        'maximise = ["shared_reach_height"]  # as high as the smaller person also reaches',
        "",
        "[search]",
        'algorithm = "surrogate"',
        "evaluations = 480",
        "seed = 1",
        "",
        "[[design.allocation]]  # who carries how much",
        'name = "effort_ratio"',
        "lower = -2.0  # of their efforts the robot's counts a hundredth of the person's",
        "upper = 1.0  # ten times it",
    )


def _lengths(segments: Iterable[_Segment]) -> Iterator[str]:
    yield ""
    yield "# Lengths as multiples of the robot's own: from 0.6 to 1.6, and no farther than bodies with two or"
    yield "# three joints between them stay clear of each other while all joints are at zero."
    for segment in segments:
        yield from segment.lines()


@dataclass(frozen=True, slots=True)
class _Segment:
    """Links that share a length multiplier, and its bounds; none without links."""

    group: Group
    bounds: tuple[LengthBound, ...]

    def lines(self) -> Iterator[str]:
        """The parameter's table, or why there is none."""
        name, links = self.group.name, self.group.links
        if not links:
            yield from ("", f"# no [[design.length]] {name}: {self.group.why_not}")
            return
        yield from ("", "[[design.length]]", f"name = {json.dumps(name)}", f"links = {json.dumps(links)}")
        for key, bound in zip(("lower", "upper"), self.bounds, strict=True):
            reason = f"  # beyond it {' and '.join(bound.overlap)} overlap" if bound.overlap else ""
            yield f"{key} = {bound.multiplier:g}{reason}"

    def guess(self) -> Guess:
        """The same for a person."""
        why = self.group.why_not
        if self.group.links:
            lower, upper = (bound.multiplier for bound in self.bounds)
            why = f"{self.group.length:.3g} m long; {lower:g} to {upper:g} times that"
        return Guess(f"design.length {self.group.name}", ", ".join(self.group.links), why)


def _guesses(plan: BodyPlan, found: Contacts, load: LoadGuess, why_heights: str) -> Iterable[Guess]:
    length, width = found.sole_size
    hands = ", ".join(contact.frame for contact in found.hands.values())
    heights = ", ".join(f"{height:g}" for height in load.heights)
    why = "links are meshes" if inertia_rule(plan.welded.tree) is InertiaRule.FILE else "no link is a mesh"
    yield Guess("robot.inertia", inertia_rule(plan.welded.tree), why)
    yield Guess("robot.facing", str(plan.facing or ""), plan.why)
    yield Guess("robot.hands", hands, found.why_hands)
    yield Guess("robot.soles", f"{length:g} x {width:g} m" if found.soles else "", found.why_soles)
    yield Guess("robot.trunk", ", ".join(_trunk_frames(plan)), "what hips and shoulders are joined to")
    yield Guess("robot.joints", f"{len(plan.joints)} joints", "those between hands and feet")
    yield Guess("payload", f"{load.mass:g} kg, {load.size[1]:g} m wide", "a tenth of the mass; the shoulders")
    yield Guess(
        "payload.hand_moment_n_m", f"{load.hand_moment:g}", "either may carry three quarters of the load"
    )
    yield Guess("task.heights_m", heights, why_heights)
