"""Long functions in pieces: the same bits, from shorter functions."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from evodesign.nlp.codegen import FUNCTION_FLAGS
from evodesign.nlp.compiler import BUNDLED, Compiler, find_compiler
from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.native.cut_functions import in_pieces
from evodesign.nlp.native.program_code import program_text
from evodesign.nlp.solver import Solver
from tests.nlp.native.programs import random_program

FUNCTIONS = ("values", "derivatives", "slopes")


@pytest.mark.needs_compiler
@pytest.mark.parametrize("longest", [7, 50])
def test_pieces_give_the_same_bits(longest: int, tmp_path: Path) -> None:
    random = random_program(4, convex=False)
    text = program_text(random.program)
    cut = in_pieces(text, longest)
    statements = [
        block.count("\n") for block in re.findall(r"static void casadi_f1_\d+\((.*?)\n}", cut, re.DOTALL)
    ]
    assert len(statements) > 2
    assert max(statements) <= longest + 2 + 2 * len(set(re.findall(r"\ba\d+\b", text)))
    rng = np.random.default_rng(0)
    for name in FUNCTIONS:
        first, second = (
            ca.external(name, compiled(each, flags, tmp_path / f"{name}_{number}"))
            for number, (each, flags) in enumerate(
                [(text, FUNCTION_FLAGS), (cut, ("-O0", *FUNCTION_FLAGS[1:]))]
            )
        )
        given = [rng.normal(size=first.size_in(k)) for k in range(first.n_in())]
        for one, other in zip(first(*given), second(*given), strict=True):
            assert np.asarray(one).tobytes() == np.asarray(other).tobytes()
            assert np.abs(np.asarray(one)).max(initial=0.0) > 0.0 or name == "slopes"


def compiled(text: str, flags: tuple[str, ...], place: Path) -> str:
    compiler = find_compiler({"PATH": "/usr/bin:/usr/local/bin:/bin"})
    assert isinstance(compiler, Compiler)
    source, target = place.with_suffix(".c"), place.with_suffix(".so")
    source.write_text(text)
    subprocess.run([*compiler.command, *flags, source, "-o", target, "-lm"], check=True)
    return str(target)


def test_short_functions_stay_whole() -> None:
    text = program_text(random_program(0, convex=True).program)
    assert in_pieces(text) == text


@pytest.mark.needs_compiler
@pytest.mark.parametrize("tinycc", [True, False])
def test_programs_that_are_seldom_solved_end_at_the_same_bits(
    tinycc: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not tinycc:
        monkeypatch.setitem(sys.modules, BUNDLED, None)
    random = random_program(4, convex=False)
    given = {"numbers": np.random.default_rng(3).normal(size=random.numbers)}
    often, seldom = (
        Solver(random.program, SolverOptions(compiled=True, method=MethodName.NATIVE, seldom=each)).solve(
            given, {}
        )
        for each in (False, True)
    )
    assert often.values["x"].tobytes() == seldom.values["x"].tobytes()
    assert often.iterations == seldom.iterations
