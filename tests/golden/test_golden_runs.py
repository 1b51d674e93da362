"""Runs written by every format version so far; they stay readable for ever and are never written anew."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from evodesign.analysis.audit import audit
from evodesign.analysis.front import front
from evodesign.records import FORMAT_VERSION
from evodesign.runlog.digest import digest
from evodesign.runlog.rewrite import merge, recover
from evodesign.runlog.run import Run, read_run

FOLDER = Path(__file__).parent
VERSIONS = range(1, FORMAT_VERSION + 1)
DIGESTS = {1: "3d28b759049a7d644eb245a457431ed2ddafc42aa96f35b067c96a6d180c1701"}


@pytest.fixture(params=VERSIONS)
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture
def run(version: int) -> Run:
    return read_run(FOLDER / f"format-{version}")


def test_each_format_version_has_its_golden_run() -> None:
    assert sorted(DIGESTS) == list(VERSIONS)
    assert sorted(path.name for path in FOLDER.glob("format-*")) == [f"format-{each}" for each in VERSIONS]


def test_a_golden_run_reads_as_it_was_written(version: int, run: Run) -> None:
    assert (run.complete, run.damaged, run.notes) == (True, False, ())
    assert run.header.format_version == version
    assert run.header.problem.text == 'name = "töy"'
    assert (run.header.search.algorithm, run.header.search.seed, run.header.budget) == ("nsga2", 6, 20)
    assert digest(run.evaluations) == DIGESTS[version]
    assert len(run.details) == 13
    assert run.fronts[-1].evaluations == (5, 7, 8, 11, 14, 16)
    assert run.generations[-1].best == {
        "robot_torque": 31.072132111957128,
        "reach_height": 1.8871265001806943,
    }
    assert run.generations[-1].hypervolume == 7.0209446981054695


def test_a_golden_run_agrees_with_itself(run: Run) -> None:
    assert audit(run) == []
    known = front(run.header.objectives, run.evaluations[:18])
    assert tuple(each.number for each in known) == run.fronts[-1].evaluations


def test_a_golden_run_can_be_merged_and_recovered(version: int, run: Run, tmp_path: Path) -> None:
    shutil.copytree(FOLDER / f"format-{version}", tmp_path / "run")
    recovered = recover(tmp_path / "run", tmp_path / "recovered")
    merged = merge(tmp_path / "run", None)
    for again in (recovered, merged):
        assert again.evaluations == run.evaluations
        assert again.fronts == run.fronts
        assert again.generations == run.generations
        assert again.details == run.details
