"""The fault campaign in short; `make faults` runs it in full."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from evodesign.runlog.run import RunLog, read_run
from tests.faults.campaign import TRIALS, Campaign, summary
from tests.faults.command_kills import COMMANDS, kill_command
from tests.faults.damage import cut, flip, write_log
from tests.faults.kills import ROOT, kill_search, kill_workers
from tests.faults.synthetic import Size
from tests.faults.trials import KINDS, Outcome


@pytest.mark.parametrize("asynchronous", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_killed_search_loses_nothing_reported_and_goes_on_as_if_never_killed(
    asynchronous: bool, tmp_path: Path
) -> None:
    size = Size(96, 0.004, 2, asynchronous=asynchronous)
    tally = kill_search(tmp_path / "run", 4, size, 3, random.Random(5))
    assert tally.kills.total() == 4
    assert tally.kills["writing"] > 0, "at least one kill came in the middle"
    assert tally.reported > 16


@pytest.mark.slow
def test_a_killed_worker_changes_nothing(tmp_path: Path) -> None:
    tally = kill_workers(tmp_path / "run", 2, Size(160, 0.01, 2), 3, random.Random(3))
    assert tally.kills.total() == 2


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name == "report" else pytest.mark.slow) for name in COMMANDS],
)
def test_a_killed_command_leaves_the_old_or_the_new_and_its_next_call_tidies_up(
    name: str, tmp_path: Path
) -> None:
    assert kill_command(tmp_path, 2, name, 3, random.Random(2)).kills.total() == 2


@pytest.mark.slow
def test_a_campaign_goes_on_where_it_was_killed(tmp_path: Path) -> None:
    """Of the line of a trial that a kill cut off nothing is believed; the trial is carried out again."""
    done = Outcome(1, 0, "search", {"search, writing": 7}, 8, 96, 1.0)
    lines = json.dumps(done_fields(done)) + "\n" + json.dumps(done_fields(done)).replace("0", "1")[:40]
    (tmp_path / TRIALS).write_text(lines)
    campaign = Campaign(tmp_path, 1, 1000)
    assert (campaign.counted, list(campaign.outcomes)) == (7, [0])
    assert Campaign(tmp_path, 2, 1000).counted == 0, "the trials of another seed are others"
    assert (tmp_path / TRIALS).read_text().count("\n") == 1
    assert "7 kills in 1 trials of 8 processes, 96 evaluations reported; 0 findings" in summary(
        campaign.outcomes.values()
    )
    enough = [sys.executable, "-m", "tests.faults.campaign", "--folder", str(tmp_path), "--kills", "7"]
    said = subprocess.run(
        [*enough, "--flips", "2", "--cuts", "2"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    assert f"the campaign lies in {tmp_path}; 7 kills so far" in said
    assert "trial 1" not in said


def done_fields(outcome: Outcome) -> dict[str, object]:
    return {name: getattr(outcome, name) for name in outcome.__struct_fields__}


def test_every_pool_and_search_is_killed_with_and_without_generations() -> None:
    sizes = {kind.size for kind in KINDS if kind.what == "search" and kind.size is not None}
    assert len(sizes) == 3 * 3 * 2
    assert {kind.what for kind in KINDS} >= {
        "search",
        "workers",
        "report",
        "front",
        "merge",
        "recover",
        "branch",
    }


def test_the_campaign_notices_what_is_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A search that loses what it has reported is a finding."""

    def losing(directory: Path) -> RunLog:
        run = read_run(directory)
        return replace(run, evaluations=run.evaluations[:-1])

    monkeypatch.setattr("tests.faults.kills.read_run", losing)
    with pytest.raises(AssertionError, match="lost or changed"):
        kill_search(tmp_path / "run", 1, Size(32, 0.0, 1, "serial"), 3, random.Random(5))


def test_a_log_cut_anywhere_gives_what_stood_before(tmp_path: Path) -> None:
    content = write_log(tmp_path, 48)
    assert cut(tmp_path, content, range(0, len(content), 211)).most_lost == 48
    tail = range(len(content) - 3000, len(content), 7)
    assert cut(tmp_path, content, tail).logs == len(tail)


def test_a_changed_byte_costs_one_evaluation_or_all_behind_it_and_is_noticed(tmp_path: Path) -> None:
    content = write_log(tmp_path, 48)
    report = flip(tmp_path, content, 120, seed=7)
    assert 0 < report.unharmed < report.logs
