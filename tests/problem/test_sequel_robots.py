"""The sequel's robots as they are built here, against the masses in the URDFs of its published code."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.designs import read_designs
from evodesign.problem.source import read_source
from evodesign.reproduction.claims2023 import FAILED, LOGGED

UNSCALED_KG = {"root_link": 2.67135, "torso_1": 1.81255, "torso_2": 1.45349, "chest": 5.75757}
"""Masses in model_modified_NL.urdf, which are those of the unscaled robot."""

GA_KG = {
    "root_link": 0.75337,
    "chest": 5.75757,
    "r_upper_arm": 1.19304,
    "r_forearm": 1.24490,
    "r_hip_3": 4.99794,
    "r_lower_leg": 2.99413,
}
"""Masses in model_modified_GA.urdf, but of torso 1 and 2, which it scales across the chain."""


@pytest.fixture(scope="module")
def sequel(repository: Path) -> DesignProblem:
    return build_problem(read_source(repository / "problems" / "sartore2023.toml"))


@pytest.fixture(scope="module")
def designs(sequel: DesignProblem, repository: Path) -> dict[str, tuple[float, ...]]:
    text = (repository / "populations" / "sartore2023_robots.toml").read_text(encoding="utf-8")
    return read_designs(text, "robots", sequel.space, sequel.scene.robot.tree)


def masses(sequel: DesignProblem, values: tuple[float, ...]) -> dict[str, float]:
    tree = sequel.space.resized(sequel.scene.robot.tree, list(values))
    return {link.name: float(link.inertia.mass) for link in tree.links}


def test_nl_keeps_the_masses_of_the_unscaled_robot(
    sequel: DesignProblem, designs: dict[str, tuple[float, ...]]
) -> None:
    unscaled, nl = (masses(sequel, designs[name]) for name in ("unscaled", "nl"))
    assert {name: nl[name] for name in UNSCALED_KG} == pytest.approx(UNSCALED_KG, rel=1e-4)
    assert nl == pytest.approx(unscaled, rel=1e-4)


def test_ga_has_the_masses_of_its_urdf(sequel: DesignProblem, designs: dict[str, tuple[float, ...]]) -> None:
    built = masses(sequel, designs["ga"])
    assert {name: built[name] for name in GA_KG} == pytest.approx(GA_KG, rel=2e-4)


def test_every_logged_design_lies_within_the_bounds_of_the_search(
    sequel: DesignProblem, designs: dict[str, tuple[float, ...]]
) -> None:
    assert set(designs) == {"unscaled", "nl", "ga", *LOGGED, *FAILED}
    for name in ("unscaled", "ga", *LOGGED, *FAILED):
        assert all(0.0 <= coordinate <= 1.0 for coordinate in sequel.space.genome(designs[name])), name
