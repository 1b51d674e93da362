"""Data have one digest exactly if they are alike; code has another after any change of what it stands on."""

from __future__ import annotations

import ast
import importlib
import json
import math
import shutil
import struct
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum, StrEnum
from functools import cache
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign import identity
from evodesign.identity import code_digest, digest, import_closure
from evodesign.problem.build import DesignProblem
from tests.rewriting import write_anew

EVALUATING = ("evodesign.evaluation.evaluate", "evodesign.evaluation.precompute")
PIECES = "evodesign.posture.precompute.pieces"


class Colour(StrEnum):
    RED = "red"
    BLUE = "blue"


class Shade(StrEnum):
    RED = "red"


@dataclass(frozen=True, slots=True)
class Inner:
    number: float = 0.0
    words: tuple[Any, ...] = ()


@dataclass(frozen=True, slots=True)
class Outer:
    inner: Inner
    name: str = ""


@dataclass(frozen=True, slots=True)
class Other:
    number: float = 0.0
    words: tuple[Any, ...] = ()


class Row(msgspec.Struct, frozen=True):
    number: float = 0.0
    words: tuple[Any, ...] = ()


@dataclass
class Changeable:
    number: float = 0.0


class ChangeableRow(msgspec.Struct):
    number: float = 0.0


def alike(value: Any) -> Any:
    """An independent form of data, equal exactly where they are alike."""
    kind = type(value).__qualname__
    match value:
        case Enum():
            return kind, value.name
        case float():
            return kind, struct.pack("<d", value)
        case tuple() | list():
            return kind, tuple(alike(part) for part in value)
        case dict():
            return "map", frozenset((alike(key), alike(part)) for key, part in value.items())
        case frozenset():
            return kind, frozenset(alike(part) for part in value)
        case np.ndarray():
            return kind, value.dtype.str, value.shape, tuple(alike(part) for part in value.ravel().tolist())
        case Inner() | Other() | Row():
            return kind, alike(value.number), alike(value.words)
    return kind, value


NUMBERS = st.sampled_from([0, 1, 0.0, -0.0, 1.0, math.nan, math.inf, True, False])
WORDS = st.sampled_from(["", "1", "1:", "s1:1", "ab", "a", "b", "\udcff", b"", b"1", b"ab"])
LEAVES = NUMBERS | WORDS | st.sampled_from([None, Colour.RED, Colour.BLUE, Shade.RED, "red"])
KEYS = st.sampled_from(["a", "b", 1, 2, Colour.BLUE, None, ("a", 1)])
ARRAYS = st.sampled_from([np.zeros(2), np.zeros((2, 1)), np.zeros(2, int), np.array([0.0, -0.0])])
DATA = st.recursive(
    LEAVES | ARRAYS,
    lambda parts: (
        st.lists(parts, max_size=2)
        | st.lists(parts, max_size=2).map(tuple)
        | st.dictionaries(KEYS, parts, max_size=2)
        | st.frozensets(WORDS, max_size=2)
        | st.builds(Inner, NUMBERS, st.tuples(parts))
        | st.builds(Other, NUMBERS, st.tuples(parts))
        | st.builds(Row, NUMBERS, st.tuples(parts))
    ),
    max_leaves=4,
)


@given(DATA, DATA)
def test_data_have_one_digest_exactly_if_they_are_alike(one: Any, other: Any) -> None:
    assert (digest(one) == digest(other)) is (alike(one) == alike(other))


def test_a_record_in_several_places_counts_in_each() -> None:
    one = Outer(Inner(1.0), "a")
    assert digest((one, one, one.inner)) == digest((Outer(Inner(1.0), "a"), replace(one), Inner(1.0)))
    assert digest((one, one)) != digest((one, replace(one, name="b")))
    without = {Outer: {"name": "for this test"}}
    assert digest((one, one), without=without) == digest((one, replace(one, name="b")), without=without)


def test_values_that_are_equal_or_look_so_differ_by_type() -> None:
    values = [1, 1.0, True, "1", b"1", (1,), [1], {1: 1}, {1}, {1: None}, np.float64(1.0), np.array([1.0])]
    values += [0.0, -0.0, "red", Colour.RED, Shade.RED, Inner(), Other(), Row(), None, "", (), msgspec.UNSET]
    assert len({digest(value) for value in values}) == len(values)


def test_the_order_of_mappings_and_sets_does_not_count() -> None:
    assert digest({"a": 1, "b": 2}) == digest({"b": 2, "a": 1})
    assert digest({"a", "b", "c"}) == digest({"c", "b", "a"})
    assert digest((1, 2)) != digest((2, 1))


def test_nan_is_itself() -> None:
    assert digest(math.nan) == digest(float("nan"))


def test_what_a_record_works_out_for_itself_does_not_count(problem: DesignProblem) -> None:
    tree = replace(problem.scene.robot.tree)
    before = digest(tree)
    assert tree.link_by_name
    assert "link_by_name" in vars(tree)
    assert digest(tree) == before


OTHERS = [object(), len, Inner, Changeable(), ChangeableRow(), np.array([object()])]


@pytest.mark.parametrize("foreign", OTHERS)
def test_other_types_are_refused_by_name_and_place(foreign: object) -> None:
    value = {"found": Outer(Inner(words=("sound", foreign)))}
    with pytest.raises(TypeError, match=r"dict\['found'\]\.inner\.words\[1\]: .* the type ") as refused:
        digest(value)
    assert str(refused.value).endswith(type(foreign).__name__)


def test_data_that_contain_themselves_are_refused() -> None:
    endless: list[object] = []
    endless.append(endless)
    with pytest.raises(RecursionError):
        digest(endless)


def test_a_field_that_is_named_does_not_count_and_the_others_do() -> None:
    without = {Inner: {"number": "for this test"}}
    assert digest(Outer(Inner(1.0)), without=without) == digest(Outer(Inner(2.0)), without=without)
    assert digest(Outer(Inner(1.0)), without=without) != digest(Outer(Inner(1.0, ("a",))), without=without)
    assert digest(Other(1.0), without=without) != digest(Other(2.0), without=without)
    with pytest.raises(ValueError, match="Inner has no field 'numbr'"):
        digest(Outer(Inner()), without={Inner: {"numbr": "misspelt"}})


def copied(tmp_path: Path) -> Path:
    skipped = shutil.ignore_patterns("__pycache__")
    return Path(shutil.copytree(identity.PACKAGE, tmp_path / "evodesign", ignore=skipped))


@pytest.mark.slow
def test_any_changed_line_below_is_another_code_and_none_beside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(identity, "_release", cache(identity._release))  # releases stay as they are
    package = copied(tmp_path)
    closure = import_closure(package, *EVALUATING)
    before = closure.digest()
    assert before == code_digest(*EVALUATING)
    assert {"posture/precompute/pieces.py", "human/data/strength.toml", "__init__.py"} <= closure.files.keys()
    for name, path in closure.files.items():
        content = path.read_bytes()
        write_anew(path, content + b"\n")
        assert closure.digest() != before, name
        write_anew(path, content)
    beside = {path.relative_to(package).as_posix() for path in package.rglob("*.*")} - closure.files.keys()
    assert {"cli/main.py", "report/page/content.py", "searches/nsga2.py", "evolve.py"} <= beside
    for name in beside:
        write_anew(package / name, b"\n")
    assert import_closure(package, *EVALUATING).digest() == before


def test_another_release_of_a_package_is_another_code(monkeypatch: pytest.MonkeyPatch) -> None:
    closure = import_closure(identity.PACKAGE, *EVALUATING)
    assert {"casadi", "numpy", "pinocchio", "msgspec"} <= closure.foreign
    assert all(identity._release(name) for name in closure.foreign)
    before, real = closure.digest(), identity._release
    for one in closure.foreign:
        monkeypatch.setattr(identity, "_release", lambda name, one=one: "0" if name == one else real(name))
        assert closure.digest() != before, one


def test_a_package_imported_under_another_name_has_its_version(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert identity._release("pinocchio") == importlib.import_module("pinocchio").__version__
    assert identity._release("no_such_package") is None
    (tmp_path / "loner.py").touch()
    monkeypatch.syspath_prepend(str(tmp_path))
    time = identity._release("loner")
    assert time == str((tmp_path / "loner.py").stat().st_mtime_ns), "no distribution holds it"


def test_a_module_that_does_not_exist_is_refused() -> None:
    with pytest.raises(KeyError, match=r"evodesign\.nothing"):
        code_digest("evodesign.nothing")


LOADED = """
import json, sys
from importlib import import_module
from pathlib import Path
for name in {modules}:
    import_module(name)
if {evaluating}:  # what is imported within functions
    source = import_module("evodesign.problem.source").read_source(Path("problems/shared_lifting.toml"))
    del sys.modules["evodesign.problem.source"]
    sys.modules["evodesign.problem.build"].build_problem(source)
inside = [(name, m.__file__) for name, m in sys.modules.items() if name.partition(".")[0] == "evodesign"]
print(json.dumps(dict(inside)))
"""


@pytest.mark.parametrize("modules", [EVALUATING, (PIECES,), ("evodesign.evaluation.baseline",)])
def test_the_closure_holds_all_that_is_loaded(modules: tuple[str, ...], repository: Path) -> None:
    program = LOADED.format(modules=modules, evaluating=modules == EVALUATING)
    done = subprocess.run([sys.executable, "-c", program], cwd=repository, capture_output=True, check=True)
    loaded = json.loads(done.stdout)
    assert set(modules) <= loaded.keys()
    missing = {Path(path) for path in loaded.values()} - set(
        import_closure(identity.PACKAGE, *modules).files.values()
    )
    assert not missing


def parsed_imports(source: Path) -> Iterator[tuple[str, list[str]]]:
    """What a module imports by its syntax, with the names that it takes from there."""
    tree = ast.parse(source.read_text())
    conditions = [node for node in tree.body if isinstance(node, ast.If)]
    typing = [node for node in conditions if ast.unparse(node.test) == "TYPE_CHECKING"]
    never = {id(inner) for node in typing for inner in ast.walk(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import) and id(node) not in never:
            yield from ((alias.name, []) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and id(node) not in never:
            assert node.level == 0, f"{source}: a relative import, which closures do not follow"
            yield node.module or "", [alias.name for alias in node.names]


def test_imports_are_those_of_the_syntax_tree() -> None:
    for path in identity.PACKAGE.rglob("*.py"):
        pairs = list(parsed_imports(path))
        parsed = {home for home, _ in pairs} | {f"{home}.{name}" for home, names in pairs for name in names}
        found = set(identity._imported(path))
        assert parsed <= found, path
        assert {name.split(".")[0] for name in found} == {name.split(".")[0] for name in parsed}, path


def test_no_module_below_is_imported_by_a_text() -> None:
    """A closure cannot follow such imports; only the package's own `__init__` has one, for those outside."""
    texts = {path: path.read_text() for path in identity.PACKAGE.rglob("*.py") if path.name != "identity.py"}
    dynamic = [path for path, text in texts.items() if "import_module(" in text or "__import__(" in text]
    assert dynamic == [identity.PACKAGE / "__init__.py"]
