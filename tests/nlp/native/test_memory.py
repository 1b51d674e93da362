"""The method in C under sanitizers: addresses, undefined behaviour, and numbers that were never written."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from evodesign.nlp.compiler import Compiler, find_compiler
from evodesign.nlp.native.program_code import HERE, METHOD_FILES, program_text
from tests.machine import memory_sanitizer
from tests.nlp.native.programs import random_program

pytestmark = pytest.mark.slow

SANITIZED = ("-std=gnu11", "-g", "-O1", "-fno-sanitize-recover=all")

ZEROED = "memset(system, 0, sizeof(double) * p->system_starts[s->unknowns]);"

KINDS = pytest.mark.parametrize("convex", [True, False], ids=["convex", "curved"])


@pytest.mark.needs_compiler
@KINDS
def test_addresses_and_operations_are_sound(convex: bool, tmp_path: Path) -> None:
    compiler = find_compiler({"PATH": "/usr/bin:/usr/local/bin:/bin"})
    assert isinstance(compiler, Compiler)
    done = watched([*compiler.command, "-fsanitize=address,undefined"], tmp_path, convex=convex)
    assert_solved(done)


@pytest.mark.needs_clang
@KINDS
def test_no_number_is_used_before_it_is_written(convex: bool, tmp_path: Path) -> None:
    assert_solved(watched([*memory_sanitizer(), "-fsanitize-memory-track-origins"], tmp_path, convex=convex))


@pytest.mark.needs_clang
def test_a_number_that_was_never_written_is_noticed(tmp_path: Path) -> None:
    """The sanitizer sees into the method's own memory: it misses what is left out."""
    done = watched([*memory_sanitizer()], tmp_path, convex=True, left_out=ZEROED)
    assert done.returncode != 0
    assert "use-of-uninitialized-value" in done.stderr


def watched(
    compile_with: list[str], folder: Path, *, convex: bool, left_out: str = ""
) -> subprocess.CompletedProcess[str]:
    """The end of `watched.c` over a random program; something may be left out of the method."""
    random = random_program(5, convex=convex)
    for name in METHOD_FILES:
        text = (HERE / name).read_text()
        (folder / name).write_text(text.replace("= calloc(", "= unwritten(").replace(left_out or "\0", ""))
    header = folder / "interior_point.h"
    header.write_text(f"#include <stddef.h>\nvoid *unwritten(size_t, size_t);\n{header.read_text()}")
    (folder / "functions.c").write_text(program_text(random.program))
    driver = (Path(__file__).parent / "watched.c").read_text()
    (folder / "main.c").write_text(driver.replace("NUMBERS", str(random.numbers)))
    sources = [str(path) for path in sorted(folder.glob("*.c"))]
    target = folder / "watched"
    built = subprocess.run(
        [*compile_with, *SANITIZED, *sources, "-o", target, "-lm"], capture_output=True, text=True
    )
    assert built.returncode == 0, built.stderr
    return subprocess.run([target], capture_output=True, text=True, timeout=300)


def assert_solved(done: subprocess.CompletedProcess[str]) -> None:
    """Nothing was found, and most draws were solved, but not all of them."""
    assert done.returncode == 0, done.stderr
    solved, failed = map(int, done.stdout.split())
    assert solved > 100
    assert failed > 0
