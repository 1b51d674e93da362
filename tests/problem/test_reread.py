"""A session looks again at the files of its problem, but goes nowhere that a log from elsewhere sends it."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from evodesign.errors import InputError
from evodesign.problem.meshes import kept_name
from evodesign.problem.reread import reread
from evodesign.problem.shipped import SHIPPED
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource

SOURCE = ProblemSource(path="a/problem.toml", text="old", files={"../b/robot.urdf": "<old/>"})


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with the files of a problem, and a secret beside it."""
    (tmp_path / "secret.toml").write_text("secret")
    for name in ("here/a/problem.toml", "here/b/robot.urdf"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text("new")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def test_files_below_the_working_directory_are_read_again(here: Path) -> None:
    absolute = msgspec.structs.replace(SOURCE, path=str(here / "a/problem.toml"))
    for source in (SOURCE, absolute):
        now = reread(source, Path())
        assert (now.text, now.files) == ("new", {"../b/robot.urdf": "new"})
        assert now.path == source.path


def test_files_that_come_with_evodesign_are_read_again(here: Path) -> None:
    source = read_source(SHIPPED / "point_grasp.toml")
    assert reread(source, Path()) == source
    (here / "own.toml").write_text(source.text)
    robots = {name: content for name, content in source.files.items() if name.startswith("robots/")}
    own = msgspec.structs.replace(source, path="own.toml", files=robots)
    assert robots
    assert reread(own, Path()).files == robots


@pytest.mark.parametrize(
    "path", ["../secret.toml", "/etc/hostname", "a/../../secret.toml", "link.toml", "\0"]
)
@pytest.mark.parametrize("of_problem", [True, False])
def test_no_other_file_is_looked_at(path: str, of_problem: bool, here: Path) -> None:
    (here / "link.toml").symlink_to("../secret.toml")
    if of_problem:
        source = msgspec.structs.replace(SOURCE, path=path, files={})
    else:
        source = msgspec.structs.replace(
            SOURCE, path="a/problem.toml", files={f"../{path}" if path[0] != "/" else path: ""}
        )
    with pytest.raises(InputError):
        reread(source, Path())


def test_a_loop_of_links_is_refused(here: Path) -> None:
    (here / "loop.toml").symlink_to("loop.toml")
    with pytest.raises(InputError):
        reread(msgspec.structs.replace(SOURCE, path="loop.toml"), Path())


def test_kept_meshes_are_those_of_the_log(here: Path) -> None:
    kept = kept_name("package://a robot/visual.meshes/the arm.STL")
    source = msgspec.structs.replace(SOURCE, files={**SOURCE.files, kept: "triangles"})
    assert reread(source, Path()).files == {"../b/robot.urdf": "new", kept: "triangles"}
