"""`evodesign carry` on the golden run: figures, film, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from evodesign.cli.main import app
from evodesign.errors import InputError
from tests.cli.films import assert_filmed_or_refused

RUN = str(Path(__file__).parents[1] / "golden" / "lifting" / "format-2")
HOLD = ("--height", "0.8", "--person", "tall")


def run(*options: str) -> None:
    app(["carry", RUN, "1", *options], standalone_mode=False)


def test_a_walk_says_what_it_takes_and_why_a_robot_without_hip_roll_does_not_get_far(
    capsys: pytest.CaptureFixture[str],
) -> None:
    run(*HOLD, "--distance", "0.1", "--direction", "90", "--load", "3", "--json")
    (walk,) = json.loads(capsys.readouterr().out)["carries"]
    assert (walk["hold"], walk["load_kg"], walk["steps"]) == ("tall, 0.8 m", 3.0, 2)
    assert walk["walked"] is False
    assert walk["reason"].startswith("robot")
    assert 0.5 < walk["seconds"] < 4.0
    assert 0.0 < walk["tilt_deg"] < 5.0
    for agent in walk["agents"].values():
        assert agent["torque_n_m"] > 1.0
        assert agent["energy_j"] > 0.0
    assert walk["agents"]["robot"]["back_compression_n"] is None


@pytest.mark.slow
def test_a_walk_is_filmed_or_a_sentence_says_that_mujoco_cannot_draw(tmp_path: Path) -> None:
    """Which of both it is, the machine decides."""
    film = tmp_path / "carry.gif"
    assert_filmed_or_refused(lambda: run(*HOLD, "--distance", "0.05", "--video", str(film)), film)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--distance", "0"), "--distance: wanted a positive number"),
        (("--load", "-1"), "--load: wanted a positive number"),
        (("--height", "0.7"), "--height"),
        (("--damping", "0"), "damping"),
        (("--frequency", "0"), "frequency"),
        (("--payload", "no load"), "--payload"),
    ],
)
def test_what_there_is_not_is_refused(options: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        run(*options)
