from __future__ import annotations

import json
from pathlib import Path

import pytest

from evodesign.evolve import start
from evodesign.records import FORMAT_VERSION
from evodesign.runlog.session_log import Silent
from tests.cli.here import evodesign
from tests.faults.synthetic import synthetic_header
from tests.runlog.toys import OrderedPool, ToyTask, shuffled


@pytest.fixture
def run(tmp_path: Path) -> Path:
    header = synthetic_header(budget=40, seed=4, population=10)
    start(tmp_path / "run", header, ToyTask(header), OrderedPool(shuffled(1)), Silent())
    return tmp_path / "run"


def call(*arguments: str) -> tuple[int, str, str]:
    done = evodesign(*arguments)
    return done.returncode, done.stdout, done.stderr


def damage(run: Path) -> None:
    """Change bytes of two evaluations."""
    content = bytearray((run / "000.mcap").read_bytes())
    places = [at for at in range(len(content)) if content.startswith(b"zstd", at)]
    for place in (places[20], places[30]):
        content[place + 40] ^= 0x20
    (run / "000.mcap").write_bytes(content)


def test_a_sound_run_is_verified_with_its_digest(run: Path) -> None:
    code, out, errors = call("verify", str(run))
    assert (code, errors) == (0, "")
    assert "40 evaluations, 4 generations" in out
    assert "digest " in out
    found = json.loads(call("verify", str(run), "--json")[1])
    assert (found["sound"], found["faults"], found["format_version"]) == (True, [], FORMAT_VERSION)
    assert len(found["digest"]) == 64


def test_a_damaged_run_is_told_recovered_and_sound_again(run: Path, tmp_path: Path) -> None:
    damage(run)
    code, out, errors = call("verify", str(run))
    assert code == 2
    assert "000.mcap is damaged: " in out
    assert "cannot be read" in out
    assert "found" in errors
    assert "Traceback" not in errors
    code, out, _ = call("recover", str(run))
    assert code == 0
    assert "missing " in out
    assert f"go on with: evodesign resume {tmp_path / 'run-recovered'}" in out
    saved = json.loads(call("recover", str(run), "--to", str(tmp_path / "saved"), "--json")[1])
    assert saved["lost"]
    assert 37 < saved["evaluations"] <= 40
    code, _, errors = call("recover", str(run))
    assert code == 2
    assert "holds a run already" in errors


def test_segments_are_merged(run: Path, tmp_path: Path) -> None:
    code, out, _ = call("merge", str(run), "--to", str(tmp_path / "one.mcap"))
    assert code == 0
    assert "segments merged" in out
    code, _, errors = call("merge", str(run), "--to", str(tmp_path / "one.mcap"))
    assert code == 2
    assert "one.mcap: exists already" in errors
    assert json.loads(call("merge", str(run), "--json")[1])["segments"] == 1
    assert call("verify", str(run))[0] == 0


@pytest.mark.parametrize("command", ["verify", "recover", "merge"])
def test_what_is_no_run_is_refused_in_a_sentence(command: str, tmp_path: Path) -> None:
    code, _, errors = call(command, str(tmp_path / "missing"))
    assert code == 2
    assert errors == f"error: {tmp_path / 'missing'}: there is no such run directory\n"
