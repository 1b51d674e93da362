"""The main job on real input: a search over the real robot, person and load, through the command line."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import pytest
from mcap.reader import make_reader

from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.records import Evaluation
from evodesign.runlog.run import read_run
from evodesign.runlog.writer import RunWriter
from tests.cli.here import evodesign

pytestmark = pytest.mark.slow

POPULATION, BUDGET, ENDLESS = 4, 12, 4000
COMMAND = [sys.executable, "-c", "from evodesign.__main__ import main; main()"]


def arguments(repository: Path, run: Path, *more: str) -> list[str]:
    problem = repository / "problems" / "point_grasp.toml"
    sizes = ["--population", str(POPULATION), "--evaluations", str(BUDGET), "--seed", "3"]
    return [*COMMAND, "search", str(problem), "--run", str(run), *sizes, *more]


def finish(command: list[str]) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return done


def remembered(run: Path) -> list[bytes]:
    """Every evaluation as JSON, without times and workers."""
    return [bare(evaluation) for evaluation in read_run(run).evaluations]


def bare(evaluation: Evaluation) -> bytes:
    bare = msgspec.structs.replace(evaluation, seconds=0.0, worker="", gradient_seconds=0.0)
    return msgspec.json.encode(bare)


@pytest.fixture(scope="module")
def whole(
    repository: Path, known: Precomputed, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, str, str]:
    """An uninterrupted run on two workers, with what it printed."""
    assert known.postures, "worked out before, so that no search has to"
    run = tmp_path_factory.mktemp("runs") / "whole"
    done = finish(arguments(repository, run, "--jobs", "2"))
    return run, done.stdout, done.stderr


def test_search_prints_its_front_and_where_the_run_lies(whole: tuple[Path, str, str]) -> None:
    run, stdout, stderr = whole
    assert str(run) in stdout
    assert "robot_torque" in stdout
    assert f"evodesign report {run}\n" in stdout
    assert stderr.count("note: no [collisions]: bodies may pass through each other") == 1
    lines = [line for line in stderr.splitlines() if line.startswith("generation ")]
    assert len(lines) == BUDGET // POPULATION
    assert "hypervolume" in lines[-1]
    assert f"{BUDGET}/{BUDGET} evaluations" in lines[-1]


@pytest.mark.parametrize("workers", [("--pool", "serial"), ("--pool", "joblib", "--jobs", "1")])
def test_evaluations_do_not_depend_on_the_workers(
    workers: tuple[str, ...], whole: tuple[Path, str, str], repository: Path, tmp_path: Path
) -> None:
    finish(arguments(repository, tmp_path / "other", *workers))
    assert remembered(tmp_path / "other") == remembered(whole[0])


@pytest.mark.parametrize(("stop", "code"), [(signal.SIGKILL, -9), (signal.SIGINT, 3), (signal.SIGTERM, 3)])
def test_stopped_search_is_resumed_as_if_nothing_had_happened(
    stop: signal.Signals, code: int, whole: tuple[Path, str, str], repository: Path, tmp_path: Path
) -> None:
    run = tmp_path / "stopped"
    command = arguments(repository, run, "--jobs", "2", "--evaluations", str(ENDLESS))
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    for line in process.stderr:
        if line.startswith("generation 1"):
            break
    time.sleep(0.2)
    os.kill(process.pid, stop)
    _, errors = process.communicate(timeout=300)
    assert process.returncode == code
    if code == 3:
        assert f"evodesign resume {run}" in errors
        assert "Traceback" not in errors
    known = remembered(run)
    assert known[: 2 * POPULATION] == remembered(whole[0])[: 2 * POPULATION], "whole generations are kept"
    assert len(known) < ENDLESS
    generations = -(-max(BUDGET, len(known)) // POPULATION)
    finish([*COMMAND, "resume", str(run), "--evaluations", str(generations * POPULATION), "--pool", "serial"])
    assert set(known) <= set(remembered(run)), "what had arrived is kept, in whatever order it came"
    assert remembered(run)[:BUDGET] == remembered(whole[0])


def test_larger_budget_continues_the_same_search(
    whole: tuple[Path, str, str], repository: Path, tmp_path: Path
) -> None:
    run = tmp_path / "short"
    finish([*arguments(repository, run, "--pool", "serial"), "--evaluations", "10"])
    finish([*COMMAND, "resume", str(run), "--evaluations", str(BUDGET), "--pool", "serial"])
    assert remembered(run) == remembered(whole[0])


def test_a_branch_begins_with_the_past_and_is_verified_like_any_run(
    whole: tuple[Path, str, str], tmp_path: Path
) -> None:
    branch = ["--branch-from", "2", "--run", str(tmp_path / "branch"), "--seed", "8", "--evaluations", "14"]
    done = finish([*COMMAND, "branch", str(whole[0]), *branch, "--pool", "serial"])
    assert "8 evaluations taken over" in done.stderr
    new = remembered(tmp_path / "branch")
    assert len(new) == 14
    assert new[:8] == remembered(whole[0])[:8]
    assert not set(new[8:]) & set(remembered(whole[0]))
    found = json.loads(evodesign("verify", tmp_path / "branch", "--json").stdout)
    assert (found["sound"], found["evaluations"], found["segments"]) == (True, 14, 2)


def test_a_run_of_other_versions_is_refused_unless_accepted(
    whole: tuple[Path, str, str], tmp_path: Path
) -> None:
    old = read_run(whole[0])
    versions = old.header.versions | {"pymoo": "0.5.0"}
    with RunWriter(tmp_path / "old", msgspec.structs.replace(old.header, versions=versions)) as log:
        for evaluation in old.evaluations:
            log.write(evaluation)
    command = [*COMMAND, "resume", str(tmp_path / "old"), "--pool", "serial"]
    refused = subprocess.run(command, capture_output=True, text=True, check=False)
    assert refused.returncode == 2
    assert "was written with pymoo 0.5.0 (now " in refused.stderr
    assert "--accept-versions" in refused.stderr
    finish([*command, "--accept-versions"])
    assert remembered(tmp_path / "old") == remembered(whole[0])


def test_plain_mcap_reader_reads_the_finished_run(whole: tuple[Path, str, str]) -> None:
    topics: dict[str, int] = {}
    with (whole[0] / "000.mcap").open("rb") as stream:
        for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            assert schema is not None
            assert schema.encoding == "jsonschema"
            content = json.loads(message.data)
            assert set(json.loads(schema.data)) & {"$ref", "properties"}
            assert isinstance(content, dict)
            topics[channel.topic] = topics.get(channel.topic, 0) + 1
    generations = BUDGET // POPULATION
    details = len(read_run(whole[0]).details)
    assert 0 < details <= BUDGET
    assert topics.pop("/detail") == details
    assert topics == {"/run": 1, "/evaluation": BUDGET, "/generation": generations, "/front": generations}


def test_run_cut_anywhere_gives_what_had_arrived_before_the_cut(
    whole: tuple[Path, str, str], tmp_path: Path
) -> None:
    log = (whole[0] / "000.mcap").read_bytes()
    expected = remembered(whole[0])
    lengths = []
    header = len(log) // 3  # the problem and the robot's URDF come first
    for cut in [*range(header, len(log), max(1, len(log) // 150)), *range(len(log) - 40, len(log))]:
        (tmp_path / "000.mcap").write_bytes(log[:cut])
        found = remembered(tmp_path)
        assert set(found) <= set(expected)
        lengths.append(len(found))
    assert lengths == sorted(lengths)
    assert lengths[-1] == BUDGET


def test_front_as_json_holds_its_designs(whole: tuple[Path, str, str], tmp_path: Path) -> None:
    plot = tmp_path / "front.html"
    found = json.loads(evodesign("front", whole[0], "--json", "--plot", plot).stdout)
    assert found["objectives"] == ["robot_torque", "human_torque", "reach_height"]
    logged = {evaluation.number: evaluation for evaluation in read_run(whole[0]).evaluations}
    for design in found["designs"]:
        assert design["objectives"] == logged[design["id"]].assessment.objectives
        assert design["parameters"] == logged[design["id"]].assessment.design
    assert "Plotly" in plot.read_text()


@pytest.mark.usefixtures("known")
def test_evaluate_answers_in_full(repository: Path) -> None:
    problem = repository / "problems" / "point_grasp.toml"
    found = json.loads(finish([*COMMAND, "evaluate", str(problem), "--json"]).stdout)
    assert found["reach"]["highest_m"] == pytest.approx(1.38, abs=0.01)
    assert [height["status"] for height in found["heights"]] == ["solved"] * 3
    for height in found["heights"]:
        assert len(height["robot"]["torques"]) == 25
        assert len(height["human"]["torques"]) == 33
        contacts = [
            f"{agent}.{side}_{part}"
            for agent in ("robot", "human")
            for part in ("hand", "foot")
            for side in ("left", "right")
        ]
        assert sorted(height["wrenches"]) == sorted(contacts)
        assert all(len(wrench) == 6 for wrench in height["wrenches"].values())
        assert height["solver"]["iterations"] > 0
        assert max(height["residuals"].values()) < 1e-5


def test_check_shows_what_each_parameter_changes(repository: Path) -> None:
    problem = repository / "problems" / "point_grasp.toml"
    found = json.loads(evodesign("check", problem, "--json").stdout)
    assert len(found["parameters"]) == 16
    shank = next(p for p in found["parameters"] if p["name"] == "length.shank")
    assert [link["link"] for link in shank["links"]] == ["l_lower_leg", "r_lower_leg"]
    assert shank["links"][0]["axis"] == pytest.approx([0.0, 0.0, -1.0])
