"""Writes docs/api.md, the reference of what Python users may call: `python -m docs.write_api`.

The page is made of `evodesign.__all__` in that order, of the classes of `evodesign.api` that these functions
give, of the records that a design's results are made of, and of their public methods and attributes. All text
is the docstrings'. A docstring's sections become
lists, and what a Python prompt shows becomes a block of code.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import evodesign
from evodesign.records import (
    AgentDetail,
    CaseDetail,
    CaseOutcome,
    InstantDetail,
    LoadCaseDetail,
    ReachOutcome,
)

PAGE = Path(__file__).parent / "api.md"

HEAD = """# Python API

Written from the docstrings by `make api`. [python.md](python.md) is the introduction. Quantities are SI;
units stand in brackets. In the examples `run` is `evodesign.open_run("runs/first")`, a small run of two
people, `design` is its design 4, and `problem` is `evodesign.open_problem("problem.toml")`, the problem that
the run was started with; `runs/people` is a run whose front was evaluated beside three
people of the measured distribution.
"""

RECORDS = (CaseDetail, InstantDetail, AgentDetail, LoadCaseDetail, CaseOutcome, ReachOutcome)
"""What a design's results are made of, beside numbers."""

SECTION = re.compile(r"(Args|Attributes|Returns|Raises|Source|Example):\s*(.*)")
TITLES = {"Args": "Arguments", "Returns": "Gives"}
ITEM = re.compile(r"([*\w, ]+): (.*)")


class Unquoted(str):
    """An annotation that is shown as it was written."""

    __slots__ = ()
    __repr__ = str.__str__


@dataclass(frozen=True, slots=True)
class Documented:
    """Something public.

    Args:
        name: as a user writes it, such as `Run.choose`.
        value: the object itself.
        depth: of its heading.
    """

    name: str
    value: Any
    depth: int

    @property
    def text(self) -> str:
        """Its docstring; for a value that is no function, class or module, that of its class."""
        return inspect.getdoc(self.value) or ""

    @property
    def signature(self) -> str:
        """How it is called, or what it is."""
        value = self.value
        if isinstance(value, property):
            return f"{self.name}: {inspect.signature(value.fget).return_annotation}"  # type: ignore[arg-type]
        if not callable(value):
            return f"{self.name}: {type(value).__name__}"
        parameters = inspect.signature(value)
        if inspect.isclass(value):
            parameters = parameters.replace(return_annotation=inspect.Signature.empty)
        given = [
            each.replace(annotation=_unquoted(each.annotation))
            for each in parameters.parameters.values()
            if each.name != "self"
        ]
        gives = _unquoted(parameters.return_annotation)
        return f"{self.name}{parameters.replace(parameters=given, return_annotation=gives)}"


def _unquoted(annotation: Any) -> Any:
    return Unquoted(annotation) if isinstance(annotation, str) else annotation


def documented() -> tuple[Documented, ...]:
    """Everything public, in the order of the page."""
    names = {name: getattr(evodesign, name) for name in evodesign.__all__ if not name.startswith("_")}
    for value in (*names.values(),):
        names |= {given.__name__: given for given in _given_classes(value) if given not in names.values()}
    names |= {record.__name__: record for record in RECORDS}
    return tuple(each for name, value in names.items() for each in _with_members(name, value))


def _given_classes(value: Any) -> Iterator[type]:
    """Classes of `evodesign.api` that a function or a class's public members give, and what these give."""
    found: list[type] = []
    waiting = [value]
    while waiting:
        one = waiting.pop(0)
        functions = [one] if inspect.isfunction(one) else [member.value for member in _members("", one)]
        for function in (each.fget if isinstance(each, property) else each for each in functions):
            module = sys.modules[function.__module__]
            for word in re.findall(r"\w+", str(inspect.signature(function).return_annotation)):
                given = getattr(module, word, None)
                public = inspect.isclass(given) and given.__module__.startswith("evodesign.api")
                if public and given not in found:
                    found.append(given)
                    waiting.append(given)
    yield from found


def _with_members(name: str, value: Any) -> Iterator[Documented]:
    yield Documented(name, value, 2)
    yield from _members(name, value)


def _members(name: str, value: Any) -> Iterator[Documented]:
    """Public methods and properties of a class; public functions of a module."""
    if inspect.ismodule(value):
        own = {each: getattr(value, each) for each in getattr(value, "__all__", ())}
    elif inspect.isclass(value):
        own = {each: member for each, member in vars(value).items() if not each.startswith("_")}
    else:
        own = {}
    for each, member in own.items():
        if isinstance(member, property) or inspect.isfunction(member):
            yield Documented(f"{name}.{each}", member, 3)


def page() -> str:
    """The page as Markdown."""
    return HEAD + "".join(f"\n{part}" for each in documented() for part in _parts(each))


def _parts(each: Documented) -> Iterator[str]:
    yield f"{'#' * each.depth} {each.name}\n"
    yield f"```python\n{each.signature}\n```\n"
    for title, lines in _sections(each.text):
        body = "\n".join(lines).strip("\n")
        if not body:
            continue
        heading = f"{TITLES.get(title, title)}:\n\n" if title else ""
        yield f"{heading}{_body(title, body)}\n"


def _sections(text: str) -> Iterator[tuple[str, list[str]]]:
    """A docstring's parts with their titles, the first of which has none; what is indented under a title."""
    title, lines = "", list[str]()
    for line in text.splitlines():
        found = SECTION.fullmatch(line)
        if found:
            yield title, lines
            title, lines = found[1], [found[2]] if found[2] else []
        else:
            lines.append(line.removeprefix("    ") if title else line)
    yield title, lines


def _body(title: str, body: str) -> str:
    if title == "Example":
        return f"```pycon\n{body}\n```"
    if title not in ("Args", "Attributes", "Raises"):
        return body
    items: list[str] = []
    for line in body.splitlines():
        found = None if line.startswith(" ") else ITEM.fullmatch(line)
        items.append(f"- `{found[1]}`: {found[2]}" if found else f"  {line.strip()}")
    return "\n".join(items)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
