"""What matters by a log: shares known beforehand, honest refusals, parameters that change nothing, slices."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray
from SALib.analyze import sobol
from SALib.sample import sobol as sobol_sample
from scipy.stats import qmc

import evodesign
from evodesign.analysis.importance import Importance, importance, slices
from evodesign.records import (
    Assessment,
    Evaluation,
    Gradients,
    Objective,
    Parameter,
    RunHeader,
    Sense,
    Status,
)
from evodesign.runlog.writer import RunWriter
from tests.analysis.test_variance_shares import ishigami, ishigami_shares
from tests.runlog.toys import toy_header

Array = NDArray[np.float64]


def header(names: tuple[str, ...], dimension: int, choices: tuple[float, ...] = ()) -> RunHeader:
    """Of a run whose first parameter may have choices."""
    base = toy_header(dimension=dimension)
    parameters = tuple(
        Parameter(name=f"p{axis}", lower=0.0, upper=1.0, unit="1", choices=choices if axis == 0 else ())
        for axis in range(dimension)
    )
    search = msgspec.structs.replace(base.search, objectives=len(names))
    if choices:
        search = msgspec.structs.replace(search, choices=(len(choices), *(0,) * (dimension - 1)))
    objectives = tuple(Objective(name=name, sense=Sense.MINIMISE, unit="m") for name in names)
    return msgspec.structs.replace(base, parameters=parameters, objectives=objectives, search=search)


def logged(
    made: RunHeader, points: Array, values: dict[str, Array], slopes: dict[str, Array] | None = None
) -> list[Evaluation]:
    """Evaluations of points; objectives that are not a number are left out."""
    found = []
    for number, point in enumerate(points):
        gradients: Gradients | msgspec.UnsetType = msgspec.UNSET
        if slopes is not None:
            rows = {
                name: dict(zip(("p0", "p1", "p2"), each[number].tolist(), strict=False))
                for name, each in slopes.items()
            }
            gradients = Gradients(values=rows, absent={})
        objectives = {name: float(each[number]) for name, each in values.items() if np.isfinite(each[number])}
        assessment = Assessment(
            design={parameter.name: float(x) for parameter, x in zip(made.parameters, point, strict=True)},
            objectives=objectives,
            violation=0.0,
            status=Status.SOLVED,
            reason="",
            gradients=gradients,
        )
        genome = tuple(point.tolist())
        found.append(
            Evaluation(
                number=number, generation=0, genome=genome, assessment=assessment, seconds=0.0, worker=""
            )
        )
    return found


def quasi_random(count: int, dimension: int) -> Array:
    return np.asarray(qmc.Sobol(dimension, rng=np.random.default_rng(0)).random(count))


def shares(found: Importance, kind: str) -> dict[str, tuple[float, float, float]]:
    """By parameter: value, low and high."""
    rows = {each.name: getattr(each, kind) for each in found.objectives[0].parameters}
    return {name: (each.value, each.low, each.high) for name, each in sorted(rows.items())}


@pytest.mark.slow
def test_importance_agrees_with_salib_on_8192_evaluations_within_what_it_says() -> None:
    """Ishigami's function: SALib from 8,192 evaluations of the function, ours from as many logged designs."""
    problem = {"num_vars": 3, "names": ["x", "y", "z"], "bounds": [[0.0, 1.0]] * 3}
    points = sobol_sample.sample(problem, 1024, seed=1)
    assert len(points) == 8192
    wanted = sobol.analyze(problem, ishigami(points)[:, 0], seed=1)
    made = header(("torque",), 3)
    logs = quasi_random(8192, 3)
    found = importance(made, logged(made, logs, {"torque": ishigami(logs)[:, 0]}))
    explained = found.objectives[0].response.explained
    assert explained is not None
    assert explained > 0.995
    unexplained = 1.0 - explained
    first, total, pair = ishigami_shares()
    for kind, salib, bound, exact in (("first", "S1", "S1_conf", first), ("total", "ST", "ST_conf", total)):
        for axis, (value, low, high) in enumerate(shares(found, kind).values()):
            assert value == pytest.approx(exact[axis], abs=0.015)
            slack = unexplained + wanted[bound][axis] + 0.005
            assert low - slack <= wanted[salib][axis] <= high + slack
    (strongest, *_) = found.objectives[0].pairs
    assert strongest.names == ("p0", "p2")
    assert strongest.share.value == pytest.approx(pair, abs=0.025)


def test_of_few_designs_the_interval_is_wide_and_holds_the_truth() -> None:
    made = header(("torque",), 3)
    points = quasi_random(256, 3)
    few = importance(made, logged(made, points, {"torque": ishigami(points)[:, 0]}))
    explained = few.objectives[0].response.explained
    assert explained is not None
    _, total, _ = ishigami_shares()
    for (_, low, high), exact in zip(shares(few, "total").values(), total, strict=True):
        assert low - (1.0 - explained) <= exact <= high + (1.0 - explained)
    assert max(high - low for _, low, high in shares(few, "total").values()) > 0.02


def test_a_parameter_that_changes_nothing_is_told() -> None:
    made = header(("torque", "reach"), 3)
    points = quasi_random(256, 3)
    values = {"torque": points[:, 0] ** 2 + 2.0 * points[:, 2], "reach": points[:, 0]}
    found = importance(made, logged(made, points, values))
    told = [sentence for sentence in found.sentences if "nothing" in sentence]
    assert told[0].startswith("p1 changes nothing: it accounts for ")
    assert told[1].startswith("p2 changes nothing of reach: it accounts for ")
    assert len(told) == 2


def test_where_designs_look_like_chance_no_importance_is_made_up() -> None:
    made = header(("torque",), 2)
    points = quasi_random(256, 2)
    found = importance(made, logged(made, points, {"torque": np.random.default_rng(1).random(256)}))
    (objective,) = found.objectives
    assert all(row.total is None for row in objective.parameters)
    assert "cannot be told from this log: the model explains" in found.sentences[0]
    assert slices(found, made.parameters, logged(made, points[:1], {})[0]) == ()


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (np.full(64, 2.0), "it is the same for all designs"),
        (
            np.r_[np.full(60, np.nan), np.arange(4.0)],
            "4 evaluated designs have it, and at least 60 are wanted",
        ),
    ],
)
def test_why_nothing_can_be_told(values: Array, reason: str) -> None:
    made = header(("torque",), 2)
    found = importance(made, logged(made, quasi_random(64, 2), {"torque": values}))
    assert found.sentences == (f"what matters to torque cannot be told from this log: {reason}",)


def test_numbers_that_no_robot_has_are_left_out() -> None:
    made = header(("torque",), 2)
    points = quasi_random(64, 2)
    values = points[:, 0].copy()
    values[:3] = 1e308, -1e308, 1e200
    slopes = np.tile([1.0, 0.0], (64, 1))
    slopes[5] = 1e300
    found = importance(made, logged(made, points, {"torque": values}, {"torque": slopes})).objectives[0]
    assert (found.response.designs, found.response.with_gradients) == (61, 60)
    assert found.parameters[0].name == "p0"


def test_gradients_give_slopes_and_better_models() -> None:
    made = header(("torque",), 3)
    points = quasi_random(64, 3)
    angles = np.pi * (2.0 * points - 1.0)
    values = {"torque": np.sin(angles[:, 0]) + 0.5 * np.cos(angles[:, 1])}
    slopes = np.zeros((64, 3))
    slopes[:, 0] = 2.0 * np.pi * np.cos(angles[:, 0])
    slopes[:, 1] = -np.pi * np.sin(angles[:, 1])
    bare = importance(made, logged(made, points, values)).objectives[0]
    full = importance(made, logged(made, points, values, {"torque": slopes})).objectives[0]
    assert (full.response.with_gradients, bare.response.with_gradients) == (64, 0)
    assert (full.response.explained or 0.0) > max(0.9, bare.response.explained or 0.0)
    found = {each.name: each.slope for each in full.parameters}
    for axis in range(3):
        slope = found[f"p{axis}"]
        assert slope is not None
        assert slope.value == pytest.approx(np.sqrt((slopes[:, axis] ** 2).mean()))
        assert slope.low <= slope.value <= slope.high
    assert all(each.slope is None for each in bare.parameters)


def test_slices_follow_the_function_and_choices_have_their_own_places() -> None:
    made = header(("torque",), 2, choices=(1.0, 2.0, 5.0))
    points = quasi_random(256, 2)
    points[:, 0] = (np.floor(points[:, 0] * 3) + 0.5) / 3
    designs = logged(made, points, {"torque": 3.0 * points[:, 0] + np.sin(3.0 * points[:, 1])})
    found = importance(made, designs)
    choices, smooth = slices(found, made.parameters, designs[7])
    assert choices.values == (1.0, 2.0, 5.0)
    here = points[7]
    wanted = 3.0 * np.array([1, 3, 5]) / 6 + np.sin(3.0 * here[1])
    assert choices.predicted == pytest.approx(wanted, abs=0.05)
    along = 3.0 * here[0] + np.sin(3.0 * np.array(smooth.values))
    assert smooth.predicted == pytest.approx(along, abs=0.05)
    assert all(
        low <= middle <= high
        for low, middle, high in zip(smooth.low, smooth.predicted, smooth.high, strict=True)
    )


def test_a_run_tells_it_from_python(tmp_path: Path) -> None:
    made = header(("torque",), 2)
    points = quasi_random(64, 2)
    with RunWriter(tmp_path / "run", made) as log:
        for evaluation in logged(made, points, {"torque": points[:, 0] + 0.2 * points[:, 1]}):
            log.write(evaluation)
    told = evodesign.open_run(tmp_path / "run").matters(through=3)
    (objective,) = told["objectives"]
    assert [each["name"] for each in objective["parameters"]] == ["p0", "p1"]
    assert objective["parameters"][0]["total"]["value"] == pytest.approx(1.0 / 1.04, abs=0.02)
    assert [each["parameter"] for each in told["slices"]] == ["p0", "p1"]
    assert told == evodesign.open_run(tmp_path / "run").matters(through=3)
