"""What identifies data and code: digests under which results are kept.

Data counts whole. Every field of a record enters its digest by itself, whenever it was added; what does not
count is named, with the reason. Each value begins with a letter for its type and says how long it is:

    digest = SHA-256 of code(value)        code(a) = code(b)  exactly if  a and b are alike

so 1, 1.0, True and "1" differ, as do a list and a tuple. Floats are alike if all their bits are: nan is
itself, and -0.0 is not 0.0. The order of mappings and sets does not count, nor do properties.

Code counts by its import closure: the source of every module of the package that a module imports, in
functions too, the data files beside them, and the versions of Python and of the packages that they import.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import platform
import re
import struct
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from importlib.metadata import PackageNotFoundError, distributions, version
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType
from typing import Any

import msgspec
import numpy as np

Exceptions = Mapping[type, Mapping[str, str]]
"""Fields that do not count, by the record's class and the field's name, each with the reason."""

NO_EXCEPTIONS: Exceptions = MappingProxyType({})

SCALARS: Mapping[type, Callable[[Any], bytes]] = {
    type(None): lambda _: b"N",
    msgspec.UnsetType: lambda _: b"U",
    bool: lambda value: b"T" if value else b"F",
    int: lambda value: b"i%d;" % value,
    float: lambda value: b"f" + struct.pack(">d", value),
    str: lambda value: _sized(b"s", value.encode(errors="surrogatepass")),
    bytes: lambda value: _sized(b"b", value),
}


Met = dict[int, tuple[object, bytes]]
"""Records by identity, with their codes; held, so that no other takes an identity of theirs."""


def digest(value: object, *, without: Exceptions = NO_EXCEPTIONS, met: Met | None = None) -> str:
    """Digest of data, as 64 hexadecimal digits.

    Args:
        value: frozen dataclasses and msgspec structs, enumerations, tuples, lists, mappings, sets, numpy
            arrays, text, bytes, numbers, booleans and None, in each other.
        without: fields that do not count, of exactly these classes.
        met: what digests with the same `without` have met, which is not looked at again; is added to.
    Raises:
        TypeError: a value of another type; it says which and where.
        RecursionError: data that contain themselves.
        ValueError: `without` names a field that its class lacks.
    """
    for kind, names in without.items():
        for name in set(names) - set(_field_names(kind) or ()):
            raise ValueError(f"{kind.__name__} has no field '{name}' that could be left out")
    return hashlib.sha256(_code(value, without, type(value).__name__, {} if met is None else met)).hexdigest()


def _code(value: Any, without: Exceptions, path: str, met: Met) -> bytes:
    kind: Any = type(value)
    if kind in SCALARS:
        return SCALARS[kind](value)
    if kind is tuple or kind is list:
        parts = [_code(part, without, f"{path}[{i}]", met) for i, part in enumerate(value)]
        return _counted(b"t" if kind is tuple else b"l", parts)
    if isinstance(value, Enum):
        return b"e" + _name(kind) + _code(value.value, without, path, met)
    if isinstance(value, Mapping):
        pairs = [(key, f"{path}[{key!r}]") for key in value]
        codes = [
            _code(key, without, place, met) + _code(value[key], without, place, met) for key, place in pairs
        ]
        return _counted(b"m", sorted(codes))
    if isinstance(value, set | frozenset):
        return _counted(b"S", sorted(_code(part, without, f"{path} element", met) for part in value))
    if isinstance(value, np.ndarray | np.generic) and value.dtype.kind not in "OV":
        return b"a" + _code((value.dtype.str, value.shape, value.tobytes()), without, path, met)
    names = _field_names(kind)
    if names is None:
        raise TypeError(f"{path}: wanted frozen data, found the type {kind.__name__}")
    if id(value) in met:
        return met[id(value)][1]
    left_out = without.get(kind, ())
    fields = [
        SCALARS[str](name) + _code(getattr(value, name), without, f"{path}.{name}", met)
        for name in names
        if name not in left_out
    ]
    code = _counted(b"r" + _name(kind), fields)
    met[id(value)] = (value, code)
    return code


def _sized(letter: bytes, content: bytes) -> bytes:
    return b"%b%d:%b" % (letter, len(content), content)


def _counted(letter: bytes, parts: list[bytes]) -> bytes:
    return b"%b%d:%b" % (letter, len(parts), b"".join(parts))


@functools.cache
def _name(kind: type[object]) -> bytes:
    return SCALARS[str](f"{kind.__module__}.{kind.__qualname__}")


@functools.cache
def _field_names(kind: type[object]) -> tuple[str, ...] | None:
    """Names of the fields of a frozen record; None for another type."""
    if issubclass(kind, msgspec.Struct):
        return kind.__struct_fields__ if kind.__struct_config__.frozen else None
    if dataclasses.is_dataclass(kind) and kind.__dataclass_params__.frozen:  # type: ignore[attr-defined]
        return tuple(field.name for field in dataclasses.fields(kind))
    return None


PACKAGE = Path(__file__).parent

IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]*(\([^)]*\)|.*)"
    r"|import[ \t]+([\w.]+)[ \t]*(?:as[ \t].*|#.*)?$)",
    re.MULTILINE,
)
"""An import statement anywhere in a module: parsing takes ten times longer and finds the same."""

FOR_TYPES_ALONE = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n|\n)+", re.MULTILINE)
"""Imports that never happen."""


@dataclass(frozen=True, slots=True)
class ImportClosure:
    """What modules of a package import, and what that imports, and so on.

    Args:
        files: sources of the package's modules, and the data files beside them, by their paths within it.
        foreign: top-level names of what is imported from elsewhere, the standard library left out.
    """

    files: Mapping[str, Path]
    foreign: frozenset[str]

    def digest(self) -> str:
        """Digest of the files, of Python's version and of the versions of what comes from elsewhere."""
        contents = {name: path.read_bytes() for name, path in self.files.items()}
        return digest((contents, {name: _release(name) for name in self.foreign}, platform.python_version()))


@functools.cache
def code_digest(*modules: str) -> str:
    """Digest of all the code that modules of evodesign run, as it is when the process first asks.

    Args:
        modules: their full names, such as `evodesign.evaluation.evaluate`.
    Raises:
        KeyError: there is no such module.
    """
    return import_closure(PACKAGE, *modules).digest()


def import_closure(package: Path, *modules: str) -> ImportClosure:
    """The import closure of some of a package's modules; imports within it must be absolute.

    Args:
        package: its directory.
        modules: their full names.
    Raises:
        KeyError: there is no such module.
    """
    inside = [path for path in package.rglob("*") if path.is_file() and path.suffix != ".pyc"]
    sources = {_module_name(path, package): path for path in inside if path.suffix == ".py"}
    found: dict[str, Path] = {}
    foreign: set[str] = set()
    waiting = set(modules)
    while waiting:
        name = waiting.pop()
        found[name] = sources[name]
        imported = {name for whole in (name, *_imported(found[name])) for name in _with_packages(whole)}
        waiting |= (imported & sources.keys()) - found.keys()
        foreign |= {name for name in imported if "." not in name}
    taken = set(found.values())
    data = [path for path in inside if path.suffix != ".py" and _init_above(path) in taken]
    return ImportClosure(
        files={path.relative_to(package).as_posix(): path for path in (*taken, *data)},
        foreign=frozenset(foreign - sys.stdlib_module_names - {package.name}),
    )


def _module_name(path: Path, package: Path) -> str:
    return ".".join(path.relative_to(package.parent).with_suffix("").parts).removesuffix(".__init__")


def _init_above(path: Path) -> Path:
    """The `__init__.py` of the package that a data file belongs to."""
    return next(found for above in path.parents if (found := above / "__init__.py").exists())


def _imported(source: Path) -> Iterator[str]:
    """Full names of what a module imports; some are of functions and classes."""
    text = FOR_TYPES_ALONE.sub("", source.read_text(encoding="utf-8"))
    for home, names, module in IMPORT.findall(text):
        yield home or module
        yield from (f"{home}.{name}" for name in re.findall(r"\w+", names))


def _with_packages(name: str) -> Iterator[str]:
    """A full name and those of the packages above it."""
    parts = name.split(".")
    return (".".join(parts[:count]) for count in range(1, len(parts) + 1))


def _release(name: str) -> str | None:
    """Version of a package by the name under which it is imported; None where there is no such package.

    One that no distribution claims to hold goes by the time [ns] of its last change.
    """
    with suppress(PackageNotFoundError):
        return version(name)
    for found in distributions():  # such as pin, which is imported as pinocchio
        record = f"\n{found.read_text('RECORD')}"
        if any(f"{before}{name}/__init__.py," in record for before in ("\n", "/site-packages/")):
            return found.version
    spec = find_spec(name)
    return None if spec is None or spec.origin is None else str(Path(spec.origin).stat().st_mtime_ns)
