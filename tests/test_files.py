"""A file is there whole or not at all, and what stood in its place stays until then."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from evodesign.files import replacing, write_folder, write_whole
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
