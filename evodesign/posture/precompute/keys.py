"""The keys under which pieces are kept: digests of all that they may follow from, and of the code."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from evodesign.identity import Exceptions, Met, code_digest, digest
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import scene_of
from evodesign.nlp.method import SolverOptions
from evodesign.posture.precompute.plan import (
    Piece,
    PrecomputeSetting,
    Subject,
)

CODE, CODE_OF_LIFTS = "evodesign.posture.precompute.pieces", "evodesign.motion.lift_starts"
"""The modules that work pieces out."""

NO_PART_OF_PIECES: Exceptions = {
    PrecomputeSetting: {
        "scenes": "the one that a piece is worked out in counts",
        "middle": "says which scene that is",
        "symmetry": "polishing comes later: whether postures are symmetric counts",
        "tasks": "a piece is about one of them, or none",
    },
    Piece: {"pair": "says which scene that is"},
    Agent: {"label": "is a word for results"},
    Payload: {"label": "is a word for results"},
    SolverOptions: {
        "compiled": "IPOPT gives the same bits with machine code, and the native method has no other"
    },
}

NO_PART_OF_A_PERSONS: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        **NO_PART_OF_PIECES[PrecomputeSetting],
        "space": "a person stands behind the load, whatever the robot's hardware",
        "lowest_asked": "says what is asked of robots",
    },
}

NO_PART_OF_DESIGNS: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        name: why for name, why in NO_PART_OF_PIECES[PrecomputeSetting].items() if name != "tasks"
    },
}
"""As many are found as hold the load at each height of the tasks."""

NO_PART_OF_MEETINGS: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        name: why
        for name, why in NO_PART_OF_PIECES[PrecomputeSetting].items()
        if name not in ("tasks", "scenes")
    },
}

NO_PART_OF_PARTED: Exceptions = {
    **NO_PART_OF_PIECES,
    PrecomputeSetting: {
        name: why
        for name, why in NO_PART_OF_PIECES[PrecomputeSetting].items()
        if name in ("middle", "symmetry")
    },
}
"""Where bodies are kept apart every piece follows from the meetings of all scenes at all tasks; starts of a
lift follow from the starts of holds, which do so too."""

NO_PART_OF: Mapping[Subject, Exceptions] = {
    Subject.MEETINGS: NO_PART_OF_MEETINGS,
    Subject.PERSON_REACH: NO_PART_OF_A_PERSONS,
    Subject.DESIGNS: NO_PART_OF_DESIGNS,
    Subject.HIGHEST: NO_PART_OF_PIECES,
    Subject.LOWEST: NO_PART_OF_PIECES,
    Subject.POSTURE: NO_PART_OF_PIECES,
    Subject.LIFT: NO_PART_OF_PARTED,
}
"""Fields on which a piece does not depend, by its subject, with the reason."""


def no_part_of(setting: PrecomputeSetting, piece: Piece) -> Exceptions:
    """Fields that do not count in the key of a piece, with the reason."""
    return NO_PART_OF_PARTED if _parted(setting, piece) else NO_PART_OF[piece.subject]


def keys_of(setting: PrecomputeSetting, pieces: Iterable[Piece]) -> dict[Piece, str]:
    """The digest under which each piece is kept: of all that it may follow from, and of the code."""
    met: dict[int, Met] = {}
    return {piece: key_of(setting, piece, met) for piece in pieces}


def key_of(setting: PrecomputeSetting, piece: Piece, met: dict[int, Met] | None = None) -> str:
    """That of one piece; what was met for others, by what does not count in them, is not looked at again."""
    without = no_part_of(setting, piece)
    scene = scene_of(setting.scenes, piece.pair)
    if piece.subject is Subject.PERSON_REACH:  # a person stands behind the load, whoever holds the others
        scene = scene.only(*scene.people)
    data = (setting, setting.symmetric, scene, piece)
    code = code_digest(CODE_OF_LIFTS if piece.subject is Subject.LIFT else CODE)
    return digest((data, code), without=without, met=met if met is None else met.setdefault(id(without), {}))


def _parted(setting: PrecomputeSetting, piece: Piece) -> bool:
    """Whether a piece follows from what comes near whom, which is found where bodies are kept apart."""
    agents = scene_of(setting.scenes, piece.pair).agents
    apart = any(agent.collisions is not None for agent in agents)
    return apart and piece.subject is not Subject.MEETINGS
