"""Reading a problem and the files that it names: as text, and strictly decoded into tables.

Errors name file, key, what was wanted and what was found, so that a user can act on them.

Beyond 300 lines: one function for each thing that can be wrong with a text.
"""

from __future__ import annotations

import copy
import functools
import math
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from enum import StrEnum
from pathlib import Path
from typing import Any, TypeVar, get_args

import msgspec
import tomli_w

from evodesign.errors import InputError, offered, shortened
from evodesign.files import is_there
from evodesign.problem.file import ProblemFile
from evodesign.problem.meshes import mesh_texts
from evodesign.problem.named_files import read_robot, read_text
from evodesign.problem.shipped import SHIPPED, problem_path
from evodesign.problem.table import FILL_IN, struct_in
from evodesign.records import ProblemSource

GIVEN = "the problem given"
"""What messages call a problem that no file holds."""


def read_source(problem: str | os.PathLike[str], symmetry: str | None = None) -> ProblemSource:
    """A problem file and every file it names, as text.

    Args:
        problem: path of the problem file, or name of a problem that comes with evodesign.
        symmetry: of postures, in place of the file's; None leaves it to the file.
    Raises:
        InputError: a file is missing or is not UTF-8 text, or the problem file does not decode.
    """
    path = problem_path(problem)
    return _source(read_text(path, str(path), ""), str(path), path.parent, symmetry)


def source_of(
    tables: Mapping[str, Any], folder: str | os.PathLike[str] = ".", symmetry: str | None = None
) -> ProblemSource:
    """The tables of a problem file, given as dictionaries, with every file they name.

    Args:
        tables: as in a problem file: `{"name": .., "robot": {"urdf": ..}, ..}`.
        folder: from which the files are named; robots that come with evodesign are found from anywhere.
        symmetry: as in `read_source`.
    Raises:
        InputError: as `read_source`; or a value that TOML does not have.
    """
    try:
        text = tomli_w.dumps(msgspec.to_builtins(dict(tables), enc_hook=_plain))
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(GIVEN, "", "values that TOML has", f"{error}") from error
    return _source(text, GIVEN, Path(folder), symmetry)


def _plain(value: Any) -> Any:
    """A path as text, an array as a list, a NumPy number as one of Python."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a value of type {type(value).__name__}")


def _source(text: str, source: str, folder: Path, symmetry: str | None) -> ProblemSource:
    tables = decode_toml(text, source, ProblemFile)
    named = {key: table.urdf for key, table in tables.robots.items()}
    people = {key: table.urdf for key, table in tables.people.items() if table.urdf is not None}
    models = {
        name: read_robot(_named(folder, name), name, source, f"{key}.urdf")
        for key, name in {**named, **people}.items()
    }
    files = {name: model.urdf for name, model in models.items()}
    if tables.search.start is not None:
        start = tables.search.start
        files[start] = read_text(_named(folder, start), source, "search.start")
    for key, table in tables.robots.items():
        file = _named(folder, table.urdf)
        files |= mesh_texts(table, file, models[table.urdf], folder, source, f"{key}.urdf")
    return ProblemSource(path=source, text=text, files=files, symmetry=symmetry)


def _named(folder: Path, name: str) -> Path:
    """A file that a problem names: from its folder, or else one of those that come with evodesign."""
    path = folder / name
    shipped = SHIPPED / name
    return shipped if is_there(shipped) and not is_there(path) else path


RENAMED = {"policy": "allocation", "seeds": "start_portfolio"}
"""Keys of earlier versions, and what they are called now."""

UNBOUNDED = frozenset({"hand_moment_n_m"})
"""Keys whose value may be `inf`: no bound."""

LONGEST_TEXT, LONGEST_LINE, MOST_DOTS = 1_000_000, 10_000, 100_000
"""Letters of a TOML file and of its lines, and dots in all its keys: each takes 1 kB to read."""

DEEPEST = 16
"""Tables and arrays inside each other, and dotted parts of a key; a problem has four."""

PART = r"""(?:[\w-]+|"(?:\\.|[^"\\\n])*+"?|'[^'\n]*+'?)"""
TOKEN = re.compile(
    r"""\"{3}(?s:\\.|[^\\])*?(?:\"{3,5}|\Z)|'{3}(?s:.)*?(?:'{3,5}|\Z)|\#[^\n]*"""
    rf"|(?P<key>{PART}(?:[ \t]*+\.[ \t]*+{PART})*+)"
)
"""Texts of several lines, comments, and keys: a number or text in one line looks like a key of few parts."""

T = TypeVar("T", bound=msgspec.Struct)


def decode_toml(text: str, source: str, table: type[T]) -> T:
    """Decode TOML text into a table.

    Args:
        text: the file's text.
        source: the file's name, for messages.
        table: a strict msgspec struct.
    Raises:
        InputError: broken TOML, unknown key, wrong type, value out of range, number that is not finite.
    """
    _refuse_size(text, source)
    try:
        raw = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # a ValueError for an integer of thousands of digits
        raise InputError(source, "", "valid TOML", str(error) or "tables nested too deeply") from error
    _refuse_depth(raw, source)
    _refuse_unknown_keys(raw, table, source, "")
    for key, value in _leaves(raw, ""):
        unbounded = value == math.inf and key.rpartition(".")[2] in UNBOUNDED
        if isinstance(value, float) and not math.isfinite(value) and not unbounded:
            raise InputError(source, key, "a finite number", repr(value))
    if unknown := [key for key, value in _leaves(raw, "") if value == FILL_IN]:
        wanted = "what could not be guessed (the comment beside it has the reason)"
        raise InputError(source, ", ".join(unknown), wanted, f"'{FILL_IN}'")
    try:
        return msgspec.convert(raw, table)
    except msgspec.ValidationError as error:
        raise _explained(error, raw, source, table) from error


def _refuse_size(text: str, source: str) -> None:
    """Refuse a text that would take long, or much memory, to decode; the parser has no limits of its own."""
    if len(text) > LONGEST_TEXT:
        raise InputError(source, "", f"TOML of at most {LONGEST_TEXT} letters", f"{len(text)}")
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > LONGEST_LINE:
            raise InputError(source, f"line {number}", f"at most {LONGEST_LINE} letters", f"{len(line)}")
    dots = 0
    for token in TOKEN.finditer(text):
        parts = len(re.findall(PART, token["key"] or ""))
        dots += max(0, parts - 1)
        if parts > DEEPEST:
            raise InputError(source, token["key"], f"a key of at most {DEEPEST} dotted parts", f"{parts}")
    if dots > MOST_DOTS:
        raise InputError(source, "", f"at most {MOST_DOTS} dots in keys and numbers", f"{dots}")


def _refuse_depth(raw: Any, source: str) -> None:
    """Refuse nesting that no table asks for: dotted keys nest without limit, and what follows recurs."""
    layer = [raw]
    for _ in range(DEEPEST):
        layer = [
            inner
            for outer in layer
            if isinstance(outer, dict | list)
            for inner in (outer.values() if isinstance(outer, dict) else outer)
        ]
    if layer:
        raise InputError(source, "", f"tables nested at most {DEEPEST} deep", "deeper ones")


def _refuse_unknown_keys(raw: Any, kind: Any, source: str, prefix: str) -> None:
    if isinstance(raw, list):
        for position, item in enumerate(raw):
            _refuse_unknown_keys(item, kind, source, f"{prefix}[{position}]")
        return
    if not isinstance(raw, dict):
        return
    if getattr(kind, "__origin__", None) is dict:
        for key, value in raw.items():
            _refuse_unknown_keys(value, get_args(kind)[1], source, f"{prefix}.{key}")
        return
    struct = struct_in(kind)
    if struct is None:
        return
    fields = _fields(struct)
    for key, value in raw.items():
        path = f"{prefix}.{key}" if prefix else key
        if key not in fields:
            known, found = offered(fields, key)
            now = RENAMED.get(key)
            found = f"'{key}'; it is called '{now}' now" if now in fields else found
            raise InputError(source, path, f"one of the keys {known}", found)
        _refuse_unknown_keys(value, fields[key], source, path)


@functools.cache
def _fields(table: type[msgspec.Struct]) -> Mapping[str, Any]:
    """The types of a table's values by their keys."""
    return {field.encode_name: field.type for field in msgspec.structs.fields(table)}


def _leaves(raw: Any, path: str) -> Iterator[tuple[str, Any]]:
    if isinstance(raw, dict):
        for key, value in raw.items():
            yield from _leaves(value, f"{path}.{key}" if path else key)
    elif isinstance(raw, list):
        for position, value in enumerate(raw):
            yield from _leaves(value, f"{path}[{position}]")
    else:
        yield path, raw


def _explained(error: msgspec.ValidationError, raw: Any, source: str, table: type[T]) -> InputError:
    """The library's message, taken apart into key, wanted and found."""
    text = str(error)
    match = re.fullmatch(r"(.*?)(?: - at `(?:key in )?\$\.?(.*)`)?", text, re.DOTALL)
    message, key = (match.group(1), match.group(2) or "") if match else (text, "")
    key = _with_free_key(key, raw, table)
    missing = re.fullmatch(r"Object missing required field `(.*)`", message)
    if missing:
        where = f"{key}.{missing.group(1)}" if key else missing.group(1)
        return InputError(source, where, "this key", "nothing")
    wanted = re.sub(r", got .*", "", message.removeprefix("Expected ")).replace("`", "")
    wanted = re.sub(r"\b(null|float|int|str|bool|object|array)\b", lambda word: WORDS[word[0]], wanted)
    wanted = wanted.removesuffix(" | ").replace(" | ", " or ")
    if wanted.startswith("Invalid enum value"):
        words = _words_at(table, key)
        known = f"one of {', '.join(words)}" if words else "another word than"
        wanted = known if words else wanted.replace("Invalid enum value", known)
    return InputError(source, key, wanted, shortened(repr(_at(raw, key))))


WORDS = {
    "float": "a number",
    "int": "a whole number",
    "str": "text",
    "bool": "true or false",
    "object": "a table",
    "array": "a list",
    "null": "",
}
"""What the library calls in the words of programmers; a key is left out where its value may be null."""


def _words_at(table: type[msgspec.Struct], key: str) -> list[str]:
    """The words that may stand at a key; none where any may."""
    kind: Any = table
    for name in re.findall(r"[^.\[\]]+(?![^\[]*\])", key):
        struct = struct_in(kind)
        if struct is None or name not in _fields(struct):
            return []
        kind = _fields(struct)[name]
    return [*map(str, _enum_in(kind) or ())]


def _enum_in(kind: Any) -> type[StrEnum] | None:
    """The words inside an annotation such as `X | None` or `tuple[X, ...]`."""
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return kind
    return next((found for part in get_args(kind) if (found := _enum_in(part))), None)


FREE = "[...]"
"""What the library says in place of a key that a user chose."""


def _with_free_key(key: str, raw: Any, table: type[T]) -> str:
    """The place of an error with the key of a free table: the one that is wrong by itself."""
    before, free, after = key.partition(FREE)
    for name in _at(raw, before) if free else ():
        alone = copy.deepcopy(raw)
        place = _at(alone, before)
        kept = {name: place[name]}
        place.clear()
        place.update(kept)
        try:
            msgspec.convert(alone, table)
        except msgspec.ValidationError as error:
            if FREE in str(error):
                return f"{before}.{name}{after}"
    return key.replace(FREE, "")


def _at(raw: Any, key: str) -> Any:
    for name, position in re.findall(r"([^.\[\]]+)|\[(\d+)\]", key):
        try:
            raw = raw[name] if name else raw[int(position)]
        except (KeyError, IndexError, TypeError):
            return None
    return raw
