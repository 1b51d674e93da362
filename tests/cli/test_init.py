"""`init`: a problem file for a robot, that every other command takes as it stands."""

from __future__ import annotations

import io
import json
import re
import tomllib
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path

import pytest
import trimesh
from jsonschema import Draft202012Validator

from evodesign.cli.main import main
from evodesign.records import Status
from evodesign.runlog.run import read_run
from evodesign.tree.urdf_write import urdf_text
from tests.guess.humanoid import Build, humanoid
from tests.robots import HUMANOIDS, NO_HUMANOIDS, SHAPELESS

BUNDLED = sorted((Path(__file__).parents[2] / "problems" / "robots").glob("*.urdf"))
HELD = ("talos",)
"""Public humanoids that are evaluated as well; the G1 is searched."""

APART = "[collisions]  # nothing passes through anything\n"
QUICK = "\n[solver]\nstart_portfolio = false\ncompile = false\n"


def hurry(file: Path) -> None:
    """Fixed starts, and bodies that may overlap: both save minutes of preparation."""
    assert APART in file.read_text()
    file.write_text(file.read_text().replace(APART, "") + QUICK)


def run(*arguments: object) -> int:
    """Exit code of a command in this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["evodesign", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
    return int(left.value.code or 0)


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    file = tmp_path / "models" / "humanoid.urdf"
    file.parent.mkdir()
    file.write_text(urdf_text(humanoid(Build(yaw=3.141592653589793))))
    return file


@pytest.mark.slow
def test_a_new_robot_is_checked_and_evaluated_as_it_stands(
    robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "mine.toml"
    assert run("init", robot, "--to", file) == 0
    shown = capsys.readouterr().out
    for words in (
        "robot.facing",
        "-x",
        "knees and names of the sides and feet say so",
        f"evodesign check {file}",
    ):
        assert words in shown
    tables = tomllib.loads(file.read_text())
    assert tables["robot"]["urdf"] == "models/humanoid.urdf"
    assert tables["robot"]["facing"] == "-x"
    assert [group["name"] for group in tables["design"]["length"]] == [
        *("upper_arm", "forearm", "thigh", "shank", "trunk")
    ]
    assert run("check", file) == 0
    hurry(file)
    capsys.readouterr()
    assert run("evaluate", file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert {height["status"] for height in found["heights"]} == {"solved"}


@pytest.mark.parametrize("bundled", BUNDLED, ids=lambda path: path.stem)
def test_a_newcomers_bundled_robot_is_guessed_and_checked(
    bundled: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What `init` writes leaves nothing out, and every height is one that the robot and both people hold."""
    file = tmp_path / "mine.toml"
    assert run("init", bundled, "--to", file) == 0
    assert file.read_text().endswith("\n")
    assert "FILL IN" not in file.read_text()
    assert file.read_text().startswith("#:schema ./evodesign.schema.json\n")
    schema = json.loads((tmp_path / "evodesign.schema.json").read_text())
    assert [*Draft202012Validator(schema).iter_errors(tomllib.loads(file.read_text()))] == []
    capsys.readouterr()
    assert run("check", file, "--json") == 0
    shown = capsys.readouterr()
    for words in ("no [collisions]", "hand_moment_n_m", "joint_ranges"):
        assert words not in shown.err
    (held,) = (each for each in json.loads(shown.out)["preflight"] if each["item"] == "holds the load")
    lowest, highest = map(float, re.findall(r"from (\S+) to (\S+) m", held["found"])[0])
    heights = json.loads(shown.out)["heights_m"]
    assert lowest < min(heights) < max(heights) < highest


def test_the_file_is_named_after_the_robot_and_never_written_over(
    robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("init", robot) == 0
    written = (tmp_path / "humanoid.toml").read_text()
    assert run("init", robot) == 2
    assert "--to: wanted a new file, found 'humanoid.toml', which exists" in capsys.readouterr().err
    assert (tmp_path / "humanoid.toml").read_text() == written


def test_what_cannot_be_guessed_is_marked_and_named_by_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot, file = tmp_path / "walker.urdf", tmp_path / "walker.toml"
    robot.write_text(urdf_text(humanoid(Build(arms=False))))
    assert run("init", robot, "--to", file) == 0
    assert 'hands = { left = "FILL IN", right = "FILL IN" }  # FILL IN: no two arms' in file.read_text()
    assert "FILL IN" in capsys.readouterr().out
    assert run("check", file) == 2
    error = capsys.readouterr().err
    assert "robot.hands.left, robot.hands.right: wanted what could not be guessed" in error


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<robot", "wanted a URDF file, found text that is not XML"),
        (urdf_text(humanoid(Build(horse=True))), "wanted two legs, found four or more"),
        (
            re.sub(r"(?s)<inertial>.*?</inertial>", "", urdf_text(humanoid(Build()))),
            "humanoid: wanted links with masses, found none",
        ),
    ],
    ids=["no XML", "a horse", "no masses"],
)
def test_a_file_of_which_no_problem_can_be_made_is_refused_in_a_sentence(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robot.urdf").write_text(text)
    assert run("init", tmp_path / "robot.urdf", "--to", tmp_path / "new.toml") == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "new.toml").exists()


@pytest.mark.needs_robots
@pytest.mark.parametrize("name", NO_HUMANOIDS)
def test_what_is_no_humanoid_is_refused_in_a_sentence(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, words = NO_HUMANOIDS[name]
    assert run("init", file, "--to", tmp_path / "new.toml") == 2
    error = capsys.readouterr().err
    assert ": wanted two legs" in error
    assert words in error
    assert not (tmp_path / "new.toml").exists()


@pytest.mark.slow
@pytest.mark.needs_robots
@pytest.mark.usefixtures("few_designs_meet")
def test_a_public_robot_without_shapes_is_left_to_a_person_who_then_evaluates_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "new.toml"
    assert run("init", SHAPELESS, "--to", file) == 0
    assert "1.777 x 1.777 m is more than a third of the robot's 1.38 m" in " ".join(file.read_text().split())
    assert run("check", file) == 2
    assert "robot.soles.left, robot.soles.right, robot.soles.size_m: wanted" in capsys.readouterr().err
    lines = re.sub(
        "(?m)^soles = .*$",
        'soles = { left = "ls", right = "rs", size_m = [0.24, 0.1] }',
        re.sub("(?m)^heights_m = .*$", "heights_m = [0.9]", file.read_text()),
    )
    frames = (
        f'[[robot.frames]]\nname = "{side}s"\nlink = "{side}_ankle"\nxyz_m = [0.03, 0.0, -0.1]\n'
        for side in "lr"
    )
    file.write_text("\n".join((lines, *frames, QUICK)))
    assert run("check", file) == 0
    assert re.search(r"0 of \d+ links with a mass", capsys.readouterr().out)
    assert run("evaluate", file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert {height["status"] for height in found["heights"]} == {"solved"}


@pytest.fixture(scope="module")
def guessed(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The problem file that `init` writes for a public humanoid, once for all tests that begin with it."""
    folder = tmp_path_factory.mktemp("guessed")

    def written(name: str) -> Path:
        file = folder / f"{name}.toml"
        if not file.exists():
            with redirect_stdout(io.StringIO()) as shown:
                assert run("init", HUMANOIDS[name], "--to", file) == 0
            assert "evodesign check" in shown.getvalue()
            assert "FILL IN" not in file.read_text() + shown.getvalue()
            assert len(tomllib.loads(file.read_text())["design"]["length"]) == 5
        return file

    return written


@pytest.mark.slow
@pytest.mark.needs_robots
@pytest.mark.parametrize("name", [name for name in HUMANOIDS if name not in HELD])
def test_a_public_humanoid_is_guessed_whole(name: str, guessed: Callable[[str], Path]) -> None:
    assert run("check", guessed(name)) == 0


@pytest.mark.slow
@pytest.mark.needs_robots
@pytest.mark.parametrize("name", HELD)
def test_a_public_humanoid_is_checked_and_holds_the_load_without_editing(
    name: str, guessed: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    """The same with portfolios of starts, which take minutes, is measured in `benchmarks.public_robots`."""
    assert run("check", guessed(name)) == 0
    file = guessed(name).with_name(f"{name}_in_a_hurry.toml")
    file.write_text(guessed(name).read_text())
    hurry(file)
    capsys.readouterr()
    assert run("evaluate", file, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert {height["status"] for height in found["heights"]} == {"solved"}
    assert found["violation"] == 0.0


@pytest.mark.slow
@pytest.mark.needs_robots
def test_a_public_humanoid_is_searched_without_editing(
    guessed: Callable[[str], Path], tmp_path: Path
) -> None:
    file, folder = guessed("g1").with_name("g1_searched.toml"), tmp_path / "run"
    file.write_text(guessed("g1").read_text())
    hurry(file)
    sizes = ("--evaluations", 6, "--population", 3, "--jobs", 2)
    assert run("search", file, "--run", folder, *sizes) == 0
    assert run("verify", folder) == 0
    unscaled = read_run(folder).evaluations[0].assessment
    assert unscaled.violation == 0.0
    assert {case.status for case in unscaled.cases} == {Status.SOLVED}


@pytest.mark.parametrize("there", [True, False])
def test_soles_lie_under_the_meshes_of_the_feet_where_these_are_found(
    robot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], there: bool
) -> None:
    if there:
        trimesh.creation.box((0.2, 0.07, 0.04)).export(robot.parent / "foot.stl")
    links = re.split("(?=<link )", robot.read_text())
    shod = [re.sub("<box [^>]*>", '<mesh filename="foot.stl"/>', link) for link in links]
    robot.write_text(
        "".join(new if 'foot">' in link else link for link, new in zip(links, shod, strict=True))
    )
    assert run("init", robot, "--to", tmp_path / "mine.toml") == 0
    size = tomllib.loads((tmp_path / "mine.toml").read_text())["robot"]["soles"]["size_m"]
    assert (size == pytest.approx([0.2, 0.07], abs=1e-3)) is there
    assert ("wanted the mesh 'foot.stl'" in " ".join(capsys.readouterr().err.split())) is not there
    assert run("check", tmp_path / "mine.toml") == (0 if there else 2)
