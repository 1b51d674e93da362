"""Ways to spoil a text: any file, XML, TOML. Each takes the text and a source of chance, and gives bytes.

What a mutation needs and does not find (a number, an element) makes it return the text as it is.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Sequence

import numpy as np
from lxml import etree

__all__ = ["ANY", "TOML", "XML", "Mutation"]

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


# Any file


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


# XML


def edited(edit: Callable[[list[etree._Element], Chance], None]) -> Mutation:
    """A mutation of the parsed document, which is given as the list of its elements."""

    def mutation(text: str, chance: Chance) -> bytes:
        try:
            root = etree.fromstring(text.encode())
        except (etree.XMLSyntaxError, UnicodeEncodeError):
            return as_bytes(text)  # spoilt already
        edit(list(root.iter(etree.Element)), chance)
        return etree.tostring(root)

    mutation.__name__ = edit.__name__
    return mutation


def any_of(elements: list[etree._Element], chance: Chance) -> etree._Element:
    return elements[int(chance.integers(len(elements)))]


def delete_an_element(elements: list[etree._Element], chance: Chance) -> None:
    victim = any_of(elements, chance)
    if victim.getparent() is not None:
        victim.getparent().remove(victim)


def double_an_element(elements: list[etree._Element], chance: Chance) -> None:
    victim = any_of(elements, chance)
    if victim.getparent() is not None:
        victim.addnext(copy.deepcopy(victim))


def move_an_element(elements: list[etree._Element], chance: Chance) -> None:
    victim, place = any_of(elements, chance), any_of(elements, chance)
    if victim.getparent() is not None and victim not in (place, *place.iterancestors()):
        place.append(victim)


def rename_an_element(elements: list[etree._Element], chance: Chance) -> None:
    tags = sorted({element.tag for element in elements})
    any_of(elements, chance).tag = some([*tags, "capsule", "{urn:x}link", "mesh", "mimic"], chance)


def spoil_an_attribute(elements: list[etree._Element], chance: Chance) -> None:
    victim = any_of([element for element in elements if element.attrib] or elements, chance)
    for name in list(victim.attrib)[:1] if chance.random() < 0.5 else list(victim.attrib)[-1:]:
        value = victim.attrib.pop(name)
        match int(chance.integers(4)):
            case 0:
                victim.set(some(["name", "xyz", "size", "link", "type", "value"], chance), value)
            case 1:
                victim.set(
                    name, some([word for word in WORDS if word.isprintable() or word in "\na\tb"], chance)
                )
            case 2:
                victim.set(name, " ".join(some(NUMBERS, chance) for _ in range(int(chance.integers(1, 4)))))
            case _:
                return


def double_a_name(elements: list[etree._Element], chance: Chance) -> None:
    named = [element for element in elements if element.get("name")]
    if named:
        any_of(named, chance).set("name", any_of(named, chance).get("name"))


def close_a_cycle(elements: list[etree._Element], chance: Chance) -> None:
    """Some joint's child becomes another's; now and then all of them."""
    links = [element.get("name") for element in elements if element.tag == "link" and element.get("name")]
    children = [element for element in elements if element.tag in ("child", "parent")]
    for end in children if chance.random() < 0.2 else children[: int(chance.integers(3))]:
        end.set("link", some(links or ["x"], chance))


def nest_deeply(elements: list[etree._Element], chance: Chance) -> None:
    place, tag = any_of(elements, chance), some(["link", "geometry", "x"], chance)
    for _ in range(int(chance.choice(DEPTHS))):
        place = etree.SubElement(place, tag, name="deep")


def add_a_long_chain(elements: list[etree._Element], chance: Chance) -> None:
    root, above = elements[0], next((e.get("name") for e in elements if e.tag == "link"), None)
    for number in range(int(chance.choice([20, 400]))):
        etree.SubElement(root, "link", name=f"chain_{number}")
        joint = etree.SubElement(root, "joint", name=f"to_chain_{number}", type="fixed")
        etree.SubElement(joint, "parent", link=above or "x")
        etree.SubElement(joint, "child", link=f"chain_{number}")
        above = f"chain_{number}"


def with_entities(text: str, chance: Chance) -> bytes:
    """Entities that grow (a billion laughs), that recur, or that fetch a file or a page."""
    levels = int(chance.choice([3, 12]))
    laughs = "".join(f"<!ENTITY a{i + 1} '{f'&a{i};' * 10}'>" for i in range(levels))
    declarations = some(
        [
            f"<!ENTITY a0 'ha'>{laughs}",
            "<!ENTITY a0 '&a1;'><!ENTITY a1 '&a0;'>",
            "<!ENTITY a0 SYSTEM 'file:///dev/zero'>",
            "<!ENTITY a0 SYSTEM 'http://127.0.0.1:9/x'>",
            "<!ENTITY % a0 SYSTEM 'file:///etc/hostname'>%a0;",
        ],
        chance,
    )
    used = some([f"&a{levels};", "&a0;", "", "&nobody;"], chance)
    body = re.sub(r"<\?xml[^>]*>", "", text, count=1)
    start = body.find(">", body.find("<robot")) + 1
    return as_bytes(f"<!DOCTYPE robot [{declarations}]>{body[:start]}{used}{body[start:]}")


XML: tuple[Mutation, ...] = (
    *map(
        edited,
        (
            delete_an_element,
            delete_an_element,
            double_an_element,
            move_an_element,
            rename_an_element,
            spoil_an_attribute,
            spoil_an_attribute,
            spoil_an_attribute,
            double_a_name,
            close_a_cycle,
            nest_deeply,
            add_a_long_chain,
        ),
    ),
    with_entities,
)


# TOML

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
