"""`compare`: every number that it prints is the log's, and every name is text."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.front import front
from evodesign.analysis.hypervolume import hypervolume
from evodesign.cli.compare import compare
from evodesign.errors import InputError
from evodesign.runlog.writer import RunWriter
from tests.runlog.toys import toy_evaluations, toy_header

NAME = "<script>[red]\x1b"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Five seeds of two searches, an empty run, and one with other objectives."""
    place = tmp_path_factory.mktemp("runs")
    made = [
        logged(place / f"{algorithm}-{seed}", seed, algorithm, 20)
        for algorithm in ("nsga2", "random")
        for seed in range(5)
    ]
    return [*made, logged(place / "empty", 9, "nsga2", 0), logged(place / "other", 1, "nsga2", 8, 1)]


def logged(directory: Path, seed: int, algorithm: str, count: int, objectives: int = 2) -> Path:
    header = toy_header(seed=seed + 10 * len(algorithm))
    header = msgspec.structs.replace(
        header,
        problem_name=NAME if objectives == 2 else "other",
        objectives=header.objectives[:objectives],
        search=msgspec.structs.replace(header.search, algorithm=algorithm, seed=seed, objectives=objectives),
    )
    names = {objective.name for objective in header.objectives}
    evaluations = toy_evaluations(toy_header(seed=seed + 10 * len(algorithm)), count)
    with RunWriter(directory, header) as writer:
        for evaluation in evaluations:
            found = evaluation.assessment.objectives
            values = {name: value for name, value in found.items() if name in names}
            assessment = msgspec.structs.replace(evaluation.assessment, objectives=values)
            writer.write(msgspec.structs.replace(evaluation, assessment=assessment))
    return directory


def test_json_holds_the_log_s_numbers(runs: list[Path], capsys: pytest.CaptureFixture[str]) -> None:
    compare(runs[:10], json=True, plot=None)
    (found,) = json.loads(capsys.readouterr().out)["comparisons"]
    header = toy_header()
    for place, each in enumerate(found["runs"]):
        seed, length = place % 5, len("nsga2" if place < 5 else "random")
        evaluations = toy_evaluations(toy_header(seed=seed + 10 * length), 20)
        assert each["seed"] == seed
        assert each["hypervolume"] == hypervolume(header.objectives, evaluations, found["reference"])
        assert each["front"] == len(front(header.objectives, evaluations))
        assert each["curve"]["hypervolume"][-1] == each["hypervolume"]
    assert found["tests"][0]["p"] is not None
    assert len(found["attainment"]) == 2


def test_tables_show_searches_runs_tests_and_best_designs(
    runs: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    compare(runs[:10], json=False, plot=None)
    shown = capsys.readouterr().out
    for words in ("Searches", "Runs", "Rank tests", "Mann-Whitney", "Best designs", "random-4"):
        assert words in shown


def test_empty_runs_and_other_objectives_are_explained(
    runs: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    compare([runs[0], runs[5], runs[10], runs[11]], json=False, plot=tmp_path / "figure.html")
    shown = capsys.readouterr().out
    assert "others cannot be compared with them" in shown
    assert "holds no evaluation and is left out" in shown
    assert "hypervolumes after 20 evaluations" in shown
    assert (tmp_path / "figure.html").stat().st_size > 1_000_000


def test_names_are_shown_as_text(
    runs: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figure = tmp_path / "figure.html"
    compare([runs[0], runs[1], runs[11]], json=False, plot=figure)
    shown = capsys.readouterr().out
    assert "\x1b" not in shown
    compare([runs[0], runs[11], runs[5]], json=False, plot=figure)
    page = figure.read_text()
    assert "<script>[red]" not in page


@pytest.mark.parametrize(
    ("chosen", "words"), [([0], "wanted two runs or more, found 1"), ([0, 0], "wanted each run once")]
)
def test_less_than_two_runs_are_refused(runs: list[Path], chosen: list[int], words: str) -> None:
    with pytest.raises(InputError, match=words):
        compare([runs[place] for place in chosen], json=False, plot=None)


def test_figure_that_cannot_be_written_is_named(runs: list[Path], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--plot: wanted a file that can be written"):
        compare(runs[:2], json=False, plot=tmp_path / "none" / "figure.html")


def test_runs_whose_directories_have_one_name_are_told_apart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    places = [Path(name) / "run" for name in ("ours", "theirs")]
    for seed, place in enumerate(places):
        place.parent.mkdir()
        logged(place, seed, "nsga2", 8)
    compare(places, json=False, plot=None)
    shown = capsys.readouterr().out
    runs, best = shown.split("Best designs of all runs")
    for table in (runs, best):
        assert {str(place) for place in places} & set(table.replace("│", " ").split())
    assert all(str(place) in runs for place in places)
