"""A robot in MJCF goes where one in URDF does, and what is read of it needs neither MuJoCo nor its files."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import msgspec
import pytest

from evodesign.mechanics.balance import GRAVITY
from evodesign.problem.build import build_problem
from evodesign.problem.copied import copy_source
from evodesign.problem.meshes import is_kept_name
from evodesign.problem.reread import reread
from evodesign.problem.source import read_source
from evodesign.tree.mjcf_write import mjcf_text
from evodesign.tree.urdf_write import urdf_text
from tests.cli.test_init import run
from tests.guess.humanoid import Build, humanoid
from tests.tree.small_mjcf import ROBOT, write_small_mjcf

MESH = """
  <geom type="mesh" mesh="plate" contype="0" conaffinity="0"/></body>
  </worldbody><asset><mesh name="plate" file="plate.obj"/></asset>"""
PLATE = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """A humanoid of boxes in both forms, that in MJCF with a mesh on its root."""
    folder = tmp_path / "models"
    folder.mkdir()
    tree = humanoid(Build())
    (folder / "robot.urdf").write_text(urdf_text(tree))
    text = mjcf_text(tree, GRAVITY, {}).partition("?>")[2]
    (folder / "robot.xml").write_text(MESH.join(text.rsplit("</body>\n  </worldbody>", 1)))
    (folder / "plate.obj").write_text(PLATE)
    return folder / "robot.xml"


def guessed(robot: Path, to: Path) -> str:
    """The problem of a robot, but for its first lines, which name the file and the rule of inertia.

    Walls, which that rule decides on, are left out too: a robot with a mesh keeps its file's masses.
    """
    assert run("init", robot, "--to", to) == 0
    text = to.read_text().partition("hands = ")[2]
    before, *walls = re.split(
        r"^#(?=\[\[design\.wall\]\]| no \[\[design\.wall\]\])", text, flags=re.MULTILINE
    )
    assert len(walls) == 1
    return before + walls[0].partition("\n#\n")[2]


@pytest.mark.slow
def test_the_same_problem_is_guessed_from_either_form(robot: Path, tmp_path: Path) -> None:
    of_mjcf, of_urdf = (
        guessed(robot.with_suffix(suffix), tmp_path / f"{suffix[1:]}.toml") for suffix in (".xml", ".urdf")
    )
    assert of_mjcf == of_urdf
    assert run("check", tmp_path / "xml.toml") == 0


def test_what_a_problem_keeps_needs_neither_mujoco_nor_the_files_of_the_robot(
    robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    guessed(robot, tmp_path / "mine.toml")
    source = read_source(tmp_path / "mine.toml")
    copied, *_ = copy_source(source, tmp_path / "copy")
    monkeypatch.chdir(tmp_path)
    assert reread(source, Path()) == source, "the MJCF is not followed again"
    shutil.rmtree(robot.parent)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    tree = build_problem(msgspec.structs.replace(source, path="nowhere/p.toml")).scene.robot.tree
    assert [mesh.surface is not None for mesh in tree.link_by_name[tree.root].meshes] == [True]
    assert any(map(is_kept_name, source.files))
    assert read_source(copied).files == source.files


def test_without_mujoco_a_sentence_names_the_extra(
    robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    guessed(robot, tmp_path / "mine.toml")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    for arguments in (("check", tmp_path / "mine.toml"), ("init", robot, "--to", tmp_path / "other.toml")):
        capsys.readouterr()
        assert run(*arguments) == 2
        said = " ".join(capsys.readouterr().err.split())
        assert "wanted a URDF, or MuJoCo, which reads MJCF: pip install 'evodesign[mjcf]'" in said


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (ROBOT.replace("arm.xml", "nowhere.xml"), "Error opening file 'nowhere.xml'"),
        (ROBOT.replace('name="spin" axis="0 0 1"', 'name="spin" type="ball"'), "found a ball joint"),
        (ROBOT[:-20], "wanted an MJCF file that MuJoCo compiles, found XML parse error"),
        (ROBOT, "small: wanted two legs"),
    ],
    ids=["include", "ball", "syntax", "no legs"],
)
def test_a_file_that_is_no_humanoid_ends_with_a_sentence(
    spoilt: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write_small_mjcf(tmp_path)
    file.write_text(spoilt)
    assert run("init", file, "--to", tmp_path / "new.toml") == 2
    error = capsys.readouterr().err
    assert words in " ".join(error.split())
    assert "Traceback" not in error
    assert not (tmp_path / "new.toml").exists()
