"""Bad input ends with one clear sentence and exit code 2, without a traceback."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from evodesign.problem.left_out import left_out
from evodesign.problem.source import read_source
from tests.cli.here import evodesign


def evodesign_alone(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """A command in a process of its own."""
    command = [sys.executable, "-c", "from evodesign.__main__ import main; main()", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture
def place(repository: Path, tmp_path: Path) -> Path:
    """A copy of the point-grasp problem with its robot and population, to be spoiled."""
    shutil.copytree(repository / "problems", tmp_path / "problems")
    shutil.copytree(repository / "populations", tmp_path / "populations")
    return tmp_path / "problems"


def spoil(place: Path, file: str, old: str, new: str) -> Path:
    """Replace a piece of a file once; the problem's path."""
    path = place / file
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    return place / "point_grasp.toml"


PROBLEM, ROBOT = "point_grasp.toml", "robots/icub_shapes.urdf"
TOLD = [
    f"note: {sentence}"
    for sentence in left_out(read_source(Path(__file__).parents[2] / "problems" / PROBLEM))
]
"""What is said of a problem that is read, before a fault is found in something else."""
PERSON = 'stature_m = 1.82\nmass_kg = 72.7\nsex = "male"'


def crowd(percentiles: str, sex: str = "both") -> str:
    """A population's key, in the place of one person's."""
    return f'population = {{ sex = "{sex}", percentiles = {percentiles} }}'


@pytest.mark.parametrize(
    ("file", "old", "new", "words"),
    [
        (PROBLEM, "[payload]", "[payload", ["point_grasp.toml", "valid TOML"]),
        (PROBLEM, "mass_kg = 5.0", "mas_kg = 5.0", ["payload.mas_kg", "did you mean 'mass_kg'?"]),
        (
            PROBLEM,
            '"l_upper_arm", "r_upper_arm"',
            '"l_uper_arm", "r_upper_arm"',
            ["design.length[0].links[0]", "'l_uper_arm'", "did you mean 'l_upper_arm'?"],
        ),
        (PROBLEM, "lower = 0.6", "lower = 2.6", ["design.length[0].lower", "less than upper (1.8)", "2.6"]),
        (PROBLEM, "mass_kg = 5.0", "mass_kg = -5.0", ["payload.mass_kg", "> 0", "-5.0"]),
        (PROBLEM, "[0.8, 1.0, 1.2]", '[0.8, "high", 1.2]', ["task.heights_m[1]", "a number", "'high'"]),
        (PROBLEM, "[0.8, 1.0, 1.2]", "[0.8, nan, 1.2]", ["task.heights_m[1]", "finite number", "nan"]),
        (PROBLEM, "[0.8, 1.0, 1.2]", "[]", ["task.heights_m", "[]"]),
        (PROBLEM, 'sex = "male"', 'sex = "robot"', ["human.sex", "'robot'"]),
        (PROBLEM, "stature_m = 1.82", "stature_m = 3.82", ["human.stature_m", "3.82"]),
        (PROBLEM, "mass_kg = 72.7", "mass_kg = 7.27", ["human.mass_kg", "from 40 to 140", "7.27"]),
        (PROBLEM, PERSON, crowd("[]"), ["human.population.percentiles", "at least one percentile"]),
        (PROBLEM, PERSON, crowd("[50, 99.9]"), ["human.population.percentiles[1]", "from 5 to 95", "99.9"]),
        (PROBLEM, PERSON, crowd("[5, 5]"), ["human.population.percentiles[1]", "each percentile once"]),
        (PROBLEM, PERSON, crowd("[50]", "all"), ["human.population.sex", "'all'"]),
        (PROBLEM, "sex = ", f"{crowd('[50]')}\nsex = ", ["human.stature_m", "population", "both"]),
        (
            PROBLEM,
            "[human]",
            "[human]\nstrengths_n_m = { jLeftKne_roty = [200.0, 100.0] }",
            ["human.strengths_n_m", "moving joint", "did you mean 'jLeftKnee_roty'?"],
        ),
        (PROBLEM, '"reach_height"', '"reach_hight"', ["objectives.maximise[0]", "did you mean"]),
        (PROBLEM, "icub_shapes.urdf", "icub.urdf", ["robot.urdf", "an existing file"]),
        (PROBLEM, "[task]", "[task]\nrobot_share = 0.7", ["task.robot_share", "point grasps", "0.5", "0.7"]),
        (PROBLEM, "[task]", "[task]\nrobot_share = 1.7", ["task.robot_share", "<= 1.0", "1.7"]),
        (PROBLEM, 'name = "point-grasp"', "", ["name", "this key", "nothing"]),
        (
            PROBLEM,
            "lower_kg_per_m3 = 500.0\nupper_kg_per_m3 = 4000.0",
            'materials = ["steel_4340", "aluminum_6061"]',
            ["design.density[0].materials[1]", "did you mean 'aluminium_6061'?"],
        ),
        (
            PROBLEM,
            "[human]",
            "[robot.torque_limits_n_m]\nl_kne = 50.0\n[human]",
            ["robot.torque_limits_n_m", "did you mean 'l_knee'?"],
        ),
        (PROBLEM, '"surrogate"', '"surogate"', ["algorithm", "did you mean 'surrogate'?"]),
        (
            PROBLEM,
            "[payload]",
            '[[payload]]\nsize_m = [0.4, 0.5, 0.3]\nmass_kg = 9.0\ngrasp = "rigid"\n[[payload]]',
            ["payload[1].grasp", "'rigid', the grasp of the first load", "found 'point'"],
        ),
        ("../populations/icub.toml", "shank = 1.6", "shank = 9.6", ["icub.toml", "long_legs", "9.6"]),
        ("../populations/icub.toml", "shank = 1.6", "shnk = 1.6", ["icub.toml", "did you mean 'shank'?"]),
        (ROBOT, "<robot", "robot", ["icub_shapes.urdf", "XML"]),
        (ROBOT, "</robot>", '<link name="loose"/></robot>', ["icub_shapes.urdf", "one root", "loose"]),
        (ROBOT, '"l_hand_frame"', '"l_grasp"', ["icub_shapes.urdf", "l_hand_frame"]),
    ],
)
def test_spoiled_files_are_explained(file: str, old: str, new: str, words: list[str], place: Path) -> None:
    problem = spoil(place, file, old, new)
    done = evodesign("search", problem, "--run", place / "run", "--evaluations", "1")
    assert_explained(done, words)
    assert not (place / "run").exists(), "nothing may be begun"


def test_hand_frame_missing_from_the_urdf_names_key_and_nearest(place: Path) -> None:
    path = place / ROBOT
    path.write_text(path.read_text().replace("l_hand_frame", "l_hand_grasp"))
    words = ["robot.hands.left", "icub_shapes", "'l_hand_frame'", "did you mean"]
    for command in (evodesign, evodesign_alone):
        assert_explained(command("check", place / PROBLEM), words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (lambda p: ("search", p / "missing.toml"), ["missing.toml", "an existing file"]),
        (lambda p: ("evaluate", p / "missing.toml"), ["missing.toml", "an existing file"]),
        (lambda p: ("search", p / PROBLEM, "--run", p), ["problems", "000.mcap cannot be read", "--run"]),
        (lambda p: ("resume", p / "robots"), ["robots", "is not a run"]),
        (lambda p: ("resume", p / "nowhere"), ["nowhere", "no such run"]),
        (lambda p: ("front", p / PROBLEM), [PROBLEM, "found a file"]),
        (lambda p: ("search", p / PROBLEM, "--pool", "jobib"), ["--pool", "did you mean 'joblib'?"]),
        (lambda p: ("evaluate", p / PROBLEM, "--design", p / "no.toml"), ["--design", "no.toml"]),
        (lambda p: ("evaluate", p / PROBLEM, "--name", "tall"), ["--name", "--design"]),
    ],
)
def test_bad_arguments_are_explained(
    arguments: Callable[[Path], tuple[str | Path, ...]], words: list[str], place: Path
) -> None:
    (place / "000.mcap").write_bytes(b"")
    assert_explained(evodesign(*arguments(place)), words)


def test_misspelt_option_is_exit_code_two() -> None:
    done = evodesign_alone("search", "x.toml", "--evaluation", "3")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def assert_explained(done: subprocess.CompletedProcess[str], words: list[str]) -> None:
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    *before, error, end = done.stderr.split("\n")
    assert end == ""
    assert before in ([], TOLD), "what the problem leaves out is told if it was read, and nothing else"
    assert error.startswith("error: ")
    for word in words:
        assert word in error
