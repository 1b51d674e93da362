"""Ways to spoil a problem file or designs: values, keys, headers and depths; see `mutations`."""

from __future__ import annotations

import re
from collections.abc import Callable

from tests.fuzz.mutations import DEPTHS, Chance, Mutation, as_bytes, some

VALUES = (
    *(
        "1",
        "-1",
        "0",
        "1.5",
        "nan",
        "-inf",
        "true",
        '"word"',
        '""',
        "[]",
        "{}",
        "[1, 2, 3]",
        "[[1], [2]]",
        '["a"]',
    ),
    *(
        '"a\\nb"',
        '"""\nlines\n"""',
        "1979-05-27",
        "1" + "0" * 400,
        "1e308",
        "1e999",
        '"\\u0000"',
        '"."',
        '"/"',
    ),
    *(
        "{ a = 1 }",
        "[nan, nan, nan]",
        '[{ name = "x" }]',
        "9223372036854775808",
        "0.1e-400",
        '"' + "x" * 5000 + '"',
    ),
)
KEY = re.compile(r"^([A-Za-z_]+) = ", re.MULTILINE)
VALUE = re.compile(r"^([A-Za-z_]+ = )([^\n]*)$", re.MULTILINE)
HEADER = re.compile(r"^\[+[^\n]*\]+$", re.MULTILINE)


def replace_one(
    pattern: re.Pattern[str], text: str, by: Callable[[re.Match[str]], str], chance: Chance
) -> bytes:
    found = list(pattern.finditer(text))
    if not found:
        return as_bytes(text)
    victim = found[int(chance.integers(len(found)))]
    return as_bytes(text[: victim.start()] + by(victim) + text[victim.end() :])


def with_another_value(text: str, chance: Chance) -> bytes:
    return replace_one(VALUE, text, lambda found: found[1] + some(VALUES, chance), chance)


def with_another_key(text: str, chance: Chance) -> bytes:
    keys = ['"a\\nb"', "''", "name.x", "urdf", "lower", "links", '"\\u0007"', "x" * 3000]
    return replace_one(KEY, text, lambda found: some([*keys, found[1][:-1] or "x"], chance) + " = ", chance)


def with_a_deep_value(text: str, chance: Chance) -> bytes:
    depth = int(chance.choice(DEPTHS))
    deep = some(["[" * depth + "]" * depth, "{ a = " * depth + "1" + " }" * depth], chance)
    return replace_one(VALUE, text, lambda found: found[1] + deep, chance)


def with_a_deep_key(text: str, chance: Chance) -> bytes:
    """Dotted keys nest tables without nesting brackets."""
    deep = ".a" * int(chance.choice(DEPTHS))
    return replace_one(VALUE, text, lambda found: found[1].replace(" = ", f"{deep} = ") + "1", chance)


def with_another_header(text: str, chance: Chance) -> bytes:
    headers = [
        "[robot]",
        "[[robot]]",
        "[design]",
        "[[design]]",
        "[x]",
        "[[design.length]]",
        "[a.b.c]",
        '["\\n"]',
        "",
    ]
    return replace_one(HEADER, text, lambda _: some(headers, chance), chance)


def with_a_name_from_elsewhere(text: str, chance: Chance) -> bytes:
    words = re.findall(r'"([^"\n]*)"', text) or ["x"]
    return replace_one(
        re.compile(r'"[^"\n]*"'), text, lambda _: f'"{some([*words, "", "x.urdf", "q"], chance)}"', chance
    )


TOML: tuple[Mutation, ...] = (
    with_another_value,
    with_another_value,
    with_another_value,
    with_another_key,
    with_a_deep_value,
    with_a_deep_key,
    with_another_header,
    with_a_name_from_elsewhere,
)
