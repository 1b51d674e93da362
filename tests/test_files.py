"""A file is there whole or not at all, and what stood in its place stays until then."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

import pytest

from evodesign.errors import InputError
from evodesign.files import is_there, replacing, write_folder, write_whole
from evodesign.problem.source import read_source, source_of
from tests.faults.test_disk import small_disk


def names(directory: Path) -> list[str]:
    return [path.name for path in directory.iterdir()]


def test_a_file_is_replaced_and_keeps_its_rights(tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    path.write_text("old")
    path.chmod(0o640)
    write_whole(path, b"new")
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    assert names(tmp_path) == ["page.html"]


def test_a_new_file_has_the_rights_that_any_new_file_has(tmp_path: Path) -> None:
    write_whole(tmp_path / "one", b"")
    (tmp_path / "two").write_bytes(b"")
    assert (tmp_path / "one").stat().st_mode == (tmp_path / "two").stat().st_mode


def test_a_link_is_followed_and_a_device_written_to(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "far/file")
    write_whole(tmp_path / "link", b"x")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "far/file").read_bytes() == b"x"
    write_whole(Path(os.devnull), b"x")
    assert Path(os.devnull).is_char_device()


def test_a_name_of_the_greatest_length_is_no_obstacle(tmp_path: Path) -> None:
    write_whole(tmp_path / ("n" * 255), b"x")
    assert (tmp_path / ("n" * 255)).read_bytes() == b"x"


@pytest.mark.parametrize("stop", [KeyboardInterrupt, OSError, ValueError])
def test_what_is_broken_off_leaves_the_old_file_alone(stop: type[BaseException], tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    path.write_text("old")

    def broken_off() -> None:
        with replacing(path) as file:
            file.write(b"ne")
            raise stop

    with pytest.raises(stop):
        broken_off()
    assert path.read_text() == "old"
    assert names(tmp_path) == ["page.html"]


def test_a_full_disk_leaves_the_old_file_alone(tmp_path: Path) -> None:
    with small_disk(tmp_path, 32) as disk:
        write_whole(disk / "page", b"old")
        with pytest.raises(OSError, match=r"No space left|File too large"):
            write_whole(disk / "page", bytes(100_000))
        assert (disk / "page").read_bytes() == b"old"
        assert names(disk) == ["page"]


@pytest.mark.parametrize("there", [True, False])
def test_a_full_disk_leaves_nothing_of_a_folder(there: bool, tmp_path: Path) -> None:
    with small_disk(tmp_path, 32) as disk:
        if there:
            (disk / "a").mkdir()
        with pytest.raises(OSError, match=r"No space left|File too large"):
            write_folder(disk / "a/b", {"one": b"1", "c/two": b"2", "c/three": bytes(100_000)})
        assert [path.name for path in disk.rglob("*")] == (["a"] if there else [])


def test_a_folder_that_is_there_is_left_as_it_is_when_a_new_one_is_wanted(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(FileExistsError):
        write_folder(tmp_path, {"other": b"1"}, new=True)
    assert names(tmp_path) == ["file"]


def test_what_a_killed_process_left_of_a_file_goes_with_the_next_one(tmp_path: Path) -> None:
    left = tmp_path / f".evodesign-{'0' * 16}.part"
    left.write_bytes(b"half")
    (tmp_path / ".evodesign-mine.part").write_bytes(b"of another name")
    (tmp_path / f".evodesign-{'1' * 16}.part").symlink_to(tmp_path / ".evodesign-mine.part")
    write_whole(tmp_path / "page", b"x")
    assert not left.exists()
    assert sorted(names(tmp_path)) == [f".evodesign-{'1' * 16}.part", ".evodesign-mine.part", "page"]


def test_a_file_that_is_being_written_is_left_alone_by_others(tmp_path: Path) -> None:
    with replacing(tmp_path / "one") as one:
        one.write(b"1")
        with replacing(tmp_path / "two") as two:
            two.write(b"2")
        assert len(names(tmp_path)) == 2
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"one": b"1", "two": b"2"}


@pytest.mark.parametrize("part", ["", "segment.part"])
def test_what_others_put_in_the_place_of_a_file_is_replaced_and_leads_nowhere(
    part: str, tmp_path: Path
) -> None:
    (tmp_path / "far").write_text("far")
    for name in ("page", "segment.part"):
        (tmp_path / name).symlink_to(tmp_path / "far")
    os.mkfifo(tmp_path / "pipe")
    for name in ("page", "pipe"):
        with replacing(tmp_path / name, part, follow=False) as file:
            file.write(b"new")
        assert not (tmp_path / name).is_symlink()
        assert (tmp_path / name).read_bytes() == b"new"
    assert (tmp_path / "far").read_text() == "far"


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b"], ids=["too long", "with a zero"])
def test_a_name_that_no_file_can_have_is_nowhere(name: str, tmp_path: Path) -> None:
    assert not is_there(tmp_path / name)
    tables = tomllib.loads(read_source("point-grasp").text)
    tables["robot"]["urdf"] = name
    with pytest.raises(InputError, match=r"robot\.urdf: wanted a readable file"):
        source_of(tables, tmp_path)
    with pytest.raises(InputError, match="PROBLEM: wanted a problem file"):
        read_source(name)
