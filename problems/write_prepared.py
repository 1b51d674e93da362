"""Write the pieces of problems that come with evodesign, as any machine would work them out.

    python problems/write_prepared.py [problems/icub_lifting.toml ...] [--jobs 2]

Each problem is made ready in the user's cache as if nothing came with it; all its pieces but machine code go
to evodesign/problem/data/. To be run anew when a test says that a problem is another one now, or when the
code that works them out has become better.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import msgspec

from evodesign.nlp.disk_cache import user_cache
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.posture.precompute.keys import key_of
from evodesign.posture.precompute.plan import PROGRAMS, Piece
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.precompute import precompute_setting, precomputed, staged_pieces
from evodesign.problem.prepared import DATA, Prepared, prepared_digest
from evodesign.problem.progress import SILENT
from evodesign.problem.source import read_source

DEFAULT = [Path(__file__).parent / "icub_lifting.toml"]


def prepared(problem: DesignProblem, jobs: int) -> Prepared:
    """What is worked out of a problem, or was before, by so many jobs."""
    cache, setting = user_cache("precomputed", os.environ), precompute_setting(problem)
    with JoblibPool(jobs) as pool:
        precomputed(problem, cache, pool, SILENT, given={})

    def content(piece: Piece) -> msgspec.Raw:
        found = cache.read(key_of(setting, piece))
        if found is None:
            raise RuntimeError(f"{piece}: worked out, and not in the cache")
        return msgspec.Raw(found)

    pieces = [piece for stage in staged_pieces(problem) for piece in stage if piece.subject not in PROGRAMS]
    return Prepared(prepared_digest(problem.source), tuple((piece, content(piece)) for piece in pieces))


def main() -> None:
    """Work out the problems that are asked for."""
    parser = argparse.ArgumentParser(description="write the pieces of problems that come with evodesign")
    parser.add_argument("problems", nargs="*", type=Path, default=DEFAULT)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    DATA.mkdir(exist_ok=True)
    for path in options.problems:
        content = msgspec.json.encode(prepared(build_problem(read_source(path)), options.jobs))
        (DATA / f"{path.stem}.json").write_bytes(content + b"\n")


if __name__ == "__main__":
    main()
