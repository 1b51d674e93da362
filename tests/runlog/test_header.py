"""A later session's header: with its own versions and time, or refused."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from evodesign.errors import RunError
from evodesign.runlog.header import renewed, versions
from tests.runlog.toys import toy_header

HEADER = msgspec.structs.replace(toy_header(), versions=versions(), started="2020-01-01T00:00:00+00:00")


def test_a_later_session_has_its_own_time_and_nothing_to_note() -> None:
    new, notes = renewed(HEADER, Path("run"), accept_versions=False)
    assert notes == ()
    assert new.started > HEADER.started
    assert msgspec.structs.replace(new, started=HEADER.started, git=HEADER.git) == HEADER


def test_a_clock_that_was_set_back_is_noted() -> None:
    ahead = msgspec.structs.replace(HEADER, started="2999-01-01T00:00:00+00:00")
    _, (note,) = renewed(ahead, Path("run"), accept_versions=False)
    assert note.startswith("the clock stands before 2999")


def test_other_versions_are_refused_unless_accepted() -> None:
    other = msgspec.structs.replace(HEADER, versions={**versions(), "numpy": "0.1"})
    with pytest.raises(RunError, match=r"was written with numpy 0\.1 .*--accept-versions"):
        renewed(other, Path("run"), accept_versions=False)
    assert renewed(other, Path("run"), accept_versions=True)[0].versions == versions()
