"""A search from Python is the search of the command line."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

import evodesign
from evodesign.errors import InputError, Interrupted, RunError
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.copied import copy_source
from evodesign.problem.schema import SCHEMA_FILE
from evodesign.problem.source import read_source
from evodesign.records import Generation
from evodesign.runlog.directory import segments

pytestmark = pytest.mark.slow

POPULATION, BUDGET, SEED = 4, 12, 3
SIZES: dict[str, Any] = {"population": POPULATION, "evaluations": BUDGET, "seed": SEED}
COMMAND = [sys.executable, "-m", "evodesign"]
TIMES = re.compile(rb'"(seconds|gradient_seconds|started|worker)":("[^"]*"|[^,}]*)')


def logged(run: Path) -> list[tuple[str, bytes]]:
    """Topic and bytes of every message, but for times and names of workers."""
    found = []
    for segment in segments(run).values():
        with segment.open("rb") as file:
            for _, channel, message in make_reader(file).iter_messages(log_time_order=False):
                found.append((channel.topic, TIMES.sub(rb'"\1":0', message.data)))
    return found


@pytest.fixture(scope="module", autouse=True)
def prepared(known: Precomputed) -> None:
    assert known.postures, "worked out before, so that no search has to"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[evodesign.Run, list[Any]]:
    """A run, and everything that its callback heard."""
    heard: list[Any] = []
    place = tmp_path_factory.mktemp("python") / "run"
    run = evodesign.search("point-grasp", place, **SIZES, pool="serial", callback=heard.append)
    return run, heard


def test_a_run_from_python_is_that_of_the_command_line(
    whole: tuple[evodesign.Run, list[Any]], tmp_path: Path
) -> None:
    sizes = ["--population", f"{POPULATION}", "--evaluations", f"{BUDGET}", "--seed", f"{SEED}"]
    command = [*COMMAND, "search", "point-grasp", "--run", str(tmp_path / "run"), *sizes, "--jobs", "1"]
    subprocess.run(command, capture_output=True, check=True, timeout=300)
    assert logged(tmp_path / "run") == logged(whole[0].log.directory)


def test_the_callback_hears_of_every_design_and_generation(
    whole: tuple[evodesign.Run, list[Any]],
) -> None:
    run, heard = whole
    assert len(run) == BUDGET
    designs = [each for each in heard if isinstance(each, evodesign.Design)]
    assert [each.number for each in designs] == list(range(BUDGET))
    assert [each.assessment for each in designs] == [each.assessment for each in run.designs]
    assert [each for each in heard if isinstance(each, Generation)] == list(run.log.generations)
    assert len(heard) == BUDGET + BUDGET // POPULATION


@pytest.mark.parametrize("first", ["python", pytest.param("command line", marks=pytest.mark.slow)])
def test_either_goes_on_where_the_other_stopped(
    first: str, whole: tuple[evodesign.Run, list[Any]], tmp_path: Path
) -> None:
    place = tmp_path / "run"
    if first == "python":
        evodesign.search("point-grasp", place, population=POPULATION, evaluations=6, seed=SEED, pool="serial")
        command = [*COMMAND, "resume", str(place), "--evaluations", f"{BUDGET}", "--jobs", "1"]
        subprocess.run(command, capture_output=True, check=True, timeout=300)
        run = evodesign.open_run(place)
    else:
        sizes = ["--population", f"{POPULATION}", "--evaluations", "6", "--seed", f"{SEED}", "--jobs", "1"]
        command = [*COMMAND, "search", "point-grasp", "--run", str(place), *sizes]
        subprocess.run(command, capture_output=True, check=True, timeout=300)
        run = evodesign.resume(place, evaluations=BUDGET, pool="serial")
    assert [each.assessment for each in run.designs] == [each.assessment for each in whole[0].designs]
    assert run.log.generations[-1].hypervolume == whole[0].log.generations[-1].hypervolume


def test_an_interrupt_leaves_a_run_that_can_be_resumed(
    whole: tuple[evodesign.Run, list[Any]], tmp_path: Path
) -> None:
    """As the stop button of a notebook raises it, at any moment."""
    heard: list[Any] = []

    def stop_at_the_sixth(event: object) -> None:
        heard.append(event)
        if len(heard) == 6:
            raise KeyboardInterrupt

    place = tmp_path / "run"
    with pytest.raises(Interrupted, match="evodesign resume"):
        evodesign.search("point-grasp", place, **SIZES, pool="serial", callback=stop_at_the_sixth)
    stopped = evodesign.open_run(place)
    assert 4 <= len(stopped) < BUDGET
    run = evodesign.resume(stopped, jobs=2)
    assert [each.assessment for each in run.designs] == [each.assessment for each in whole[0].designs]


def test_an_interrupt_whose_error_a_library_drops_ends_the_search_all_the_same(tmp_path: Path) -> None:
    usual, heard = signal.getsignal(signal.SIGINT), list[Any]()

    def drops_errors(event: object) -> None:
        heard.append(event)
        if len(heard) == 3:
            with suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)

    place = tmp_path / "run"
    with pytest.raises(Interrupted, match="evodesign resume"):
        evodesign.search("point-grasp", place, **SIZES, pool="serial", callback=drops_errors)
    assert 3 <= len(evodesign.open_run(place)) < BUDGET
    assert signal.getsignal(signal.SIGINT) is usual


@pytest.mark.slow
def test_an_error_of_the_callback_is_its_own_and_the_run_stays(tmp_path: Path) -> None:
    def wrong(event: object) -> None:
        raise ZeroDivisionError("of the callback")

    with pytest.raises(ZeroDivisionError, match="of the callback"):
        evodesign.search("point-grasp", tmp_path / "run", **SIZES, pool="serial", callback=wrong)
    assert len(evodesign.open_run(tmp_path / "run")) == 1


def test_a_session_whose_time_is_over_gives_the_run_as_it_is(tmp_path: Path) -> None:
    run = evodesign.search("point-grasp", tmp_path / "run", **SIZES, hours=1e-9, pool="serial")
    assert len(run) < BUDGET
    assert len(evodesign.resume(run, hours=0.0, pool="serial", evaluations=4)) == 4


@pytest.mark.slow
def test_progress_is_a_line_per_generation_on_standard_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sizes = SIZES | {"evaluations": 8}
    evodesign.search("point-grasp", tmp_path / "run", **sizes, pool="serial", progress=True)
    printed = capsys.readouterr()
    lines = printed.err.splitlines()
    assert lines[0] == "point-grasp: surrogate, population 4, seed 3, 8 evaluations"
    assert [line.split(",")[0] for line in lines[1:]] == [
        "generation 0: 4/8 evaluations",
        "generation 1: 8/8 evaluations",
    ]
    assert printed.out == ""


def test_a_problem_of_dictionaries_is_that_of_the_file(
    whole: tuple[evodesign.Run, list[Any]], repository: Path, tmp_path: Path
) -> None:
    """Numbers come through to the last bit, NumPy's and paths as well."""
    tables = tomllib.loads((repository / "problems" / "point_grasp.toml").read_text())
    tables["design"]["length"][0]["upper"] = np.float64(tables["design"]["length"][0]["upper"])
    tables["task"]["heights_m"] = np.array(tables["task"]["heights_m"])
    tables["search"]["seed"] = np.int64(SEED)
    tables["robot"]["urdf"] = Path(tables["robot"]["urdf"])
    problem = evodesign.Problem.from_dict(tables, tmp_path)
    run = evodesign.search(problem, tmp_path / "run", population=POPULATION, evaluations=4, pool="serial")
    assert [each.assessment for each in run.designs] == [each.assessment for each in whole[0].designs[:4]]


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"name": None}, "the problem given"),
        ({"name": object()}, "the problem given: wanted values that TOML has, found a value of type object"),
        ({"name": "x"}, "the problem given: payload: wanted this key, found nothing"),
        ({"name": "x", "robot": {"urdf": "no.urdf"}}, "the problem given: payload: wanted this key"),
    ],
)
def test_wrong_dictionaries_are_refused_in_a_sentence(tables: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        evodesign.Problem.from_dict(tables)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"evaluations": 0}, "evaluations: wanted a number from 1, found 0"),
        ({"population": 1}, "population: wanted a number from 2, found 1"),
        ({"jobs": 0}, "jobs: wanted a number from 1, found 0"),
        ({"hours": float("nan")}, "hours: wanted a number from 0, found nan"),
        ({"seed": -1}, "seed: wanted a number from 0"),
        ({"algorithm": "nsga4"}, "did you mean 'nsga2'"),
        ({"pool": "jobli"}, "did you mean 'joblib'"),
    ],
)
def test_wrong_settings_are_refused_before_anything_is_made(
    wrong: dict[str, Any], words: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=words):
        evodesign.search("point-grasp", tmp_path / "run", **(SIZES | wrong))
    assert not (tmp_path / "run").exists()


def test_a_run_is_not_begun_over_another(whole: tuple[evodesign.Run, list[Any]]) -> None:
    with pytest.raises(RunError, match="holds a run already"):
        evodesign.search("point-grasp", whole[0].log.directory, **SIZES)


def test_the_front_is_plotted_and_a_design_exported(
    whole: tuple[evodesign.Run, list[Any]], tmp_path: Path
) -> None:
    run, _ = whole
    assert "point-grasp" in run.plot_front(tmp_path / "front.html").read_text()
    with pytest.raises(InputError, match="a file that can be written"):
        run.plot_front(tmp_path / "nowhere" / "front.html")
    best = run.front[0]
    written = {path.name for path in best.export(tmp_path / "best")}
    assert {"robot.urdf", "postures.json", "replay.mcap"} <= written
    command = [*COMMAND, "export", str(run.log.directory), f"{best.number}", "--to", str(tmp_path / "same")]
    subprocess.run(command, capture_output=True, check=True, timeout=300)
    for name in written:
        assert (tmp_path / "best" / name).read_bytes() == (tmp_path / "same" / name).read_bytes()
    with pytest.raises(InputError, match="a new or empty folder"):
        best.export(tmp_path / "best")


@pytest.mark.slow
def test_a_design_evaluated_outside_of_a_run_is_exported_too(tmp_path: Path) -> None:
    design = evodesign.open_problem("point-grasp").evaluate({"length.upper_arm": 1.1})
    written = {path.name for path in design.export(tmp_path / "design")}
    assert {"robot.urdf", "human.urdf", "postures.json"} <= written


def test_shipped_problems_are_known_by_name_and_can_be_copied(repository: Path, tmp_path: Path) -> None:
    names = evodesign.problems()
    files = {tomllib.loads(path.read_text())["name"] for path in (repository / "problems").glob("*.toml")}
    assert set(names) == files
    assert all(sentence.endswith(".") for sentence in names.values())
    with pytest.raises(InputError, match="did you mean 'icub-lifting'"):
        evodesign.open_problem("icub-liftin")
    for name in names:
        copied = copy_source(read_source(name), tmp_path / name)
        copy, shipped = evodesign.open_problem(copied[0]), evodesign.open_problem(name)
        assert (copy.parameters, copy.tasks) == (shipped.parameters, shipped.tasks)
        assert {tmp_path / name / file for file in copy.source.files} == set(copied[1:-1])
        assert copied[-1].name == SCHEMA_FILE


def test_problems_are_listed_on_the_command_line() -> None:
    listed = subprocess.run([*COMMAND, "problems"], capture_output=True, text=True, check=True).stdout
    told = " ".join(listed.split())
    for name, sentence in evodesign.problems().items():
        assert f"{name} {sentence}" in told


def test_a_problem_is_copied_on_the_command_line_into_a_new_folder_only(tmp_path: Path) -> None:
    command = [*COMMAND, "problems", "sartore2022", "--to", str(tmp_path / "own")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert evodesign.open_problem(done.stdout.splitlines()[0]).name == "sartore2022"
    again = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (again.returncode, again.stderr.count("\n")) == (2, 1)
    assert "wanted a new folder" in again.stderr
