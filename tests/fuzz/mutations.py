"""Ways to spoil a text of any kind: each takes it and a source of chance, and gives bytes.

What a mutation needs and does not find (a number, an element) makes it return the text as it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np

Chance = np.random.Generator
Mutation = Callable[[str, Chance], bytes]

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
NUMBERS = (
    *("nan", "inf", "-inf", "1e308", "-1e308", "1e999", "1e-320", "0", "-0.0", "-1", "1e6", "1e-7", "3"),
    *(
        "",
        " ",
        "x",
        "1.2.3",
        "0x10",
        "1_0",
        "--1",
        "1 2",
        "1,2",
        "9" * 400,
        "0." + "0" * 400 + "1",
        "1e",
        "٣",
    ),
)
WORDS = (
    *(
        "",
        " ",
        "link",
        "l_hand",
        "pelvis",
        "chest",
        "root_link",
        "fixed",
        "revolute",
        "continuous",
        "floating",
    ),
    *(
        "a\nb",
        "a\tb",
        "\x7f",
        "é",
        "‮",
        "😀",
        "x" * 5000,
        "../../etc/passwd",
        "&amp;",
        "]]>",
        "[/bold]",
        "%s{}",
    ),
)
DEPTHS = (2, 50, 300, 3000)


def some(items: Sequence[str], chance: Chance) -> str:
    return items[int(chance.integers(len(items)))]


def piece(text: str, chance: Chance) -> tuple[int, int]:
    """Start and end of a short piece of the text."""
    start = int(chance.integers(len(text) + 1))
    return start, min(len(text), start + int(chance.integers(1, 80)))


def as_bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


def truncated(text: str, chance: Chance) -> bytes:
    return as_bytes(text[: int(chance.integers(len(text) + 1))])


def with_a_piece_deleted(text: str, chance: Chance) -> bytes:
    start, end = piece(text, chance)
    return as_bytes(text[:start] + text[end:])


def with_a_piece_doubled(text: str, chance: Chance) -> bytes:
    start, end = piece(text, chance)
    return as_bytes(text[:end] + text[start:])


def with_a_piece_moved(text: str, chance: Chance) -> bytes:
    start, end = piece(text, chance)
    rest = text[:start] + text[end:]
    place = int(chance.integers(len(rest) + 1))
    return as_bytes(rest[:place] + text[start:end] + rest[place:])


def with_random_bytes(text: str, chance: Chance) -> bytes:
    spoilt = bytearray(as_bytes(text))
    for _ in range(int(chance.integers(1, 20))):
        spoilt.insert(int(chance.integers(len(spoilt) + 1)), int(chance.integers(256)))
    return bytes(spoilt)


def nothing_but_random_bytes(text: str, chance: Chance) -> bytes:
    return chance.bytes(int(chance.integers(200)))


def with_a_strange_number(text: str, chance: Chance) -> bytes:
    """Numbers that are not finite, negative, huge, tiny, or none at all."""
    found = list(NUMBER.finditer(text))
    if not found:
        return as_bytes(text)
    victim = found[int(chance.integers(len(found)))]
    return as_bytes(text[: victim.start()] + some(NUMBERS, chance) + text[victim.end() :])


def with_a_line_deleted_or_doubled(text: str, chance: Chance) -> bytes:
    lines = text.splitlines(keepends=True) or [""]
    number = int(chance.integers(len(lines)))
    return as_bytes(
        "".join(
            [*lines[:number], *lines[number : number + 1] * int(chance.choice([0, 2])), *lines[number + 1 :]]
        )
    )


def with_other_line_ends(text: str, chance: Chance) -> bytes:
    return as_bytes(
        some(["\ufeff", "", "\x00"], chance) + text.replace("\n", some(["\r\n", "\r", ""], chance))
    )


ANY: tuple[Mutation, ...] = (
    truncated,
    with_a_piece_deleted,
    with_a_piece_doubled,
    with_a_piece_moved,
    with_random_bytes,
    nothing_but_random_bytes,
    with_a_strange_number,
    with_a_strange_number,
    with_a_strange_number,
    with_a_line_deleted_or_doubled,
    with_other_line_ends,
)
