"""What is kept is given back whole, and never what another user could have written."""

from __future__ import annotations

import multiprocessing
import os
import stat
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from evodesign.identity import digest
from evodesign.nlp.disk_cache import Cache, open_cache, user_cache

KEY = digest("key")


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return open_cache(tmp_path / "new" / "cache")


def rights(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_what_is_stored_is_found(cache: Cache) -> None:
    path = cache.store(KEY, b"content")
    assert cache.find(KEY) == path
    assert cache.read(KEY) == b"content"
    assert path.read_bytes() == b"content"


def test_nothing_is_found_under_another_key(cache: Cache) -> None:
    cache.store(KEY, b"content")
    assert cache.find(digest("other")) is None
    assert cache.read(digest("other")) is None


def test_directories_and_files_belong_to_the_user_alone(cache: Cache) -> None:
    assert rights(cache.directory) == 0o700
    assert rights(cache.directory.parent) == 0o700
    assert rights(cache.store(KEY, b"content")) == 0o600


def damage(path: Path) -> None:
    path.write_bytes(b"contenu")


def cut_short(path: Path) -> None:
    path.write_bytes(b"")


def open_to_group(path: Path) -> None:
    path.chmod(0o620)


def open_to_all(path: Path) -> None:
    path.chmod(0o602)


def make_a_link(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def make_a_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def give_away(path: Path) -> None:
    if os.getuid() != 0:
        pytest.skip("only root can give a file away")
    os.chown(path, 12345, 12345)


@pytest.mark.parametrize(
    "harm", [damage, cut_short, open_to_group, open_to_all, make_a_link, make_a_pipe, give_away]
)
def test_harmed_file_is_not_found_and_storing_again_mends_it(
    cache: Cache, harm: Callable[[Path], None]
) -> None:
    path = cache.store(KEY, b"content")
    harm(path)
    assert cache.find(KEY) is None
    assert cache.read(KEY) is None
    assert cache.store(KEY, b"content") == path
    assert cache.read(KEY) == b"content"
    assert rights(path) == 0o600


def test_failed_store_leaves_nothing(cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: Path, target: Path) -> Path:
        raise OSError(f"no space for {target}")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="no space"):
        cache.store(KEY, b"content")
    assert list(cache.directory.iterdir()) == []


@pytest.mark.parametrize("mode", [0o770, 0o707, 0o1777])
def test_directory_open_to_others_is_refused(tmp_path: Path, mode: int) -> None:
    directory = tmp_path / "cache"
    directory.mkdir()
    directory.chmod(mode)
    with pytest.raises(PermissionError, match="this user alone"):
        open_cache(directory)


def test_directory_that_others_could_replace_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o777)
    with pytest.raises(PermissionError, match="open to the writing of others"):
        open_cache(tmp_path / "cache")
    tmp_path.chmod(0o1777)  # as /tmp is: others may add, but not replace
    assert open_cache(tmp_path / "cache").directory == tmp_path / "cache"


def test_directory_of_another_user_is_refused(tmp_path: Path) -> None:
    directory = tmp_path / "theirs"
    directory.mkdir()
    give_away(directory)
    with pytest.raises(PermissionError):
        open_cache(directory)
    with pytest.raises(PermissionError, match="belongs to another user"):
        open_cache(directory / "cache")


def test_named_directory_comes_before_xdg_before_home(tmp_path: Path) -> None:
    environment = {"HOME": str(tmp_path / "home")}
    assert user_cache("seeds", environment).directory == tmp_path / "home/.cache/evodesign/seeds"
    environment["XDG_CACHE_HOME"] = str(tmp_path / "xdg")
    assert user_cache("seeds", environment).directory == tmp_path / "xdg/evodesign/seeds"
    environment["EVODESIGN_CACHE"] = str(tmp_path / "named")
    assert user_cache("seeds", environment).directory == tmp_path / "named/seeds"


@pytest.mark.parametrize("home", ["missing", "a file", "read-only"])
def test_unusable_home_falls_back_to_a_private_temporary_directory(
    home: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    place = tmp_path / "home"
    environment = {} if home == "missing" else {"HOME": str(place)}
    if home == "a file":
        place.touch()
    if home == "read-only":
        user_cache("seeds", environment)
        writable = os.access

        def access(path: Path, mode: int) -> bool:  # root may write what its rights forbid
            return not path.is_relative_to(place) and writable(path, mode)

        monkeypatch.setattr(os, "access", access)
    expected = tmp_path / "temporary" / f"evodesign-{os.getuid()}" / "seeds"
    assert user_cache("seeds", environment).directory == expected
    assert rights(expected.parent) == 0o700


def test_occupied_temporary_directory_is_refused_with_a_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    occupied = tmp_path / f"evodesign-{os.getuid()}"
    occupied.mkdir()
    occupied.chmod(0o777)
    with pytest.raises(OSError, match=r"no directory to keep files in: .*open to the writing of others"):
        user_cache("seeds", {})


def store_often(directory: Path, letter: bytes) -> None:
    cache = open_cache(directory)
    for _ in range(50):
        cache.store(KEY, letter * 100_000)


def test_readers_see_whole_contents_while_processes_store(cache: Cache) -> None:
    cache.store(KEY, b"a" * 100_000)
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=store_often, args=(cache.directory, letter)) for letter in (b"a", b"b")]
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        assert cache.read(KEY) in (b"a" * 100_000, b"b" * 100_000)
    for writer in writers:
        writer.join()
        assert writer.exitcode == 0
    assert len(list(cache.directory.iterdir())) == 2


def test_lock_is_held_by_one_and_the_next_knows_that_it_waited(cache: Cache) -> None:
    found = []

    def take() -> None:
        with cache.lock(KEY) as waited:
            found.append(waited)

    with cache.lock(KEY) as waited:
        assert not waited
        second = threading.Thread(target=take)
        second.start()
        second.join(0.2)
        assert second.is_alive()
    second.join(10.0)
    assert found == [True]
    take()
    assert found == [True, False]
