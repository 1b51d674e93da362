"""What every command prints is whole on a terminal of 80 columns: no line is longer, no word is broken."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import re
import shutil
import struct
import subprocess
import sys
import termios
import tomllib
from collections import Counter
from io import StringIO
from pathlib import Path
from typing import Any, cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len
from rich.console import Console

from evodesign.cli import output
from evodesign.cli.main import COMMANDS, app
from evodesign.cli.tables.reproduction import (
    claims_table,
    reproduction_lines,
    robots_table,
    sequel_lines,
    stricter_table,
    torque_table,
)
from evodesign.cli.tables.table import names, numbers, titled
from evodesign.cli.tables.worst_cases import moment_tables
from evodesign.problem.build import DesignProblem
from evodesign.records import Status
from evodesign.report.scene_models import SceneModels
from evodesign.reproduction import claims2023
from evodesign.reproduction.claims2022 import human_claim, reach_claim, reduction_claim, table_claim
from evodesign.reproduction.codesign2023 import SequelReproduction
from evodesign.reproduction.files2022 import Found, Published, ReproducedRobot, Reproduction
from evodesign.runlog.run import read_run
from evodesign.runlog.writer import RunWriter
from tests.report.scenes import random_detail
from tests.report.several import problem_of_several, write_several
from tests.runlog.toys import toy_evaluations, toy_header

pytestmark = pytest.mark.slow

NARROW, WIDE = 80, 300
GOLDEN = Path(__file__).parents[1] / "golden"
SMALL_BASELINE = """
[solver]
symmetry = "on"
start_portfolio = false
compile = false
"""


class BothWidths:
    """A console that prints everything twice: for a terminal of 80 columns, and for a very wide one."""

    is_terminal = True

    def __init__(self) -> None:
        self._consoles = [Console(file=StringIO(), width=width) for width in (NARROW, WIDE)]

    def __call__(self, **_: object) -> BothWidths:
        return self

    def print(self, *parts: Any, **options: Any) -> None:
        for console in self._consoles:
            console.print(*parts, **options)

    @property
    def texts(self) -> tuple[str, str]:
        narrow, wide = (console.file.getvalue() for console in self._consoles)  # type: ignore[attr-defined]
        return narrow, wide


def words(text: str) -> set[str]:
    """What stands between spaces and the lines of tables."""
    return set(re.sub(r"[\u2500-\u257f]", " ", text).split())


def assert_whole(narrow: str, wide: str) -> None:
    assert words(narrow)
    assert [line for line in narrow.splitlines() if cell_len(line) > NARROW] == []
    assert "…" not in narrow
    assert words(narrow) - words(wide) == set()
    assert words(wide) - words(narrow) == set(), "nothing is left out"


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch) -> BothWidths:
    """Whatever is printed on a terminal, at both widths."""
    made = BothWidths()
    monkeypatch.setattr(output, "Console", made)
    return made


@pytest.fixture
def place(repository: Path, tmp_path: Path, run_with_people: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The golden runs, and small problems, in a directory in which commands name them in short."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(run_with_people, "peopled")
    for name in ("run", "other"):
        shutil.copytree(GOLDEN / "lifting" / "format-2", name)
    for name in ("toy", "toy-again"):
        shutil.copytree(GOLDEN / "format-2", name)
    header = toy_header(budget=60)
    with RunWriter(tmp_path / "many", header) as log:
        for evaluation in toy_evaluations(header, 60):
            log.write(evaluation)
    for folder in ("populations", "problems"):
        Path(folder).symlink_to(repository / folder)
    text = (GOLDEN / "lifting" / "problem.toml").read_text(encoding="utf-8")
    Path("small.toml").write_text(text.replace("../../../problems/", "problems/"), encoding="utf-8")
    shutil.copy(GOLDEN / "lifting" / "start.toml", "start.toml")
    shutil.copy(repository / "evodesign" / "validation" / "data" / "stoop_lifts.csv", "stoop.csv")
    text = (repository / "problems" / "sartore2022.toml").read_text(encoding="utf-8")
    text = text.replace("[0.8, 1.0, 1.2, 1.5]", "[1.0]").replace(
        "[baseline]\n", "[baseline]\niterations = 3\n"
    )
    text = text.replace('"robots/', '"problems/robots/').replace('"../populations/', '"populations/')
    Path("joint.toml").write_text(text + SMALL_BASELINE, encoding="utf-8")
    return tmp_path


THREE = ("--evaluations", 3)
ENDS = (
    *("--algorithm", "random", "--symmetry", "auto", "--stagnation-generations", 9),
    *("--least-growth-percent", 0.1, "--cache"),
)
QUICK = ("--jobs", "1", "--pool", "serial")
LINES: dict[str, tuple[tuple[object, ...], ...]] = {
    "search": (
        ("search", "small.toml", "--run", "new", *THREE, *QUICK),
        ("search", "small.toml", *THREE, *ENDS, *QUICK),
    ),
    "resume": (("resume", "run", *QUICK, "--accept-versions"),),
    "branch": (
        ("branch", "run", "--branch-from", 1, "--run", "new", "--algorithm", "random", *THREE, *QUICK),
    ),
    "front": (
        ("front", "run"),
        ("front", "toy", "--knee"),
        ("front", "peopled"),
        ("front", "run", "--where", "reach_height > 9"),
    ),
    "report": (("report", "run"),),
    "show": (("show", "run", 1), ("show", "peopled", 0)),
    "export": (("export", "run", 1, "--to", "exported"),),
    "watch": (("watch", "run", "--once"), ("watch", "toy", "--once")),
    "compare": (("compare", "run", "other"), ("compare", "toy", "toy-again", "run")),
    "matters": (("matters", "run"), ("matters", "many", "--design", 3)),
    "families": (("families", "run"), ("families", "many", "--by", "arm.0 + arm.1", "--cells", 5)),
    "spread": (("spread", "peopled"),),
    "evaluate": (("evaluate", "small.toml"),),
    "lift": (("lift", "small.toml", "--from", 0.9, "--to", 2.5, "--csv", "lift.csv"),),
    "simulate": (
        ("simulate", "run", 1, "--height", 0.8, "--seconds", 0.3, "--mcap", "hold.mcap"),
        ("simulate", "run", 1, "--from", 0.9, "--to", 2.5, "--knots", 8, "--profile", "free"),
    ),
    "push": (("push", "run", 1, "--height", 0.8, "--direction", 90, "--alone"),),
    "carry": (("carry", "run", 1, "--person", "tall", "--distance", 0.05),),
    "polish": (("polish", "run", 1, "--evaluations", 2),),
    "check": (
        ("check", "small.toml"),
        ("check", "problems/point_grasp.toml"),
        ("check", "problems/icub_materials.toml"),
        ("check", "problems/three_people_three_loads.toml"),
    ),
    "problems": (("problems",), ("problems", "point-grasp", "--to", "own")),
    "schema": (("schema", "--to", "schema.json"),),
    "init": (("init", "problems/robots/icub_shapes.urdf", "--to", "guessed.toml"),),
    "starts": (("starts", "small.toml"),),
    "validate": (("validate", "stoop.csv", "--stature", 1.73, "--mass", 81.68, "--sex", "male"),),
    "verify": (("verify", "run"),),
    "recover": (("recover", "run"),),
    "merge": (("merge", "toy"),),
    "baseline": (("baseline", "joint.toml", "--run", "new", "--starts", 2, *QUICK),),
}
"""Commands on small runs; the tables of `reproduce`, which takes minutes, have a test of their own."""


def test_every_command_is_looked_at() -> None:
    assert {*LINES, "reproduce"} == {*COMMANDS}


@pytest.mark.parametrize(
    "line", [line for lines in LINES.values() for line in lines], ids=lambda line: " ".join(map(str, line))
)
def test_what_a_command_prints_is_whole(line: tuple[object, ...], place: Path, both: BothWidths) -> None:
    app([*map(str, line)], standalone_mode=False)
    assert_whole(*both.texts)


def test_a_lift_as_json_says_for_every_person_how_it_ended(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    app(["lift", "small.toml", "--from", "0.9", "--to", "2.5", "--json"], standalone_mode=False)
    lifts = json.loads(capsys.readouterr().out)["lifts"]
    people = tomllib.loads(Path("small.toml").read_text(encoding="utf-8"))["human"]
    assert [each["person"] for each in lifts] == [person["name"] for person in people]
    assert {each["status"] for each in lifts} == {"infeasible"}, "nobody lifts it to 2.5 m"


def test_the_tables_of_a_reproduction_are_whole(place: Path, both: BothWidths) -> None:
    run = read_run(place / "run")
    number, models = max(detail.evaluation for detail in run.details), cast("SceneModels", None)
    cases = next(detail.cases for detail in run.details if detail.evaluation == number)
    robots = {
        name: ReproducedRobot(name, name, models, cases) for name in ("original", "gradient", "evolution")
    }
    norms = robots["original"].torque_norms
    done = Reproduction(
        published=Published(
            robots["original"], robots["gradient"], "joint limits", 1e-7, Counter({Status.SOLVED: 3})
        ),
        original=robots["original"],
        highest=1.3,
        found=tuple(Found(robots[name], run, 12.5, {}) for name in ("gradient", "evolution")),
        claims=(
            table_claim("published setting", norms, norms, "joint limits"),
            reach_claim("gradient", norms, norms),
            reduction_claim("evolution", norms, norms, 3.0, 7),
            human_claim("evolution", norms, norms),
        ),
        stricter={"and grips": {"original": norms, "evolution": norms}},
        measured={"original": norms, "evolution": norms},
    )
    output.console().print(torque_table(done))
    output.console().print(stricter_table(done))
    output.console().print(claims_table(done.claims))
    output.print_lines(*reproduction_lines(done, Path("runs/reproduce-20260101-120000"), 100.0))
    assert_whole(*both.texts)


def test_the_tables_of_the_sequels_reproduction_are_whole(place: Path, both: BothWidths) -> None:
    names = ("unscaled", "nl", "ga", *claims2023.LOGGED, *claims2023.FAILED, "search")
    robots = {
        name: claims2023.RobotFigures(name, 44.5 + number, 12.5, 10.6, 58.57, 1.379, 27, 27)
        for number, name in enumerate(names)
    }
    search = claims2023.SearchFigures(480, 4, 1.1, 2, 5, 17, 44.48, 48.2)
    claims = (
        *(claim(robots) for claim in (claims2023.log_claim, claims2023.order_claim)),
        claims2023.robot_claim(robots),
        claims2023.gain_claim(robots, search),
        claims2023.failure_claim(robots, search),
        claims2023.search_claim(search),
    )
    done = SequelReproduction(robots, robots, {}, {}, 477, read_run(place / "run"), search, claims)
    output.console().print(robots_table(done))
    output.console().print(claims_table(claims))
    output.print_lines(*sequel_lines(done, Path("runs/reproduce-20260101-120000"), 100.0))
    assert_whole(*both.texts)


def test_cards_of_several_people_and_loads_are_whole(
    problem: DesignProblem, place: Path, both: BothWidths
) -> None:
    write_several(problem_of_several(problem), place / "several")
    app(["show", "several", "1"], standalone_mode=False)
    assert_whole(*both.texts)


def test_tables_over_many_heights_go_on_below(problem: DesignProblem, both: BothWidths) -> None:
    heights = tuple(0.5 + 0.125 * number for number in range(12))
    cases = random_detail(problem, 1, heights).cases
    for table in moment_tables(cases):
        output.console().print(table)
    assert_whole(*both.texts)
    narrow, wide = both.texts
    assert (wide.count("┏"), narrow.count("agent") > 2) == (2, True)


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_is_whole_and_asked_for_in_two_ways(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    def printed(option: str, **settings: int) -> str:
        app([*command.split(), option], standalone_mode=False, **settings)
        return capsys.readouterr().out

    assert printed("-h") == printed("--help")
    assert_whole(printed("-h", terminal_width=NARROW), printed("-h", terminal_width=WIDE))


def test_a_terminal_says_how_wide_tables_are(place: Path) -> None:
    terminal, shell = pty.openpty()
    fcntl.ioctl(shell, termios.TIOCSWINSZ, struct.pack("4H", 24, NARROW, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "LINES")}
    environment |= {"TERM": "xterm", "NO_COLOR": "1", "PYTHONPATH": str(GOLDEN.parents[1])}
    command = [sys.executable, "-m", "evodesign", "front", "run"]
    done = subprocess.run(command, stdout=shell, stderr=subprocess.PIPE, env=environment, check=False)
    os.close(shell)
    assert done.returncode == 0, done.stderr
    shown = os.read(terminal, 100_000).decode()
    os.close(terminal)
    plain = re.sub(r"\x1b\[[0-9;]*m", "", shown)
    assert "worst_human_torque ┃" in plain
    assert max(map(cell_len, plain.splitlines())) <= NARROW


WORD = st.text("abcdefgh_.-", min_size=1, max_size=20)
TEXT = st.lists(WORD, max_size=6).map(" ".join)


@settings(max_examples=50)
@given(st.data())
def test_any_table_fits_and_loses_nothing(data: st.DataObject) -> None:
    """Of up to nine columns, with words of up to 20 letters and numbers of up to 12."""
    units = data.draw(st.lists(st.sampled_from(["", " [m]", " [N m] ↓"]), min_size=1, max_size=7))
    columns = [
        *names(data.draw(WORD), data.draw(TEXT)),
        *numbers(*(f"{data.draw(WORD)}{unit}" for unit in units)),
    ]
    table = titled(data.draw(TEXT), columns, keys=data.draw(st.integers(1, 2)), caption=data.draw(TEXT))
    number = st.floats(allow_nan=False, width=32).map("{:.4g}".format)
    for _ in range(data.draw(st.integers(1, 4))):
        table.add_row(data.draw(TEXT), data.draw(TEXT), *(data.draw(number) for _ in units))
    both = BothWidths()
    both.print(table)
    assert_whole(*both.texts)


def test_where_all_columns_find_room_a_header_is_one_line() -> None:
    table = titled("", [*names("case"), *numbers("mass [kg]")])
    table.add_row("a", "1")
    both = BothWidths()
    both.print(table)
    assert all("mass [kg]" in text for text in both.texts)


def test_a_table_without_rows_says_so() -> None:
    both = BothWidths()
    both.print(titled("parameters that changed", names("parameter")))
    assert both.texts[0] == "parameters that changed\nnone\n"


def test_a_word_longer_than_the_terminal_is_folded_as_the_last_resort() -> None:
    table = titled("", names("case", "name"))
    table.add_row("a", "x" * 200)
    both = BothWidths()
    both.print(table)
    narrow, _ = both.texts
    assert max(map(cell_len, narrow.splitlines())) <= NARROW
    assert narrow.count("x") == 200
