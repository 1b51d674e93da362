"""What is worked out once per problem, before any robot is evaluated: the pieces of a `Precomputed`.

A piece is a function of the problem alone and is kept, as JSON, under a digest of all of the setting, the
piece and the code but for named exceptions; so a score depends neither on a cache nor on who worked it out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import islice

import msgspec
import numpy as np

from evodesign.collision.rules import BodyPair
from evodesign.design.spread import spread_designs
from evodesign.mechanics.agent import HUMAN
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.nlp.solver import SolverCache
from evodesign.posture.design_checkers import DesignCheckers, can_be_built
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, ReachProblem, people_reach
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.meetings import found_meetings, with_meetings
from evodesign.posture.precompute.plan import (
    Piece,
    PrecomputeSetting,
    Subject,
)
from evodesign.posture.precompute.precomputed import HeldLoads, PersonReach, Precomputed
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.posture.seeking.start_training import USUAL, start_portfolio
from evodesign.records import Case

LEARNED_FROM, LOOKED_AT = 96, 8
"""Designs whose reach is asked for, at most, to learn from those that hold a load; and how many times as many
are looked at, at most, as many cannot be built."""


def compute_piece(
    setting: PrecomputeSetting, piece: Piece, known: Precomputed, solvers: SolverCache | None = None
) -> bytes:
    """A piece, as it is kept.

    Args:
        setting: of the problem.
        piece: which one.
        known: what earlier stages gave.
        solvers: of other pieces.
    """
    solvers = solvers or SolverCache()
    found: PersonReach | StartPortfolio | list[HeldLoads] | None
    scene = scene_of(setting.scenes, piece.pair)
    if piece.subject is Subject.MEETINGS:
        own = setting.of(scene)
        pairs = [each.pair for each in setting.scenes]
        part, parts, symmetric = pairs.index(piece.pair), len(pairs), setting.symmetric
        extreme = piece.pair == setting.middle.pair
        found_pairs = found_meetings(
            own, setting.tasks, symmetric=symmetric, extreme=extreme, part=part, parts=parts
        )
        return msgspec.json.encode(found_pairs)
    scenes = tuple(with_meetings(scene, known.meetings) for scene in setting.scenes)
    setting = replace(setting, scenes=scenes, middle=with_meetings(setting.middle, known.meetings))
    scene = scene_of(setting.scenes, piece.pair)
    if piece.subject is Subject.PERSON_REACH:
        found = people_reach(scene, setting.options, symmetric=setting.symmetric)
    elif piece.subject is Subject.DESIGNS:
        found = _designs(setting, scene, solvers)
    else:
        found = _portfolio(setting, piece, known, solvers)
    return encoded_piece(found)


def encoded_piece(content: PersonReach | StartPortfolio | list[HeldLoads] | None) -> bytes:
    """A piece's content, as it is kept."""
    return msgspec.json.encode(content, enc_hook=np.ndarray.tolist)


def with_piece(known: Precomputed, piece: Piece, content: bytes) -> Precomputed | None:
    """What is known with one more piece; None when its content cannot be read."""
    try:
        if piece.subject is Subject.MEETINGS:
            return _with_found(known, piece, msgspec.json.decode(content, type=dict[str, list[BodyPair]]))
        if piece.subject is Subject.PERSON_REACH:
            reach = msgspec.json.decode(content, type=PersonReach | None)
            reaches = {**known.person_reaches, **({piece.pair: reach} if reach else {})}
            return replace(known, person_reaches=reaches)
        if piece.subject is Subject.DESIGNS:
            return replace(known, designs=msgspec.json.decode(content, type=tuple[HeldLoads, ...]))
        found = msgspec.json.decode(content, type=StartPortfolio)
    except msgspec.DecodeError:
        return None
    if piece.task is not None:
        person, payload = piece.pair
        own = {Case(person=person, payload=payload, task=piece.task): found}
        if piece.subject is Subject.LIFT:
            return replace(known, lifts={**known.lifts, **own})
        return replace(known, postures={**known.postures, **own})
    highest = piece.subject is Subject.HIGHEST
    return replace(known, highest=found) if highest else replace(known, lowest=found)


def _with_found(known: Precomputed, piece: Piece, found: Mapping[str, Sequence[BodyPair]]) -> Precomputed:
    """Those of a scene beside those of others: of the robot there are several."""
    meetings = dict(known.meetings)
    own = {(name, piece.pair[0] if name.startswith(HUMAN) else ""): pairs for name, pairs in found.items()}
    for key, pairs in own.items():
        meetings[key] = tuple(dict.fromkeys([*meetings.get(key, ()), *pairs]))
    return replace(known, meetings=meetings)


def _designs(setting: PrecomputeSetting, scene: Scene, solvers: SolverCache) -> list[HeldLoads]:
    """Quasi-random designs that can be built and hold the load somewhere; enough of them at each height."""
    space, built = setting.space, can_be_built(scene, setting.space)
    own = setting.of(scene, BUDGET.briefly(setting.options))
    reach = ReachProblem(own, scene.agents[0].name, symmetric=setting.symmetric, solvers=solvers)
    every = spread_designs(
        len(space.free),
        lambda genome: space.given(space.values(genome), {}),
        built,
        LOOKED_AT * LEARNED_FROM,
    )
    found: list[HeldLoads] = []
    holding = Counter({height: 0 for task in setting.tasks for height in task.heights})
    for design in islice(every, LEARNED_FROM):
        held = reach.solve(design)
        if held.lowest is not None and held.highest is not None:
            found.append((design, held.lowest, held.highest))
            holding.update(height for height in holding if held.lowest <= height <= held.highest)
        if min(holding.values(), default=0) >= USUAL.designs:
            break
    return found


def _portfolio(
    setting: PrecomputeSetting, piece: Piece, known: Precomputed, solvers: SolverCache
) -> StartPortfolio:
    scene, task = scene_of(setting.scenes, piece.pair), piece.task
    own, designs = setting.of(scene, BUDGET.briefly(setting.options)), known.designs_for(task)
    if task is None:
        sense = HIGHEST if piece.subject is Subject.HIGHEST else LOWEST
        reach = ReachProblem(own, scene.agents[0].name, symmetric=setting.symmetric, solvers=solvers)
        return start_portfolio(reach.landscape(sense), designs)
    checker_of = None if scene.agents[0].collisions is None else DesignCheckers(scene, setting.space).of
    problem = PostureProblem(own, setting.symmetry, known, solvers)
    landscape = problem.landscape(task, checker_of)
    near = known.starts(piece.pair, piece.after) if piece.after else ()
    return start_portfolio(replace(landscape, universal=near or landscape.universal), designs)
