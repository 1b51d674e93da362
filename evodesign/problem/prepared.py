"""Pieces of problems that come with evodesign: a first search need not wait for them.

Starts, pairs of bodies and the reach of people follow from the problem alone. Those of the default problem
lie in `data/`, as any machine works them out. They are given to a problem of the same tables and files, but
for what is named here; any other one is made ready as usual. `make prepared` writes them anew.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path

import msgspec

from evodesign.identity import Exceptions, digest
from evodesign.posture.precompute.plan import Piece
from evodesign.problem.file import HumanTable, ProblemFile, SolverTable
from evodesign.problem.source import decode_toml
from evodesign.records import ProblemSource

__all__ = ["DATA", "Prepared", "prepared_digest", "prepared_pieces"]

DATA = Path(__file__).parent / "data"
"""Folder of what was worked out, a file for each problem."""

NO_PART_OF_PREPARED: Exceptions = {
    ProblemFile: {
        "name": "is a word for results",
        "description": "is for people",
        "objectives": "weigh what postures give",
        "constraints": "judge what postures give",
        "search": "says which designs are evaluated, and when",
        "baseline": "is solved from starts of its own",
    },
    HumanTable: {
        "spread": "is asked after a search",
        "posture_sample": "begins where the mean person begins; its own part is no such piece",
    },
    SolverTable: {
        "method": "begins where others begin",
        "compile": "changes no result",
        "iterations": "ends a solve, wherever it began",
        "seconds": "ends a solve, wherever it began",
        "evaluation_seconds": "ends an evaluation, wherever it began",
        "evaluation_memory_gb": "ends an evaluation, wherever it began",
    },
    ProblemSource: {
        "path": "is for messages",
        "text": "counts as the tables that it holds",
        "method": "begins where others begin",
    },
}


class Prepared(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What was worked out of a problem.

    Args:
        made_for: digest of the problem.
        pieces: with their contents.
    """

    made_for: str
    pieces: tuple[tuple[Piece, msgspec.Raw], ...]


def prepared_digest(source: ProblemSource) -> str:
    """Digest of what the pieces of a problem may follow from."""
    tables = decode_toml(source.text, source.path, ProblemFile)
    files = {name: text for name, text in source.files.items() if name != tables.search.start}
    return digest((tables, msgspec.structs.replace(source, files=files)), without=NO_PART_OF_PREPARED)


def prepared_pieces(source: ProblemSource) -> Mapping[Piece, bytes]:
    """Contents of the pieces that come with evodesign; none for most problems."""
    known, own = _all_prepared(), prepared_digest(source)
    return {piece: bytes(content) for piece, content in known[own].pieces} if own in known else {}


@functools.cache
def _all_prepared() -> Mapping[str, Prepared]:
    found = (msgspec.json.decode(path.read_bytes(), type=Prepared) for path in sorted(DATA.glob("*.json")))
    return {each.made_for: each for each in found}
