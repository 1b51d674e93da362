"""What is left of a damaged run is shown with a note and exit code 4, never in silence."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.evolve import resume, start
from evodesign.problem.left_out import left_out
from evodesign.report.page import page_content
from evodesign.runlog.channels import DETAIL
from evodesign.runlog.reader import entries
from evodesign.runlog.run import read_run
from evodesign.runlog.session_log import Silent
from tests.cli.here import evodesign
from tests.faults.synthetic import synthetic_header
from tests.runlog import crafted
from tests.runlog.toys import OrderedPool, ToyTask, shuffled

MISSING = "note: missing evaluations: 24 to 47"


@pytest.fixture
def run(tmp_path: Path) -> Path:
    header = synthetic_header(budget=24, seed=4, population=12)
    start(tmp_path / "run", header, ToyTask(header), OrderedPool(shuffled(1)), Silent())
    for budget in (48, 60):
        resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), budget)
    return tmp_path / "run"


def test_a_front_without_a_removed_segment_ends_with_exit_code_four(run: Path) -> None:
    whole = evodesign("front", run, "--json")
    told = "".join(f"note: {sentence}\n" for sentence in left_out(read_run(run).header.problem))
    assert (whole.returncode, whole.stderr) == (0, told)
    (run / "001.mcap").unlink()
    done = evodesign("front", run, "--json")
    assert done.returncode == 4
    assert json.loads(done.stdout)["evaluations"] == 36
    assert "note: segment 1 of the run is missing\n" in done.stderr
    assert MISSING in done.stderr
    assert "exit code 4, or 0 with --damaged" in done.stderr
    accepted = evodesign("front", run, "--json", "--damaged")
    assert (accepted.returncode, accepted.stdout) == (0, done.stdout)
    assert MISSING in accepted.stderr


def test_a_comparison_with_a_damaged_run_ends_with_exit_code_four(run: Path, tmp_path: Path) -> None:
    other = shutil.copytree(run, tmp_path / "other")
    (run / "001.mcap").write_bytes(b"")
    done = evodesign("compare", other, run, "--json")
    assert done.returncode == 4
    assert "run: missing evaluations: 24 to 47" in done.stderr
    assert f"{other} is damaged" not in done.stderr
    assert json.loads(done.stdout)["comparisons"]
    assert evodesign("compare", other, run, "--damaged").returncode == 0


@pytest.mark.slow
def test_the_page_of_a_damaged_run_says_what_is_missing(run: Path, repository: Path, tmp_path: Path) -> None:
    """With the robots of a golden run, of which some bytes are changed."""
    golden = shutil.copytree(repository / "tests/golden/lifting/format-2", tmp_path / "golden")
    content = bytearray((golden / "000.mcap").read_bytes())
    content[content.index(b"zstd", content.index(b"zstd", 40) + 40) + 30] ^= 0x20
    (golden / "000.mcap").write_bytes(content)
    done = evodesign("report", golden, "--output", tmp_path / "page.html")
    assert done.returncode == 4, done.stderr
    assert "note: 000.mcap is damaged" in done.stderr
    assert page_content(read_run(golden), ()).notes[0].startswith("000.mcap is damaged")
    assert evodesign("report", golden, "--output", tmp_path / "page.html", "--damaged").returncode == 0
    shown = evodesign("show", golden, 4, "--json")
    assert (shown.returncode, json.loads(shown.stdout)["id"]) == (4, 4)
    assert evodesign("export", golden, 4, "--to", tmp_path / "design").returncode == 4
    assert (tmp_path / "design/postures.json").exists()
    assert evodesign("export", golden, 4, "--to", tmp_path / "again", "--damaged").returncode == 0


def test_a_run_whose_session_was_killed_is_not_damaged(run: Path) -> None:
    path = run / "002.mcap"
    path.write_bytes(path.read_bytes()[:-3000])
    done = evodesign("front", run)
    assert done.returncode == 0
    assert "its session was killed, or is still writing" in done.stderr


def test_verify_tells_each_gap_once(run: Path) -> None:
    (run / "001.mcap").unlink()
    done = evodesign("verify", run)
    assert done.returncode == 2
    assert done.stdout.count("missing evaluations: 24 to 47") == 1
    assert "segment 1 of the run is missing" in done.stdout


def with_other_postures(golden: Path, to: Path, change: Callable[[Any], None]) -> Path:
    """A copy of a golden run, with right checksums, in which every logged case is changed."""
    to.mkdir()
    parts = [crafted.channels()]
    for entry in entries(golden / "000.mcap"):
        value = msgspec.json.decode(msgspec.json.encode(entry.record))
        for case in value["cases"] if entry.topic == DETAIL else ():
            change(case)
        parts.append(crafted.told(entry.topic, value, entry.sequence))
    (to / "000.mcap").write_bytes(crafted.segment(map(crafted.chunk, parts)))
    return to


def with_a_stranger(case: Any) -> None:
    case["case"]["person"] = "nobody"


def with_strange_joints(case: Any) -> None:
    for agent in case["instants"][0]["agents"].values():
        agent |= {"joints_rad": {"tail": 0.0}, "torques_n_m": {"tail": 1.0}}


@pytest.mark.parametrize("change", [with_a_stranger, with_strange_joints])
def test_postures_that_are_not_of_the_runs_problem_are_refused_in_a_sentence(
    change: Callable[[Any], None], repository: Path, tmp_path: Path
) -> None:
    golden = repository / "tests/golden/lifting/format-2"
    run = with_other_postures(golden, tmp_path / "changed", change)
    done = evodesign("export", run, 4, "--to", tmp_path / "design")
    assert done.returncode == 2, done.stderr
    assert "are not those of the run's problem" in done.stderr
    assert "Traceback" not in done.stderr
    same = with_other_postures(golden, tmp_path / "same", lambda case: None)
    assert evodesign("export", same, 4, "--to", tmp_path / "other").returncode == 0


def test_a_card_of_a_person_that_the_problem_has_not_is_refused_in_a_sentence(
    repository: Path, tmp_path: Path
) -> None:
    golden = repository / "tests/golden/lifting/format-2"
    done = evodesign("show", with_other_postures(golden, tmp_path / "run", with_a_stranger), 4)
    assert done.returncode == 2, done.stderr
    assert "its problem has no person 'nobody'" in done.stderr
