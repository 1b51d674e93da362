"""Runs written by every format version so far; they stay readable for ever and are never written anew."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from evodesign.analysis.audit import audit
from evodesign.analysis.front import front
from evodesign.evolve import replay, resume
from evodesign.records import FORMAT_VERSION
from evodesign.runlog.reader import read_segment
from evodesign.runlog.rewrite import merge, recover
from evodesign.runlog.run import RunLog, digest, read_run
from evodesign.runlog.session_log import Silent
from tests.cli.here import evodesign
from tests.runlog.toys import OrderedPool, ToyTask, shuffled

pytestmark = pytest.mark.slow

FOLDER = Path(__file__).parent
VERSIONS = range(1, FORMAT_VERSION + 1)
DIGEST = "0f0f30b2b942b4a73f189ccebe3fd05e92fdbd5821fa3e5a7fa29c8acdb4268b"
"""Of the same search in every format."""

LIFTING = FOLDER / "lifting"
LIFTING_DIGEST = "b54f105def3043c833e7e53f7dc77237624016cccfd71dfa0f014f11a03c6e65"


@pytest.fixture(params=VERSIONS)
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture
def run(version: int) -> RunLog:
    return read_run(FOLDER / f"format-{version}")


def test_each_format_version_has_its_golden_run() -> None:
    for folder in (FOLDER, LIFTING):
        names = sorted(path.name for path in folder.glob("format-*"))
        assert names == [f"format-{each}" for each in VERSIONS]


def test_a_golden_run_reads_as_it_was_written(version: int, run: RunLog) -> None:
    assert (run.complete, run.damaged, run.notes) == (True, False, ())
    assert run.header.format_version == version
    assert run.header.problem.text == 'name = "töy"'
    assert (run.header.search.algorithm, run.header.search.seed, run.header.budget) == ("nsga2", 6, 20)
    assert digest(run.evaluations) == DIGEST
    assert len(run.details) == 13
    assert run.fronts[-1].evaluations == (5, 7, 8, 11, 14, 16)
    assert run.generations[-1].best == {
        "robot_torque": 31.072132111957128,
        "reach_height": 1.8871265001806943,
    }
    assert run.generations[-1].hypervolume == 7.0209446981054695


def test_a_golden_run_agrees_with_itself(run: RunLog) -> None:
    assert audit(run) == []
    known = front(run.header.objectives, run.evaluations[:18])
    assert tuple(each.number for each in known) == run.fronts[-1].evaluations


def test_a_golden_run_can_be_merged_and_recovered(version: int, run: RunLog, tmp_path: Path) -> None:
    shutil.copytree(FOLDER / f"format-{version}", tmp_path / "run")
    recovered = recover(tmp_path / "run", tmp_path / "recovered")
    merged = merge(tmp_path / "run", None)
    for again in (recovered, merged):
        assert again.header.format_version == FORMAT_VERSION
        assert again.evaluations == run.evaluations
        assert again.fronts == run.fronts
        assert again.generations == run.generations
        assert again.details == run.details


@pytest.fixture
def lifting(version: int, tmp_path: Path) -> Path:
    """A copy of the golden run of real robots: two people, a disturbance, and who carries how much."""
    return Path(shutil.copytree(LIFTING / f"format-{version}", tmp_path / "run"))


def output(*arguments: object) -> str:
    done = evodesign(*arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_run_may_go_on_in_this_format(version: int, tmp_path: Path) -> None:
    """Its segments are of two formats then, and it equals one that never stopped."""
    for part in (1, 2):
        place = tmp_path / f"{part}"
        shutil.copytree(FOLDER / f"format-{version}", place)
        if part == 1:
            (place / "001.mcap").unlink()
        resume(place, ToyTask, OrderedPool(shuffled(5)), Silent(), 26)
    short, long = (read_run(tmp_path / f"{part}") for part in (1, 2))
    assert digest(short.evaluations) == digest(long.evaluations)
    assert digest(long.evaluations[:20]) == DIGEST
    assert (long.header.format_version, audit(long), long.notes) == (FORMAT_VERSION, [], ())
    assert [each.format_version for each in read_segment(tmp_path / "2/000.mcap").headers] == [version]
    replay(long)
    assert merge(tmp_path / "2", None).evaluations == long.evaluations


def test_every_command_reads_a_golden_run(lifting: Path, tmp_path: Path) -> None:
    front_of = json.loads(output("front", lifting, "--json", "--where", "robot_torque@tall@1 < 9"))
    assert [design["id"] for design in front_of["designs"]] == [4, 2, 1]
    shown = json.loads(output("show", lifting, 4, "--json"))
    assert shown["parameters"]["allocation.effort_ratio"] == pytest.approx(0.02553, abs=1e-5)
    assert [(each["human_name"], each["height_m"]) for each in shown["postures"]] == [
        (name, height) for name in ("short", "tall") for height in (0.8, 1.0)
    ]
    assert {*shown["postures"][0]} == {"height_m", "agents", "human_name", "disturbed"}
    assert {*shown["heights"][0]["disturbed"]} == {"heavier"}
    assert "tall, 1 m" in output("show", lifting, 4)
    output("report", lifting, "--output", tmp_path / "report.html")
    output("export", lifting, 4, "--to", tmp_path / "exported")
    assert json.loads((tmp_path / "exported/postures.json").read_text())["postures"] == shown["postures"]
    other = Path(shutil.copytree(lifting, tmp_path / "other"))
    assert "hypervolumes after 5 evaluations" in output("compare", lifting, other)
    assert "generation 0: 3/5 evaluations" in output("watch", lifting)
    summary = json.loads(output("verify", lifting, "--json"))
    assert (summary["digest"], summary["sound"]) == (LIFTING_DIGEST, True)
    output("recover", lifting, "--to", tmp_path / "recovered")
    output("branch", lifting, "--branch-from", 1, "--run", tmp_path / "branched", "--evaluations", 3)
    assert json.loads(output("merge", other, "--json"))["digest"] == LIFTING_DIGEST


def test_a_golden_run_of_real_robots_is_resumed(lifting: Path) -> None:
    output("resume", lifting, "--evaluations", 6, "--jobs", 1, "--accept-versions")
    run = read_run(lifting)
    assert len(run.evaluations) == 6
    assert digest(run.evaluations[:5]) == LIFTING_DIGEST
    assert {outcome.case.label for outcome in run.evaluations[5].assessment.cases} == {"short", "tall"}
    assert json.loads(output("verify", lifting, "--json"))["sound"]
