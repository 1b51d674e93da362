"""Inputs made to exhaust the machine or the reader end soon, in little memory, with a readable sentence."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from evodesign.problem.named_files import LONGEST_FILE
from tests.cli.bounded import Command, bounded_commands
from tests.cli.here import evodesign
from tests.cli.test_bad_input import PROBLEM, ROBOT, assert_explained, place, spoil

__all__ = ["place"]


@pytest.fixture(scope="module")
def evodesign_bounded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Command]:
    with bounded_commands(tmp_path_factory.mktemp("bounded")) as command:
        yield command


TWENTY_THOUSAND_PARTS = "a" + ".a" * 19_999 + " = 1\n"


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (TWENTY_THOUSAND_PARTS, [PROBLEM, "line 1", "at most 10000 letters", "found 40003"]),
        ("a" + ".a" * 4_000 + " = 1\n", [PROBLEM, "a key of at most 16 dotted parts, found 4001"]),
        ("[" + "a . 'b' ." * 500 + " a]\n", [PROBLEM, "a key of at most 16 dotted parts, found 1001"]),
        ("".join(f"k{i}.b = 1\n" for i in range(70_000)), [PROBLEM, "k0", "one of the keys"]),
        ("".join(f"k{i}=1\n" for i in range(200_000)), [PROBLEM, "at most 1000000 letters"]),
        ("x = " + "[" * 4_000 + "]" * 4_000 + "\n", [PROBLEM, "valid TOML"]),
    ],
    ids=["20,000 parts", "4,000 parts", "a header", "70,000 keys", "1 MB", "nested arrays"],
)
def test_a_hostile_problem_is_refused_within_bounds(
    more: str, words: list[str], place: Path, evodesign_bounded: Command
) -> None:
    problem = place / PROBLEM
    problem.write_text(more + problem.read_text(encoding="utf-8"), encoding="utf-8")
    assert_explained(evodesign_bounded("check", problem), words)


def test_a_file_without_end_is_refused_within_bounds(place: Path, evodesign_bounded: Command) -> None:
    with (place / ROBOT).open("r+b") as file:
        file.truncate(10_000_000_000)
    words = [PROBLEM, "robot.urdf", f"a file of at most {LONGEST_FILE} letters"]
    assert_explained(evodesign_bounded("check", place / PROBLEM), words)


@pytest.mark.parametrize("name", ["k" * 3_000, "k" * 1_500 + "." + "l" * 1_500, "'" + "k l " * 750 + "'"])
def test_a_key_of_three_thousand_letters_is_not_quoted_in_full(name: str, place: Path) -> None:
    problem = spoil(place, PROBLEM, "[payload]", f"[payload]\n{name} = 1")
    done = evodesign("check", problem)
    assert_explained(done, [f"{problem}: payload.k", "..."])
    assert max(map(len, re.split(r"wanted|found", done.stderr.replace(str(problem), "")))) <= 700


def test_the_path_of_a_file_stays_whole_however_long(tmp_path: Path) -> None:
    problem = tmp_path.joinpath(*["a folder of a long name " * 8] * 6) / "problem.toml"
    problem.parent.mkdir(parents=True)
    problem.write_text("x = 1", encoding="utf-8")
    assert_explained(evodesign("check", problem), [f"{problem}: x: "])


def robot_with(place: Path, more: str) -> Path:
    return spoil(place, ROBOT, "</robot>", f"{more}</robot>")


def fixed(name: str, parent: str, y: float) -> str:
    return (
        f'<link name="{name}"/><joint name="{name}" type="fixed"><origin xyz="0 {y!r} 0"/>'
        f'<parent link="{parent}"/><child link="{name}"/></joint>'
    )


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.001, 0.0])
def test_a_robot_with_three_thousand_fixed_children_is_read_within_bounds(
    spread: float, place: Path, evodesign_bounded: Command
) -> None:
    ys = [spread * (1 + n // 2) * (1 if n % 2 else -1) for n in range(3_000)]
    problem = robot_with(place, "".join(fixed(f"extra{n}", "root_link", y) for n, y in enumerate(ys)))
    done = evodesign_bounded("check", problem)
    assert done.returncode == 0
    assert all(line.startswith("note: ") for line in done.stderr.splitlines())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("".join(fixed(f"extra{n}", "root_link", 0.0) for n in range(5_000)), ["links, at most 5000"]),
        (
            fixed("extra0", "root_link", 0.0)
            + "".join(fixed(f"extra{n}", f"extra{n - 1}", 0.0) for n in range(1, 3_000)),
            ["joint extra200: wanted chains of at most 200 joints"],
        ),
        ("<a/>" * 200_000, ["at most 100000 elements"]),
        ("<a " + "".join(f" b{n}=''" for n in range(20_000)) + "/>", ["elements of at most 100000 letters"]),
        (fixed("l" * 3_000, "root_link", 0.0), ["a name on one line, of at most 200 letters", "lll...lll"]),
        ('<link name="loose"/>' * 3_000, ["link loose: wanted a unique name"]),
        (
            "".join(fixed(f"extra{n}", f"extra{n + 1}", 0.0) for n in range(3_000))
            + '<link name="extra3000"/>',
            ["one root link", "2: root_link, extra3000"],
        ),
        (
            '<link name="much">' + '<visual><geometry><sphere radius="1"/></geometry></visual>' * 30_000,
            ["XML"],
        ),
        (
            '<link name="much">'
            + '<visual><geometry><sphere radius="1"/></geometry></visual>' * 30_000
            + "</link>",
            ["one root link"],
        ),
    ],
    ids=["links", "chain", "elements", "tag", "name", "twice", "roots", "open", "shapes"],
)
def test_a_hostile_robot_is_refused_within_bounds(
    more: str, words: list[str], place: Path, evodesign_bounded: Command
) -> None:
    assert_explained(evodesign_bounded("check", robot_with(place, more)), ["icub_shapes.urdf", *words])
