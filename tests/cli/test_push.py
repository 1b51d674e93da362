"""`evodesign push` and `simulate --push` on the golden run: figures, film, and what they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from evodesign.cli.main import app
from evodesign.errors import InputError
from tests.cli.films import assert_filmed_or_refused

RUN = str(Path(__file__).parents[1] / "golden" / "lifting" / "format-2")
HOLD = ("--height", "0.8", "--person", "tall")


def run(command: str, *options: str) -> None:
    app([command, RUN, "1", *options], standalone_mode=False)


def test_a_push_of_the_margin_is_survived_and_one_beyond_it_is_not(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("evodesign.simulation.push_margin.RESOLUTION", 0.3)
    run("push", *HOLD, "--direction", "90", "--frequency", "8", "--spread", "--json")
    told = json.loads(capsys.readouterr().out)
    (margin,) = told["margins"]
    assert len(told["spread_n_s"]) == 3
    assert all(margin["margin_n_s"] + change >= 0.0 for change in told["spread_n_s"].values())
    assert (margin["moment"], margin["direction_deg"]) == ("tall, 0.8 m", 90.0)
    assert told["push_margin_n_s"] == margin["margin_n_s"] > 1.0
    ends = []
    for share in (1.0, 1.5):
        run("simulate", *HOLD, "--push", f"{share * margin['margin_n_s']}", "--direction", "90", "--json")
        (pushed,) = json.loads(capsys.readouterr().out)["pushes"]
        ends.append((pushed["survived"], pushed["reason"]))
    assert ends[0] == (True, "")
    assert not ends[1][0]
    assert ends[1][1]


@pytest.mark.slow
def test_a_push_is_filmed_or_a_sentence_says_that_mujoco_cannot_draw(tmp_path: Path) -> None:
    """Which of both it is, the machine decides."""
    film = tmp_path / "push.gif"
    assert_filmed_or_refused(lambda: run("simulate", *HOLD, "--push", "2", "--video", str(film)), film)


@pytest.mark.parametrize(
    ("command", "options", "words"),
    [
        ("push", ("--height", "0.7"), "--height"),
        ("push", ("--person", "nobody"), "--person: wanted one of .*tall"),
        ("push", ("--damping", "0"), "damping"),
        ("simulate", ("--push", "0"), "--push: wanted a positive number"),
        ("simulate", ("--push", "nan"), "--push: wanted a positive number"),
        ("simulate", ("--engine", "drake"), "--engine: wanted mujoco.*found drake"),
    ],
)
def test_what_there_is_not_is_refused(command: str, options: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        run(command, *options)


@pytest.mark.parametrize(
    ("options", "extra", "missing"), [((), "control", "daqp"), (("--engine", "drake"), "drake", "pydrake")]
)
def test_without_what_it_needs_a_sentence_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], extra: str, missing: str
) -> None:
    monkeypatch.setattr("evodesign.simulation.installed.find_spec", lambda name: name != missing or None)
    with pytest.raises(InputError, match=rf"pip install 'evodesign\[{extra}\]'.*'{missing}'"):
        run("push", *options)


@pytest.mark.needs_drake
def test_a_push_in_drake_is_asked_for_by_name_and_not_filmed(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    pushed = ("simulate", *HOLD, "--engine", "drake", "--direction", "90", "--push")
    for impulse, survived in (("2", True), ("200", False)):
        run(*pushed, impulse, "--json")
        told = json.loads(capsys.readouterr().out)
        assert told["engine"] == "drake"
        assert told["pushes"][0]["survived"] is survived
    with pytest.raises(InputError, match="--video: wanted a push in MuJoCo"):
        run(*pushed, "2", "--video", str(tmp_path / "film.gif"))
