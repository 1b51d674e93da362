"""Ways to spoil a URDF: elements, attributes, names, loops and depths; see `mutations`."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable

from lxml import etree

from tests.fuzz.mutations import DEPTHS, NUMBERS, WORDS, Chance, Mutation, as_bytes, some


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
