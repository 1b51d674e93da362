"""People drawn from the distribution of measured postures: means and covariances again, from the rows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from evodesign.human.measured_posture import (
    FEATURES,
    MEAN_PERSON,
    PURE_NUMBERS,
    drawn_person,
    gaussians,
    posture_rows,
)

DRAWS = 4000
TASKS = ("hold", "lift")


def of_rows(task: str) -> dict[float, tuple[np.ndarray, np.ndarray]]:
    """Mean and covariance of the features at each height, element by element from the data file."""
    units = [1.0 if name in PURE_NUMBERS else math.pi / 180.0 for name in FEATURES]
    rows = [row for row in posture_rows() if row.task in (task, "both") and not math.isnan(row.eta)]
    found = {}
    for eta in sorted({row.eta for row in rows}):
        here = {row.quantity: row for row in rows if row.eta == eta}
        mean = np.array([here[name].mean * unit for name, unit in zip(FEATURES, units, strict=True)])
        covariance = np.zeros((len(FEATURES), len(FEATURES)))
        for i, one in enumerate(FEATURES):
            for j, other in enumerate(FEATURES):
                pair = here.get(f"{one} {other}") or here.get(f"{other} {one}")
                share = 1.0 if i == j else 0.0 if pair is None else pair.mean
                covariance[i, j] = share * here[one].deviation * units[i] * here[other].deviation * units[j]
        found[eta] = mean, covariance
    return found


@pytest.mark.parametrize("task", TASKS)
def test_the_roots_are_those_of_the_rows_covariances(task: str) -> None:
    for root, (_, covariance) in zip(
        gaussians(posture_rows(), task).roots, of_rows(task).values(), strict=True
    ):
        assert root @ root.T == pytest.approx(covariance, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("task", TASKS)
def test_drawn_people_have_the_rows_means_and_covariances(task: str) -> None:
    given = gaussians(posture_rows(), task)
    people = [drawn_person(sample) for sample in range(1, DRAWS + 1)]
    for eta, (mean, covariance) in of_rows(task).items():
        drawn = np.array([[*given.mean(eta, person).values()] for person in people[::4]])
        deviation = np.sqrt(np.diag(covariance))
        away = (drawn - mean) / deviation
        expected = covariance / np.outer(deviation, deviation)
        few = 1.0 / math.sqrt(len(drawn))
        assert np.abs(away.mean(axis=0)).max() < 4.0 * few
        assert np.abs(np.cov(away.T) - expected).max() < 6.0 * few


@pytest.mark.parametrize("task", TASKS)
def test_between_rows_a_drawn_person_lies_between_those_of_both(task: str) -> None:
    given, person = gaussians(posture_rows(), task), drawn_person(7)
    for low, high in zip(given.knots, given.knots[1:], strict=False):
        ends = [np.array([*given.mean(eta, person).values()]) for eta in (low, high)]
        between = np.array([*given.mean(0.75 * low + 0.25 * high, person).values()])
        assert between == pytest.approx(0.75 * ends[0] + 0.25 * ends[1])


def test_a_sample_is_always_the_same_person_and_sample_zero_the_mean() -> None:
    assert drawn_person(3) == drawn_person(3) != drawn_person(4)
    assert drawn_person(0) == MEAN_PERSON
    assert gaussians(posture_rows(), "hold").mean(0.6) == gaussians(posture_rows(), "hold").mean(
        0.6, MEAN_PERSON
    )
