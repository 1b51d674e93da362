"""Functions that work on several arguments at once: in each lane the bits of the function itself."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.blocks import Block, Repeated
from evodesign.nlp.codegen import FUNCTION_FLAGS, Library
from evodesign.nlp.compiler import Compiler, find_compiler
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native import block_code
from evodesign.nlp.native.cut_functions import in_pieces
from evodesign.nlp.native.lanes import LANES, LANES_SYMBOL, in_lanes, lane_flags
from evodesign.nlp.repeated import RepeatedProgram
from tests.nlp.native.test_pieces import compiled

GCC = Compiler(("gcc",), "gcc 12\nCopyright (C) 2022 Free Software Foundation, Inc.")
CLANG = Compiler(("clang",), "clang version 14.0.6")

pytestmark = pytest.mark.needs_compiler


def said(seen: ca.SX, own: ca.SX, shared: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Every operation that lanes know, and a constant as a result."""
    cost = ca.sumsqr(seen - shared) + ca.sin(seen[0]) * seen[3] + ca.sqrt(2.0 + own) * seen[1] ** 2
    cost += ca.exp(-(seen[2] ** 2)) + (3.0 + seen[0] ** 2) ** 1.5 + ca.log(5.0 + seen[3] ** 2) + ca.fabs(own)
    return cost, ca.vertcat(seen[0] * seen[2] + ca.cos(seen[1]), seen[3] ** 2, seen[0])


def block(number: int) -> Block:
    seen, own, shared = ca.SX.sym("y", 4), ca.SX.sym("p"), ca.SX.sym("s")
    cost, rows = said(seen, own, shared)
    low, high = np.array([0.1, -1.0, -3.0]), np.array([0.1, 2.0, 3.0])
    return Block(f"kind_{number}", seen, own, shared, cost * (1.0 + number), rows, low, high)


@pytest.mark.parametrize("longest", [15, 1000])
def test_each_lane_has_the_bits_of_the_function(longest: int, tmp_path: Path) -> None:
    text = block_code._c_text(block(0))
    whole = in_lanes(in_pieces(text, longest))
    assert f"{LANES_SYMBOL} = {LANES};" in whole
    assert ("kept[" in whole) is (longest == 15)
    flags = (*FUNCTION_FLAGS, "-Wno-psabi")
    plain = ca.external("derivatives", compiled(text, FUNCTION_FLAGS, tmp_path / "plain"))
    library = ctypes.CDLL(compiled(whole, flags, tmp_path / "whole"))
    rng = np.random.default_rng(2)
    given = [rng.uniform(0.1, 1.0, size=(plain.numel_in(k), LANES)) for k in range(plain.n_in())]
    results = [np.full((plain.nnz_out(k), LANES), np.nan) for k in range(plain.n_out())]
    pointers = [(ctypes.c_void_p * len(each))(*[a.ctypes.data for a in each]) for each in (given, results)]
    assert library.derivatives(*pointers, None, None, 0) == 0
    for lane in range(LANES):
        for found, wanted in zip(results, plain.call([ca.DM(each[:, lane]) for each in given]), strict=True):
            assert found[:, lane].tobytes() == np.array(wanted.nonzeros()).tobytes()


@pytest.mark.parametrize("times", [(1, 2), (3, 5), (8, 4)])
def test_a_solve_in_lanes_has_the_bits_of_one_without(
    times: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where repetitions do not fill the lanes."""
    rng = np.random.default_rng(3)
    images = [rng.normal(size=(4 * each, 20)) * (rng.uniform(size=(4 * each, 20)) < 0.2) for each in times]

    def solved() -> Ending:
        parts = [Repeated(block(number), image, times[number]) for number, image in enumerate(images)]
        options = SolverOptions(tolerance=1e-9, compiled=True, method=MethodName.NATIVE)
        own = [np.linspace(0.0, 1.0, each).reshape(each, 1) for each in times]
        bounds = np.full(20, -3.0), np.full(20, 3.0)
        program = RepeatedProgram("kinds", parts, options)
        assert program.method is MethodName.NATIVE
        return program.solve(np.full(20, 0.2), bounds, np.array([0.3]), own)[0]

    compiler = find_compiler(os.environ)
    assert isinstance(compiler, Compiler)
    monkeypatch.setenv("CC", compiler.command[0])  # from the first solve
    wanted = LANES if lane_flags(compiler) else 1
    counts: list[int] = []
    loaded = block_code._loaded

    def counted(library: Library) -> block_code.BlockFunctions:
        functions = loaded(library)
        counts.append(functions.lanes)
        return functions

    monkeypatch.setattr(block_code, "_loaded", counted)
    together = solved()
    monkeypatch.setattr(block_code, "lane_flags", lambda compiler: ())
    alone = solved()
    assert together.iterations == alone.iterations > 3
    assert together.symbols.tobytes() == alone.symbols.tobytes()
    assert together.rows.tobytes() == alone.rows.tobytes()
    assert counts == [wanted, wanted, 1, 1]


def test_what_lanes_cannot_do_is_done_in_one() -> None:
    seen = ca.SX.sym("y", 2)
    none = ca.SX.sym("p", 0)
    choosing = Block(
        "choosing", seen, none, none, ca.if_else(seen[0] > 0.0, seen[1], 2.0), seen, -np.ones(2), np.ones(2)
    )
    text = block_code._c_text(choosing)
    assert in_lanes(text) == f"{text}\nconst int {LANES_SYMBOL} = 1;\n"


def test_only_gcc_is_asked_for_lanes() -> None:
    assert "-Wno-psabi" in lane_flags(GCC)
    assert lane_flags(CLANG) == ()
