"""What does a lift from near the floor ask of the back, beside a lift that was measured?

The man of the measured stoop lifts (1.73 m, 81.68 kg, `evodesign validate`) takes a box of 15 kg from the
floor: his wrists rise from 0.36 to 0.88 m in about 1.5 s. Ours lifts one of 30 kg with a robot, in point
grasps, so that each carries 15 kg: the palms from 0.30 to 0.80 m. Random designs of icub-lift with long
limbs, the first ones whose reach has both heights; in point grasps the person's motion does not depend on
them. Told are the largest moment of L5/S1 over the time of a lift, the largest that statics give in the same
postures, and when and in which posture the first one is. A row of benchmarks/results/lift_backs.json is
replaced for each duration that is run.

    python -m benchmarks.lift_backs [--designs 1] [--seconds 1.5 1.0 2.0]
"""

from __future__ import annotations

import argparse
import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np
import tomli_w

from benchmarks.inner_problem import HERE
from evodesign.evaluation.evaluate import Evaluator
from evodesign.mechanics.agent import HUMAN
from evodesign.mechanics.balance import GRAVITY
from evodesign.nlp.method import MethodName
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.motion_quantities import l5s1_moment
from evodesign.validation.measured import STOOPER, data_rows
from evodesign.validation.posed import PosedPerson

RESULTS = HERE / "results" / "lift_backs.json"
LOAD = 15.0
"""That each of the two carries, and the measured man alone [kg]."""

FROM, TO = 0.30, 0.80
LONG = (0.55, 0.95)
"""Genes of the designs: shorter limbs do not reach down."""

ANGLES = ("trunk_low", "trunk_up", "knee")


def problem(seconds: float) -> DesignProblem:
    """The icub-lift problem with the measured man and lift, solved by IPOPT from fixed starts."""
    source = read_source("icub-lift")
    tables: dict[str, Any] = tomllib.loads(source.text)
    tables |= {
        "human": {
            "stature_m": STOOPER.stature,
            "mass_kg": STOOPER.mass,
            "sex": str(STOOPER.sex),
            "shoulder_width": str(STOOPER.shoulder_width),
        },
        "task": {"lift": [{"from_m": FROM, "to_m": TO, "seconds": seconds}]},
    }
    tables["payload"]["mass_kg"] = 2.0 * LOAD
    built = build_problem(msgspec.structs.replace(source, text=tomli_w.dumps(tables)))
    return replace(
        built, options=replace(built.options, method=MethodName.IPOPT, compiled=False, seconds=600.0)
    )


def lifted(designs: int, seconds: float) -> Iterator[DesignResult]:
    """Results of so many random designs that reach both heights."""
    asked = problem(seconds)
    evaluator, rng = Evaluator(asked), np.random.default_rng(8)
    while designs:
        genome = rng.uniform(*LONG, len(asked.space.parameters))
        result = evaluator.solve(asked.space.values(tuple(genome.tolist())))
        if result.reach.beyond((FROM, TO)) == 0.0:
            designs -= 1
            yield result


def figures(result: DesignResult, posed: PosedPerson) -> Mapping[str, float | str]:
    """What one lift asks of the back."""
    (solution,) = result.cases
    if not solution.solved:
        return {"status": str(solution.status), "reason": solution.reason}
    person, load = result.scene_of(solution.case).human, LOAD * GRAVITY
    peak = max(solution.instants, key=lambda instant: l5s1_moment(person, instant.postures[HUMAN]))
    resting = [posed.posed(instant.postures[HUMAN], load).moments["l5s1"] for instant in solution.instants]
    there = posed.posed(peak.postures[HUMAN], load)
    return {
        "status": str(solution.status),
        "peak_n_m": l5s1_moment(person, peak.postures[HUMAN]),
        "peak_of_statics_n_m": max(resting),
        "statics_at_peak_n_m": there.moments["l5s1"],
        "seconds_at_peak": peak.time,
        "load_at_peak_m": peak.height or FROM,
        **{f"{name}_deg": there.angles[name] for name in ANGLES},
    }


def measured() -> Mapping[str, float]:
    """The largest measured moment of each recording [N m]."""
    rows = list(data_rows("stoop_lifts.csv"))
    names = dict.fromkeys(row["recording"] for row in rows)
    return {name: max(float(row["l5s1_n_m"]) for row in rows if row["recording"] == name) for name in names}


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=1)
    parser.add_argument("--seconds", type=float, nargs="+", default=[1.5, 1.0, 2.0])
    options = parser.parse_args()
    posed = PosedPerson(STOOPER)
    for seconds in options.seconds:
        rows = [figures(result, posed) for result in lifted(options.designs, seconds)]
        known = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
        told = {**known, "measured_peaks_n_m": measured(), f"{seconds:g} s": rows}
        RESULTS.write_text(json.dumps(told, indent=2) + "\n")
        print(json.dumps(told, indent=2), flush=True)


if __name__ == "__main__":
    main()
