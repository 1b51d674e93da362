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
from evodesign.posture.precompute.plan import PROGRAMS, stages
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.factory import cached_precomputed
from evodesign.problem.precompute import precompute_setting
from evodesign.problem.prepared import DATA, Prepared, prepared_digest
from evodesign.problem.source import read_source

DEFAULT = [Path(__file__).parent / "icub_lifting.toml"]


def prepared(problem: DesignProblem) -> Prepared:
    """What the user's cache holds of a problem that was made ready."""
    cache, setting = user_cache("precomputed", os.environ), precompute_setting(problem)
    asked = {"portfolios": problem.start_portfolio, "person_reaches": problem.person_reaches}
    pieces = [piece for stage in stages(setting, problem.holds, **asked) for piece in stage]
    contents = {each: cache.read(key_of(setting, each)) for each in pieces if each.subject not in PROGRAMS}
    return Prepared(
        made_for=prepared_digest(problem.source),
        pieces=tuple((piece, msgspec.Raw(content)) for piece, content in contents.items() if content),
    )


def main() -> None:
    """Work out the problems that are asked for."""
    parser = argparse.ArgumentParser(description="write the pieces of problems that come with evodesign")
    parser.add_argument("problems", nargs="*", type=Path, default=DEFAULT)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    DATA.mkdir(exist_ok=True)
    for path in options.problems:
        target = DATA / f"{path.stem}.json"
        target.unlink(missing_ok=True)
        problem = build_problem(read_source(path))
        with JoblibPool(options.jobs) as pool:
            cached_precomputed(problem, pool)
        target.write_bytes(msgspec.json.encode(prepared(problem)) + b"\n")


if __name__ == "__main__":
    main()
