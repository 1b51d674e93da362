"""Compiled functions give what the virtual machine gives, and only libraries of the user's own are loaded."""

from __future__ import annotations

import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp import codegen
from evodesign.nlp.codegen import CompiledFunctions, Library, compiled_functions, library
from evodesign.nlp.compiler import Compiler, NotCompiled, find_compiler
from evodesign.nlp.disk_cache import Cache, open_cache
from evodesign.nlp.method import SolverOptions
from evodesign.nlp.program import ConstraintBlock, Program, Variable
from evodesign.nlp.solver import RawSolution, Solver
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.problem.build import DesignProblem
from evodesign.records import Status
from tests.processes import wait_until_all_end

COMPILED = SolverOptions(compiled=True)


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache directory for one test."""
    monkeypatch.setenv("EVODESIGN_CACHE", str(tmp_path / "home"))
    return tmp_path / "home" / "functions"


@pytest.fixture
def cache(home: Path) -> Cache:
    return open_cache(home)


@pytest.fixture
def compiler() -> Compiler:
    found = find_compiler(os.environ)
    assert isinstance(found, Compiler), "these tests need a C compiler"
    return found


@pytest.fixture
def count(tmp_path: Path, compiler: Compiler, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file that gets a line whenever the compiler that $CC names compiles."""
    lines = tmp_path / "count"
    lines.touch()
    body = f'case "$*" in *--version*) ;; *) echo called >> {lines} ;; esac\nexec {compiler.command[0]} "$@"'
    monkeypatch.setenv("CC", str(script(tmp_path / "counting-cc", body)))
    return lines


def script(path: Path, body: str) -> Path:
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o700)
    return path


def calls(count: Path) -> int:
    return len(count.read_text().splitlines())


def program(radius: float) -> Program:
    """Rosenbrock's valley in a disc, rotated, so that sines and square roots are compiled too."""
    x = Variable.column("x", [-5.0, -5.0], [5.0, 5.0], [-1.2, 1.0], 2.0)
    weight = ca.SX.sym("weight")
    turn = ca.sin(0.3 * x.value[0])
    a, b = x.value[0], x.value[1] + turn
    cost = (1.0 - a) ** 2 + weight * (b - a**2) ** 2
    return Program(
        "valley", (x,), (ConstraintBlock("disc", ca.norm_2(x.value), 0.1, radius),), cost, {"weight": weight}
    )


def nlp(radius: float) -> Mapping[str, Any]:
    made = program(radius)
    (block,), (disc,) = made.variables, made.constraints
    return {"x": block.symbol, "p": made.given, "f": made.cost + radius, "g": disc.expression}


def solved(solver: Solver) -> RawSolution:
    return solver.solve({"weight": 100.0}, solver.start)


def same(one: RawSolution, other: RawSolution) -> bool:
    assert one.status is other.status is Status.SOLVED
    equal = all(np.array_equal(value, other.values[name]) for name, value in one.values.items())
    return equal and (one.cost, one.iterations) == (other.cost, other.iterations)


def fresh(found: Library | NotCompiled) -> bool:
    assert isinstance(found, Library), found
    return found.fresh


@pytest.mark.needs_compiler
@pytest.mark.usefixtures("home")
def test_compiled_and_virtual_machine_solve_alike_to_the_last_bit() -> None:
    compiled = Solver(program(1.3), COMPILED)
    assert isinstance(compiled.functions, CompiledFunctions)
    assert same(solved(compiled), solved(Solver(program(1.3), SolverOptions())))


@pytest.mark.needs_compiler
def test_library_holds_the_exact_derivatives(cache: Cache, compiler: Compiler) -> None:
    """Closed forms for f = p x0^3 x1, g = x0^2 + x1^4."""
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p")
    simple = {"x": x, "p": p, "f": p * x[0] ** 3 * x[1], "g": x[0] ** 2 + x[1] ** 4}
    found = library(simple, compiler, cache)
    assert isinstance(found, Library)
    at, weight, cost, price = np.array([2.0, 3.0]), 5.0, 0.5, 7.0
    _, jacobian = ca.external("nlp_jac_g", str(found.path))(at, weight)
    assert np.allclose(jacobian.toarray(), [[4.0, 108.0]])
    _, gradient = ca.external("nlp_grad_f", str(found.path))(at, weight)
    assert np.allclose(gradient.toarray().ravel(), [5.0 * 12.0 * 3.0, 5.0 * 8.0])
    hessian = ca.external("nlp_hess_l", str(found.path))(at, weight, cost, price)
    expected = [[cost * 5.0 * 36.0 + price * 2.0, cost * 5.0 * 12.0], [0.0, price * 12.0 * 9.0]]
    assert np.allclose(hessian.toarray(), expected)
    _, _, _, by_weight = ca.external("nlp_grad", str(found.path))(at, weight, cost, price)
    assert float(by_weight) == pytest.approx(cost * 24.0)


@pytest.mark.needs_compiler
@pytest.mark.usefixtures("home")
@pytest.mark.slow
def test_compiled_reach_of_the_default_problem_is_the_same(problem: DesignProblem) -> None:
    """One real compilation: about six seconds."""
    reaches = [
        ReachProblem(Setting(problem.scene, problem.space, problem.weights, options), symmetric=True)
        for options in (SolverOptions(), COMPILED)
    ]
    assert isinstance(reaches[1]._solver.functions, CompiledFunctions)
    for share in (0.4, 0.7):
        values = [(1.0 - share) * p.lower + share * p.upper for p in problem.space.parameters]
        virtual, compiled = (reach.solve(values) for reach in reaches)
        assert virtual.status is Status.SOLVED
        assert compiled == virtual


@pytest.mark.needs_compiler
@pytest.mark.usefixtures("home")
def test_second_process_start_does_not_compile(count: Path) -> None:
    first, second = Solver(program(1.3), COMPILED), Solver(program(1.3), COMPILED)
    assert calls(count) == 1
    for solver, expected in ((first, True), (second, False)):
        assert isinstance(solver.functions, CompiledFunctions)
        assert solver.functions.library.fresh is expected
    assert same(solved(first), solved(second))


@pytest.mark.needs_compiler
def test_other_program_or_compiler_is_another_library(cache: Cache, compiler: Compiler) -> None:
    newer = Compiler(compiler.command, compiler.version + " and a bit")
    slower = Compiler((*compiler.command, "-g"), compiler.version)
    found = [
        library(nlp(1.0), compiler, cache),
        library(nlp(2.0), compiler, cache),
        library(nlp(1.0), newer, cache),
        library(nlp(1.0), slower, cache),
    ]
    assert all(fresh(each) for each in found)
    assert not fresh(library(nlp(2.0), compiler, cache))


def damage(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def open_to_others(path: Path) -> None:
    path.chmod(0o666)


def give_away(path: Path) -> None:
    if os.getuid() != 0:
        pytest.skip("only root can give a file away")
    os.chown(path, 12345, 12345)


@pytest.mark.needs_compiler
@pytest.mark.parametrize("harm", [damage, open_to_others, give_away])
def test_damaged_or_foreign_library_is_built_again(harm: Any, cache: Cache, compiler: Compiler) -> None:
    first = library(nlp(1.0), compiler, cache)
    assert isinstance(first, Library)
    content = first.path.read_bytes()
    harm(first.path)
    second = library(nlp(1.0), compiler, cache)
    assert isinstance(second, Library)
    assert second.fresh
    assert second.path.read_bytes() == content
    assert second.path.stat().st_uid == os.getuid()
    assert second.path.stat().st_mode & 0o777 == 0o600
    assert not fresh(library(nlp(1.0), compiler, cache))


@pytest.mark.needs_compiler
def test_nothing_but_libraries_and_locks_is_left(cache: Cache, compiler: Compiler) -> None:
    found = library(nlp(1.0), compiler, cache)
    assert isinstance(found, Library)
    assert {path.suffix == ".lock" or path == found.path for path in cache.directory.iterdir()} == {True}


@pytest.mark.needs_compiler
def test_what_cannot_be_loaded_is_a_reason(home: Path, compiler: Compiler) -> None:
    key = codegen._key(codegen._of(nlp(1.0)), codegen.FUNCTION_FLAGS, compiler)
    open_cache(home).store(key, b"not a library")
    found = compiled_functions(nlp(1.0))
    assert isinstance(found, NotCompiled)
    assert "could not be loaded" in found.reason


@pytest.mark.usefixtures("home")
def test_without_compiler_the_virtual_machine_solves_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "nocc -m64")
    solver = Solver(program(1.3), COMPILED)
    assert solver.functions == NotCompiled("no C compiler found ($CC names 'nocc -m64')")
    assert same(solved(solver), solved(Solver(program(1.3), SolverOptions())))


@pytest.mark.usefixtures("home")
def test_failing_compiler_is_quoted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    body = 'case "$*" in *--version*) echo 1 ;; *) echo "f.c:1: error: too tired"; echo bye; exit 3 ;; esac'
    monkeypatch.setenv("CC", str(script(tmp_path / "tired-cc", body)))
    solver = Solver(program(1.3), COMPILED)
    assert isinstance(solver.functions, NotCompiled)
    assert solver.functions.reason.endswith("tired-cc failed (3): f.c:1: error: too tired")
    assert solved(solver).status is Status.SOLVED


def test_compiler_that_writes_nothing_is_a_reason(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", str(script(tmp_path / "lazy-cc", "exit 0")))
    found = compiled_functions(nlp(1.0))
    assert isinstance(found, NotCompiled)
    assert "No such file" in found.reason
    assert not [path for path in home.iterdir() if path.suffix != ".lock"]


@pytest.mark.usefixtures("home")
def test_a_compiler_is_held_to_its_processor_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the system, so that none goes on for hours beside a process that was killed."""
    body = 'case "$*" in *--version*) echo 1 ;; *) echo "error: $(ulimit -t) s"; exit 3 ;; esac'
    monkeypatch.setenv("CC", str(script(tmp_path / "honest-cc", body)))
    found = compiled_functions(nlp(1.0))
    assert isinstance(found, NotCompiled)
    assert found.reason.endswith(f"error: {codegen.COMPILING_LIMIT:.0f} s")


@pytest.mark.usefixtures("home")
def test_slow_compiler_is_stopped_with_what_it_started(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started = tmp_path / "started"
    body = f'case "$*" in *--version*) echo 1 ;; *) sleep 3600 & echo $! > {started}; wait ;; esac'
    monkeypatch.setenv("CC", str(script(tmp_path / "slow-cc", body)))
    for limit in (0.3, 3.0, 30.0):  # a busy machine may take a while to start anything
        monkeypatch.setattr(codegen, "COMPILING_LIMIT", limit)
        found = compiled_functions(nlp(1.0))
        assert isinstance(found, NotCompiled)
        assert found.reason.endswith(f"slow-cc did not finish within {limit:g} s")
        if started.exists() and started.read_text():
            break
    wait_until_all_end({int(started.read_text())})


def solve_compiled(radius: float) -> tuple[bool, float]:
    """In another process: whether functions are compiled, and the optimal cost."""
    solver = Solver(program(radius), COMPILED)
    return isinstance(solver.functions, CompiledFunctions), solved(solver).cost


@pytest.mark.needs_compiler
@pytest.mark.usefixtures("home")
def test_processes_that_start_together_compile_once(count: Path) -> None:
    with ProcessPoolExecutor(3, mp_context=get_context("spawn")) as pool:
        found = set(pool.map(solve_compiled, [1.3] * 3))
    assert found == {(True, solved(Solver(program(1.3), SolverOptions())).cost)}
    assert calls(count) == 1


@pytest.mark.needs_compiler
def test_without_locks_processes_still_succeed(
    cache: Cache, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both find nothing and both compile: the second library replaces the first, byte for byte the same."""
    first = library(nlp(1.0), compiler, cache)
    monkeypatch.setattr(Cache, "find", lambda *_: None)
    assert library(nlp(1.0), compiler, cache) == first


@pytest.mark.needs_compiler
def test_whoever_waited_for_a_failure_does_not_repeat_it(
    cache: Cache, compiler: Compiler, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("evodesign.nlp.disk_cache._acquire", lambda _: True)
    found = library(nlp(1.0), compiler, cache)
    assert found == NotCompiled("another process tried to compile the same functions and failed")
