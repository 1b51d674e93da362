"""Segments with right checksums and wrong content: they are read with notes, or refused in a sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.errors import RunError
from evodesign.records import FORMAT_VERSION
from evodesign.runlog.channels import RUN
from evodesign.runlog.follow import Follower
from evodesign.runlog.rewrite import recover
from evodesign.runlog.run import RunLog, read_run
from tests.fuzz.segment_cases import Message, examine, messages_of, sound_run, spoilt
from tests.runlog import crafted

QUICK_CASES, CASES, PARTS = 100, 700, 2
LATER = (FORMAT_VERSION + 1, 1000)
CORPUS = sorted((Path(__file__).parent / "corpus/segments").iterdir())


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunLog:
    return sound_run(tmp_path_factory.mktemp("fuzz") / "run")


@pytest.fixture(scope="module")
def messages(run: RunLog) -> list[Message]:
    return messages_of(run)


@pytest.mark.parametrize(
    "numbers",
    [
        range(QUICK_CASES),
        *(
            pytest.param(range(QUICK_CASES + part, CASES, PARTS), marks=pytest.mark.slow)
            for part in range(PARTS)
        ),
    ],
    ids=str,
)
def test_whatever_a_segment_holds_it_is_read_or_refused(
    numbers: range, run: RunLog, messages: list[Message], tmp_path: Path
) -> None:
    assert messages[0][0] == RUN
    read = 0
    for number in numbers:
        folder = tmp_path / f"{number}"
        folder.mkdir()
        try:
            read += examine(folder, spoilt(messages, number), run)
        except Exception as error:
            raise AssertionError(f"case {number}: {type(error).__name__}: {error}") from error
    assert read > len(numbers) / 2, "not all damage takes the header"


@pytest.mark.parametrize("path", CORPUS, ids=[path.stem for path in CORPUS])
def test_what_was_found_once_stays_mended(path: Path, run: RunLog, tmp_path: Path) -> None:
    examine(tmp_path, path.read_bytes(), run)


@pytest.mark.parametrize("version", [-1, 0, 0.5, FORMAT_VERSION + 1, 1000, 1001, 2**63, 10**30])
@pytest.mark.parametrize("place", [0, 1, 20])
def test_a_header_of_another_format_is_taken_alike_by_all_that_reads(
    version: float, place: int, run: RunLog, messages: list[Message], tmp_path: Path
) -> None:
    """Beside a sound header or in its place: later formats are refused, impossible ones are no records."""
    topic, header, number = messages[0]
    strange = (topic, {**header, "format_version": version}, number)
    told = [strange, *messages[1:]] if place == 0 else [*messages[:place], strange, *messages[place:]]
    parts = [crafted.told(*each) for each in told]
    parts[0] = crafted.channels() + parts[0]
    content = crafted.segment(map(crafted.chunk, parts))
    assert examine(tmp_path, content, run) == (place > 0 and version not in LATER)
    if version in LATER:
        with pytest.raises(RunError, match=f"found format {version}; read it with a later evodesign"):
            Follower(tmp_path / "spoilt").look()
        with pytest.raises(RunError, match="later evodesign"):
            recover(tmp_path / "spoilt", tmp_path / "recovered")
    elif place > 0:
        assert "are no records (/run: " in " ".join(read_run(tmp_path / "spoilt").notes)
