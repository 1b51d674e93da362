"""Whether a problem's postures are symmetric, and the agents averaged where they nearly are.

    exact          a scene that is its own mirror image but for rounding stays as it is
    near           an agent whose sides differ by no more than the tolerance is replaced by the mean of itself
                   and its mirror image, everywhere in the problem and in what is exported of it
    beyond, or a   `on` and `polish` refuse the problem; `auto` looks for whole postures
    lopsided scene

What was averaged, and why postures are whole, is told in a note.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from evodesign.body.placement import Placement
from evodesign.design.space import DesignSpace
from evodesign.errors import InputError, ModelError
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.scene import Scene
from evodesign.posture.postures import Symmetry
from evodesign.posture.symmetry import half, symmetric_forms
from evodesign.problem.file import ProblemFile
from evodesign.problem.unknown_names import refuse_unlisted
from evodesign.records import ProblemSource
from evodesign.tree.averaging import averaged
from evodesign.tree.frames import link_frames
from evodesign.tree.mirror_images import PLACE, SHARE, seen_in_root
from evodesign.tree.symmetry import mirror_of


@dataclass(frozen=True, slots=True)
class Resolved:
    """What a problem's symmetry came to.

    Args:
        symmetry: on, off or polish.
        scenes: with the agents that are used.
        notes: a sentence for each agent that was averaged, or for why postures are whole.
    """

    symmetry: Symmetry
    scenes: tuple[Scene, ...]
    notes: tuple[str, ...] = ()


def resolved_symmetry(
    tables: ProblemFile, source: ProblemSource, scenes: tuple[Scene, ...], space: DesignSpace
) -> Resolved:
    """The kind of postures that a problem is solved for.

    Raises:
        InputError: a kind that there is not, or symmetric postures of a scene that is not its own mirror
            image within the tolerance; it says what differs and by how much.
    """
    asked = tables.solver.symmetry if source.symmetry is None else source.symmetry
    place, key = (source.path, "solver.symmetry") if source.symmetry is None else ("--symmetry", "")
    refuse_unlisted(place, key, asked, [*Symmetry])
    if asked == Symmetry.OFF:
        return Resolved(Symmetry.OFF, scenes)
    symmetric = Symmetry.POLISH if asked == Symmetry.POLISH else Symmetry.ON
    try:
        mean, notes = _averaged_scenes(scenes)
        space.check(mean[0].designed_tree)
        space.check_mirror(mean[0].designed_tree)
        for scene in mean:
            symmetric_forms(scene)
    except InputError as error:
        if asked == Symmetry.AUTO:
            return Resolved(Symmetry.OFF, scenes, (f"postures are solved whole, not symmetric: {error}",))
        wanted = "'auto', 'off', or a scene that is its own mirror image"
        raise InputError(place, key, wanted, f"'{asked}' ({error})") from error
    return Resolved(symmetric, mean, notes)


def _averaged_scenes(scenes: Sequence[Scene]) -> tuple[tuple[Scene, ...], tuple[str, ...]]:
    """The scenes with agents that are exactly symmetric, and a note on each that was not."""
    known: dict[int, tuple[Agent, str]] = {}
    for scene in scenes:
        for agent in scene.agents:
            if id(agent) not in known:
                known[id(agent)] = _symmetric_agent(agent)
    mean = tuple(
        replace(scene, agents=tuple(known[id(agent)][0] for agent in scene.agents)) for scene in scenes
    )
    return mean, tuple(note for _, note in known.values() if note)


def _symmetric_agent(agent: Agent) -> tuple[Agent, str]:
    """The agent if it is symmetric, or the mean of it and its mirror image and a note on what differed."""
    try:
        half(agent)
    except ModelError:
        mean = averaged(agent.tree)
    else:
        return agent, ""
    _refuse_moved_frames(agent, replace(agent, tree=mean.tree))
    partners = mirror_of(mean.tree).joints
    of_pairs = {
        name: [agent.torque_limits[each] for each in (name, partners[name]) if each in agent.torque_limits]
        for name in agent.joints
    }
    limits = {name: min(known) for name, known in of_pairs.items() if known}
    who = f"{agent.name} '{agent.tree.name}'" + (f" ({agent.label})" if agent.label else "")
    note = f"{who} is averaged with its mirror image, here and in exports: {mean}"
    return replace(agent, tree=mean.tree, torque_limits=limits), note


def _refuse_moved_frames(agent: Agent, mean: Agent) -> None:
    """Refuse hands and soles that averaging moves, as it may move a joint's origin along its axis."""
    before, after = (link_frames(each.tree, Placement(), {}) for each in (agent, mean))
    seen = seen_in_root(agent.tree)
    for noun, contacts in (("hands", agent.hands), ("soles", agent.feet)):
        for side, name in ((each.side, each.frame) for each in contacts):
            moved = math.dist(before[name].translation, after[name].translation)
            most = max(PLACE, SHARE * seen[name].reach)
            if moved > most:
                found = f"'{name}', which is {1e3 * moved:.2g} mm from the mean of both sides"
                wanted = f"a frame at the mirrored place within {1e3 * most:.2g} mm"
                raise ModelError(agent.tree.name, f"{agent.name}.{noun}.{side}", wanted, found)
