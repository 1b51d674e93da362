"""Making a problem ready: pieces that no cache holds are worked out, by workers side by side."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from evodesign.errors import InputError, RunError
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.motion.lift_starts import lift_portfolio
from evodesign.nlp.compiler import optimiser
from evodesign.nlp.disk_cache import Cache
from evodesign.nlp.solver import own_solvers
from evodesign.pool.base import Limits, Pool
from evodesign.posture.precompute.keys import keys_of
from evodesign.posture.precompute.pieces import compute_piece, encoded_piece, with_piece
from evodesign.posture.precompute.plan import (
    OF_STARTS,
    Piece,
    PrecomputeSetting,
    Subject,
    all_mean_people,
    stages,
)
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem
from evodesign.problem.teams import refuse_lift
from evodesign.records import Lift


def precompute_setting(problem: DesignProblem) -> PrecomputeSetting:
    """What a problem's pieces follow from."""
    return PrecomputeSetting(
        problem.scenes,
        problem.middle,
        problem.space,
        problem.weights,
        problem.options,
        problem.symmetry,
        problem.holds,
        problem.lowest_asked,
    )


def staged_pieces(problem: DesignProblem, lifts: Sequence[Lift] = ()) -> list[list[Piece]]:
    """The pieces that a problem is made ready by, stage after stage.

    Args:
        problem: to be made ready.
        lifts: beside its own.
    """
    if lifts:
        refuse_lift(problem.scene, problem.source)
    return stages(
        precompute_setting(problem),
        problem.holds,
        portfolios=problem.start_portfolio,
        person_reaches=problem.person_reaches,
        lifts=[*(task for task in problem.tasks if isinstance(task, Lift)), *lifts],
    )


def precomputed(
    problem: DesignProblem,
    cache: Cache | None,
    pool: Pool,
    watcher: PrecomputeProgress,
    lifts: Sequence[Lift] = (),
) -> Precomputed:
    """What is known of a problem before any robot is evaluated.

    That of people who were drawn from a distribution is that of the mean ones.

    Args:
        problem: to be made ready.
        cache: of pieces worked out before; None to work out everything.
        pool: where pieces are worked out.
        watcher: is shown what is worked out.
        lifts: of which starts are asked for, beside the problem's own.
    Raises:
        RunError: a piece could not be worked out; it says which and why.
        InputError: a height at which one of the people cannot hold a load.
    """
    setting, staged = all_mean_people(precompute_setting(problem)), staged_pieces(problem, lifts)
    keys, known = keys_of(setting, (piece for stage in staged for piece in stage)), Precomputed()

    def content_of(piece: Piece) -> bytes | None:
        return cache.read(keys[piece]) if cache else None

    absent = [piece for stage in staged for piece in stage if content_of(piece) is None]
    if absent:
        watcher.missing(len(absent))
        behind = optimiser(os.environ) if problem.options.compiled else None
        if behind and any(piece.subject in OF_STARTS for piece in absent):
            watcher.note(f"all solves begin on TinyCC's code; {behind} optimises behind them what takes long")
    for stage in staged:
        missing = []
        for piece in stage:
            content = content_of(piece)
            found = with_piece(known, piece, content) if content else None
            if found is None:
                missing.append(piece)
            else:
                known = found
        if missing:
            spoilt = [piece for piece in missing if piece not in absent]
            if spoilt:
                watcher.missing(len(spoilt))
            for piece, content in _worked_out(problem, setting, keys, missing, known, pool, watcher).items():
                if cache is not None:
                    cache.store(keys[piece], content)
                found = with_piece(known, piece, content)
                if found is None:
                    raise RunError(f"{piece}: what was worked out cannot be read back")
                known = found
        if any(piece.subject is Subject.PERSON_REACH for piece in stage):
            refuse_heights(problem, known)
    return known


def refuse_heights(problem: DesignProblem, known: Precomputed) -> None:
    """Refuse a height at which one of the people cannot hold a load, whatever the robot.

    Raises:
        InputError: naming the height and the person; or a person who cannot hold a load at any height.
    """
    for scene in problem.scenes:
        who, reach = scene.label or "the person", known.person_reaches.get(scene.pair)
        if reach is None:
            if problem.person_reaches:
                wanted = "people who can hold every load"
                raise InputError(problem.source.path, "human", wanted, f"{who}, at no height")
            continue
        for key, height in problem.named_heights.items():
            if not reach.lowest <= height <= reach.highest:
                wanted = f"a height that {who} can hold, from {reach.lowest:.3f} to {reach.highest:.3f} m"
                raise InputError(problem.source.path, key, wanted, f"{height:g}")


def _worked_out(
    problem: DesignProblem,
    setting: PrecomputeSetting,
    keys: Mapping[Piece, str],
    missing: Sequence[Piece],
    known: Precomputed,
    pool: Pool,
    watcher: PrecomputeProgress,
) -> dict[Piece, bytes]:
    """Contents of the pieces, in the order in which they are missing."""
    contents: dict[Piece, bytes] = {}
    name = " ".join(keys[piece] for piece in missing)
    factory = _PieceFactory(name, setting, known, replace(problem.limits, seconds=SECONDS))
    for finished in pool.run(factory, missing):
        piece = missing[finished.index]
        if finished.value is None:
            raise RunError(f"{problem.name}: {piece} could not be worked out: {finished.failure}")
        contents[piece] = finished.value
        watcher.done(str(piece))
    return {piece: contents[piece] for piece in missing}


SECONDS = 3600.0
"""What a piece may cost [s]: a portfolio takes thousands of solves, long ones with rigid grasps or a busy
machine."""


@dataclass(frozen=True, slots=True)
class _PieceFactory:
    """Gives, in whichever process it is called, the function from a piece to its content.

    The setting travels as numbers: meshes and what may overlap take seconds to work out again.
    """

    name: str
    setting: PrecomputeSetting = field(compare=False)
    known: Precomputed = field(compare=False)
    limits: Limits = field(compare=False)

    def __call__(self) -> Callable[[Piece], bytes]:
        return lambda piece: _content(self.setting, piece, self.known)


def _content(setting: PrecomputeSetting, piece: Piece, known: Precomputed) -> bytes:
    if isinstance(piece.task, Lift):
        return encoded_piece(lift_portfolio(setting, piece.pair, piece.task, known))
    return compute_piece(setting, piece, known, own_solvers())
