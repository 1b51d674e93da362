"""`evodesign simulate` on the golden run: picks, JSON, recording, film, and what it refuses."""

from __future__ import annotations

import json
from importlib import util
from pathlib import Path
from typing import Any

import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from mcap.reader import make_reader

from evodesign.cli.main import app
from evodesign.errors import InputError
from tests.cli.films import assert_filmed_or_refused

RUN = str(Path(__file__).parents[1] / "golden" / "lifting" / "format-2")
SHORT = ("--height", "0.8", "--person", "tall", "--seconds", "0.3")


def simulated(*options: str) -> None:
    app(["simulate", RUN, "1", *options], standalone_mode=False)


@pytest.mark.slow
def test_a_hold_is_told_in_si_units_and_recorded_with_its_own_times(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = tmp_path / "hold.mcap"
    simulated(*SHORT, "--json", "--mcap", str(recording))
    told = json.loads(capsys.readouterr().out)
    (hold,) = told["simulations"]
    assert (hold["case"], hold["person"], hold["seconds"], hold["stands"]) == (
        "tall, 0.8 m",
        "tall",
        0.3,
        True,
    )
    assert hold["drift_m"] < 1e-3
    assert {agent["fell"] for agent in hold["agents"].values()} == {False}
    with recording.open("rb") as stream:
        found = list(make_reader(stream).iter_messages(topics=["/tf"]))
    assert [message.log_time for _, _, message in found] == [20_000_000 * count for count in range(16)]
    frames: Any = FrameTransforms.FromString(found[-1][2].data)
    load = next(each for each in frames.transforms if each.child_frame_id == "load")
    assert load.translation.z == pytest.approx(0.8, abs=1e-3)


@pytest.mark.slow
def test_a_film_is_drawn_or_a_sentence_says_that_mujoco_cannot_draw(tmp_path: Path) -> None:
    """Which of both it is, the machine decides."""
    film = tmp_path / "hold.gif"
    assert_filmed_or_refused(lambda: simulated(*SHORT, "--video", str(film)), film)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--height", "0.7"), "--height"),
        (("--person", "nobody"), "--person: wanted one of .*tall"),
        (("--payload", "feather"), "--payload"),
        (("--from", "0.8"), "both --from and --to"),
        (("--seconds", "-1"), "a positive number"),
        (("--frequency", "0"), "frequency"),
        (("--damping", "0"), "damping"),
    ],
)
def test_what_there_is_not_is_refused(options: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        simulated(*options)


def test_without_mujoco_a_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("evodesign.simulation.installed.find_spec", lambda name: None)
    assert util.find_spec("mujoco") is not None
    with pytest.raises(InputError, match=r"pip install 'evodesign\[simulate\]'"):
        simulated()
