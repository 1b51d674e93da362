"""Whatever the files of a problem hold: they load, or one sentence says what is wrong and where.

Cases are numbered; each is a function of its number alone. To look at one: `spoilt_files(number)`.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from tests.cli.here import evodesign
from tests.cli.test_bad_input import assert_explained
from tests.fuzz.input_cases import (
    BODY,
    MESHES,
    PERSON,
    POPULATION,
    PROBLEM,
    ROBOT,
    TEXTS,
    complaint,
    sound,
    spoilt_files,
)
from tests.fuzz.limits import Hanging, time_limit
from tests.rewriting import write_anew

CASES, QUICK_CASES = 1000, 300


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in (TEXTS | MESHES).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_files_that_are_spoilt_are_a_problem(folder: Path) -> None:
    assert sound(build_problem(read_source(folder / PROBLEM)))


@pytest.mark.parametrize(
    "numbers", [range(QUICK_CASES), pytest.param(range(QUICK_CASES, CASES), marks=pytest.mark.slow)], ids=str
)
def test_whatever_the_files_hold_they_load_or_one_sentence_names_the_fault(
    numbers: range, folder: Path
) -> None:
    loaded, refused, wrong = 0, 0, []
    for number in numbers:
        case = spoilt_files(number)
        write_anew(folder / case.target, case.content)
        try:
            with time_limit():
                read, complaints = complaint(folder)
        except Hanging as hanging:
            read, complaints = False, str(hanging)
        write_anew(folder / case.target, TEXTS[case.target].encode())
        loaded, refused = loaded + read, refused + (not read)
        if complaints:
            wrong.append(f"case {number}, {case.target} ({', '.join(case.mutations)}): {complaints}")
    assert not wrong, "\n".join([f"{len(wrong)} of {len(numbers)}", *wrong[:40]])
    assert loaded > len(numbers) / 20, "not all damage does harm"
    assert refused > len(numbers) / 2, "most damage is noticed"


def replaced(name: str, old: str, new: str) -> str:
    assert old in TEXTS[name]
    return TEXTS[name].replace(old, new)


LAUGHS = "".join(f"<!ENTITY a{i + 1} '{f'&a{i};' * 10}'>" for i in range(12))
DEEP = "<x>" * 3000 + "</x>" * 3000


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        (ROBOT, f"<!DOCTYPE robot [<!ENTITY a0 'ha'>{LAUGHS}]>{BODY[BODY.find('<robot') :]}", [ROBOT, "DTD"]),
        (
            ROBOT,
            replaced(ROBOT, "0.2 0.3 0.4", "0.2 nan 0.4"),
            [ROBOT, "link root_link.visual.box.size", "nan"],
        ),
        (ROBOT, replaced(ROBOT, "</robot>", f"{DEEP}</robot>"), [ROBOT, "XML"]),
        (PERSON, replaced(PERSON, '<parent link="root_link"/>', '<parent link="l_sole"/>'), [PERSON, "loop"]),
        (PERSON, replaced(PERSON, '<link name="claw">', '<link name="l_arm">'), [PERSON, "l_arm", "twice"]),
        (PROBLEM, replaced(PROBLEM, "seed = 1", f"seed{'.a' * 3000} = 1"), [PROBLEM, "at most 16 dotted"]),
        (PROBLEM, replaced(PROBLEM, "friction", '"fric\\ntion"'), [PROBLEM, "limits.fric\\ntion"]),
        (POPULATION, "\udc80\udcff", [PROBLEM, "search.start", POPULATION]),
    ],
    ids=[
        "entities",
        "nan",
        "nested URDF",
        "loop",
        "a name twice",
        "nested TOML",
        "a key of two lines",
        "bytes",
    ],
)
def test_the_command_line_leaves_with_a_sentence_and_exit_code_two(
    name: str, content: str, words: list[str], folder: Path
) -> None:
    (folder / name).write_bytes(content.encode("utf-8", "surrogateescape"))
    assert_explained(evodesign("check", folder / PROBLEM), words)
