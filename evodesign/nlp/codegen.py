"""A program's functions as machine code: generated as C, compiled once, found again by later processes.

The C holds the very expression graphs that CasADi's virtual machine would run (objective, constraints, exact
first derivatives and Hessian of the Lagrangian), and is compiled without rearranging sums, so that both give
the same bits: what IPOPT finds does not depend on whether there is a compiler. (Eliminating common
subexpressions once more in the derivatives would save 2 % of their operations and cost that equality.)

Threat model: see `cache`: a library is executed with the user's rights, so one that another user could have
written or put in place is never loaded, but built again. The compiler that $CC or PATH names or that pip
installed is trusted.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca

from evodesign.identity import code_digest, digest
from evodesign.nlp.compiler import Compiler, NotCompiled, error_in, find_compiler, run
from evodesign.nlp.disk_cache import Cache, user_cache

Expression = Any

FUNCTION_FLAGS = ("-Og", "-shared", "-fPIC", "-ffp-contract=off")
"""Compiled in two thirds of the time of -O1 and as fast; fused multiply-adds would round differently from the
virtual machine."""

COMPILING_LIMIT = 300.0
"""Wall time [s] after which a compiler is stopped; the largest program takes about 12."""


@dataclass(frozen=True, slots=True)
class Library:
    """A compiled program on the disk; fresh when this call has compiled it."""

    path: Path
    fresh: bool


@dataclass(frozen=True, slots=True)
class CompiledFunctions:
    """A program's functions in memory.

    Args:
        oracle: what `nlpsol` takes in place of a symbolic problem.
        library: where they were loaded from.
    """

    oracle: Any
    library: Library


def compiled_functions(nlp: Mapping[str, Expression]) -> CompiledFunctions | NotCompiled:
    """The functions of a nonlinear program, with this process's compiler and the user's cache.

    Args:
        nlp: symbols x and p, objective f and constraints g, all SX.
    """
    tools = compiler_and_cache(os.environ)
    if isinstance(tools, NotCompiled):
        return tools
    try:
        found = library(nlp, *tools)
    except OSError as error:
        return NotCompiled(str(error))
    if isinstance(found, NotCompiled):
        return found
    try:
        return CompiledFunctions(ca.external("nlp", str(found.path)), found)
    except RuntimeError as error:  # such as a directory mounted without the right to execute
        return NotCompiled(f"the compiled functions could not be loaded: {error_in(str(error))}")


def compiled_function(function: Any) -> Any:
    """A CasADi function (SX) as machine code, made quickly; itself where nothing can be compiled."""
    tools = compiler_and_cache(os.environ, quick=True)
    if isinstance(tools, NotCompiled):
        return function
    generator = ca.CodeGenerator("functions", {"verbose": False})

    def texts() -> Mapping[str, str]:
        generator.add(function)
        return {"functions.c": str(generator.dump())}

    try:
        found = built((code_digest(__name__), function.serialize()), texts, FUNCTION_FLAGS, *tools)
        return function if isinstance(found, NotCompiled) else ca.external(function.name(), str(found.path))
    except (OSError, RuntimeError):  # nothing can be written, or a directory has no right to execute
        return function


def compiler_and_cache(
    environment: Mapping[str, str], *, quick: bool = False
) -> tuple[Compiler, Cache] | NotCompiled:
    """What libraries are made with, and where they are kept.

    Args:
        environment: that names them.
        quick: whether the compiler had better be quick than its code.
    """
    compiler = find_compiler(environment, quick=quick)
    if isinstance(compiler, NotCompiled):
        return compiler
    try:
        return compiler, user_cache("functions", environment)
    except OSError as error:
        return NotCompiled(str(error))


def library(nlp: Mapping[str, Expression], compiler: Compiler, cache: Cache) -> Library | NotCompiled:
    """The compiled functions of a nonlinear program, from the cache or, when they are not there, compiled.

    Raises:
        OSError: a file cannot be written.
    """
    return built(_of(nlp), lambda: {"functions.c": _c_text(nlp)}, FUNCTION_FLAGS, compiler, cache)


def _of(nlp: Mapping[str, Expression]) -> tuple[str, str]:
    """What a program's C follows from."""
    expressions = ca.Function("nlp", [nlp["x"], nlp["p"]], [nlp["f"], nlp["g"]]).serialize()
    return code_digest(__name__), expressions


def built(
    of: object,
    texts: Callable[[], Mapping[str, str]],
    flags: Sequence[str],
    compiler: Compiler,
    cache: Cache,
    niceness: int = 0,
) -> Library | NotCompiled:
    """A library from the cache or, when it is not there, compiled.

    The key is made of what the C follows from, such as a program's own expressions: finding a library costs
    milliseconds, and neither derivatives nor C are made again. Of several processes one compiles, the others
    wait for it.

    Args:
        of: data that the C follows from.
        texts: makes the C, by file name.
        flags: of the compiler.
        compiler: to use.
        cache: where libraries are kept.
        niceness: how much less urgent the compiler is than this process.
    Raises:
        OSError: a file cannot be written.
    """
    if kept := kept_library(of, flags, compiler, cache):
        return kept
    key = _key(of, flags, compiler)
    with cache.lock(key) as waited:
        if kept := kept_library(of, flags, compiler, cache):
            return kept
        if waited:  # trying again would take as long, and fail as surely, in one process after another
            return NotCompiled("another process tried to compile the same functions and failed")
        content = _compiled(texts(), flags, compiler, cache.directory, niceness)
        return content if isinstance(content, NotCompiled) else Library(cache.store(key, content), fresh=True)


def kept_library(of: object, flags: Sequence[str], compiler: Compiler, cache: Cache) -> Library | None:
    """A library that was compiled before; None if there is none. Arguments as in `built`."""
    path = cache.find(_key(of, flags, compiler))
    return Library(path, fresh=False) if path else None


def _key(of: object, flags: Sequence[str], compiler: Compiler) -> str:
    machine = " ".join(os.uname()[::4])  # system and processor
    return digest((of, tuple(flags), machine, compiler))


def _c_text(nlp: Mapping[str, Expression]) -> str:
    """C of all functions that `nlpsol` looks for in a library, under the names that it gives them itself."""
    silent = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes"}}
    solver = ca.nlpsol("solver", "ipopt", dict(nlp), silent)
    generator = ca.CodeGenerator("functions", {"verbose": False})
    for function in (solver.oracle(), *(solver.get_function(name) for name in solver.get_function())):
        generator.add(function)
    return str(generator.dump())


def _compiled(
    texts: Mapping[str, str], flags: Sequence[str], compiler: Compiler, directory: Path, niceness: int
) -> bytes | NotCompiled:
    """The library of C files; every file on the way to it lies in the user's own directory."""
    with tempfile.TemporaryDirectory(prefix=".", dir=directory) as name:
        for file, text in texts.items():
            (Path(name) / file).write_text(text, encoding="ascii")
        sources = [str(Path(name) / file) for file in texts if file.endswith(".c")]
        target = Path(name) / "library.so"
        libraries = [] if compiler.bundled else ["-lm"]
        command = [*compiler.command, *flags, *sources, "-o", str(target), *libraries]
        output = run(command, COMPILING_LIMIT, {**os.environ, "TMPDIR": name}, niceness)
        return output if isinstance(output, NotCompiled) else target.read_bytes()
