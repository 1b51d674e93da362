"""The method in C for programs of blocks: a block's functions are compiled once, tables say the rest."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate
from typing import Any

import casadi as ca
import numpy as np
import scipy
from numpy.typing import NDArray

from evodesign.identity import code_digest
from evodesign.nlp.blocks import Block, Repeated, stacked_limits
from evodesign.nlp.codegen import Library
from evodesign.nlp.compiler import Compiler, NotCompiled
from evodesign.nlp.method import Ending, MethodName, SolverOptions
from evodesign.nlp.native.calls import NOT_LOADED, CalledSolver, method_library
from evodesign.nlp.native.cut_functions import in_pieces
from evodesign.nlp.native.elimination import elimination
from evodesign.nlp.native.lanes import LANES_SYMBOL, in_lanes, in_one_lane, lane_flags
from evodesign.nlp.native.optimised import FunctionSource, Optimised, functions_of
from evodesign.nlp.native.program_code import UNBOUNDED
from evodesign.nlp.native.scatter import Scatter, hessian_targets, jacobian_targets, scattered
from evodesign.nlp.native.structures import BlockRecord, Memory
from evodesign.nlp.program import Array

Integers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class BlockFunctions:
    """A block's machine code: `values` and `derivatives`, as the C wants them.

    Args:
        file: of the library that holds them.
        library: the same, loaded.
        lanes: how many repetitions they take at once.
        jacobian, hessian: rows and symbols of the entries that they give.
        work, integers: what they need.
    """

    file: Library
    library: ctypes.CDLL
    lanes: int
    jacobian: tuple[Integers, Integers]
    hessian: tuple[Integers, Integers]
    work: int
    integers: int

    def address(self, name: str) -> int | None:
        """Of a function."""
        return ctypes.cast(self.library[name], ctypes.c_void_p).value


def block_functions(
    block: Block, *, seldom: bool = False
) -> tuple[BlockFunctions, Optimised | None] | NotCompiled:
    """A block's machine code and what optimises it, compiled or from the user's cache, or why there is none.

    Args:
        block: whose functions are wanted.
        seldom: whether they run so seldom that the compiler had better be quick than its code.
    """
    expressions = ca.Function("block", block.arguments, block.values).serialize()
    source = FunctionSource((code_digest(__name__), expressions), lambda: _c_text(block), _file, lane_flags)
    try:
        found = functions_of(source, seldom=seldom)
        return found if isinstance(found, NotCompiled) else (_loaded(found[0]), found[1])
    except (OSError, RuntimeError) as error:  # such as a directory mounted without the right to execute
        return NotCompiled(f"{NOT_LOADED}: {error}")


def _file(text: str, compiler: Compiler) -> str:
    return in_lanes(in_pieces(text)) if lane_flags(compiler) else in_one_lane(text)


class NativeMaker:
    """The method in C for a program, made once for each choice of variables that have one value.

    Args:
        parts: blocks with what they see.
        functions: of each block, with what optimises them.
        method: the method's own library.
    """

    def __init__(
        self,
        parts: Sequence[Repeated],
        functions: Sequence[tuple[BlockFunctions, Optimised | None]],
        method: ctypes.CDLL,
    ) -> None:
        self._parts, self._method = parts, method
        self._functions, self._optimised = ([*each] for each in zip(*functions, strict=True))
        self._made: dict[bytes, NativeBlocks] = {}

    def solve(
        self, options: SolverOptions, start: Array, bounds: tuple[Array, Array], parameters: Array
    ) -> Ending:
        """Arguments and result as in `NativeBlocks`."""
        began, held = time.perf_counter(), np.asarray(bounds[0] == bounds[1])
        key = held.tobytes()
        if key not in self._made:
            self._made[key] = NativeBlocks(self._parts, self._functions, held, self._method)
        found = self._made[key].solve(options, start, bounds, parameters)
        seconds = time.perf_counter() - began
        for place, optimised in enumerate(self._optimised):
            if optimised:
                load, quick = partial(self._load, place), self._functions[place].file
                self._optimised[place] = optimised.taken_over(quick, seconds, load)
        return found

    def _load(self, place: int, library: Library) -> None:
        self._functions[place] = _loaded(library)
        self._made.clear()


def native_maker(parts: Sequence[Repeated], *, seldom: bool = False) -> NativeMaker | NotCompiled:
    """The method in C for a program of blocks, or why there is none."""
    method, functions = method_library(), []
    if isinstance(method, NotCompiled):
        return method
    for part in parts:
        made = block_functions(part.block, seldom=seldom)
        if isinstance(made, NotCompiled):
            return made
        functions.append(made)
    return NativeMaker(parts, functions, method)


def _c_text(block: Block) -> str:
    generator = ca.CodeGenerator("functions", {"verbose": False})
    generator.add(ca.Function("values", block.arguments, ca.cse(block.values)))
    derivatives = ca.cse([*block.first, block.hessian(1.0)])
    generator.add(ca.Function("derivatives", [*block.arguments, block.multipliers], derivatives))
    return str(generator.dump())


def _loaded(library: Library) -> BlockFunctions:
    made = [ca.external(name, str(library.path)) for name in ("values", "derivatives")]
    jacobian, hessian = (made[1].sparsity_out(place).get_triplet() for place in (3, 4))
    loaded = ctypes.CDLL(str(library.path))
    return BlockFunctions(
        file=library,
        library=loaded,
        lanes=ctypes.c_int.in_dll(loaded, LANES_SYMBOL).value,
        jacobian=(np.array(jacobian[0], int), np.array(jacobian[1], int)),
        hessian=(np.array(hessian[0], int), np.array(hessian[1], int)),
        work=max(function.sz_w() for function in made),
        integers=max(function.sz_iw() for function in made),
    )


class NativeBlocks:
    """A program of blocks, of which some variables have one value, ready to be solved by the method in C.

    Args:
        parts: blocks with what they see.
        functions: of each block.
        held: which variables have one value.
        method: the method's own library.
    """

    name = MethodName.NATIVE

    def __init__(
        self,
        parts: Sequence[Repeated],
        functions: Sequence[BlockFunctions],
        held: NDArray[np.bool_],
        method: ctypes.CDLL,
    ) -> None:
        images = [scipy.sparse.csr_matrix(part.image) for part in parts]
        self._free, self._held = np.flatnonzero(~held), np.flatnonzero(held)
        self._fixed = [image[:, self._held] for image in images]
        self._constants = [np.zeros(image.shape[0]) for image in images]
        self._bounds = np.zeros(len(self._free)), np.zeros(len(self._free))
        self._memory = Memory()
        seen = [image[:, self._free].tocsr() for image in images]
        limits, made = stacked_limits(parts), list(zip(parts, functions, seen, strict=True))
        variables, rows = len(self._free), len(limits[0])
        firsts = accumulate([part.rows for part in parts[:-1]], initial=0)
        jacobian, to_jacobian = scattered(
            [
                jacobian_targets(f.jacobian, image, times=p.times, rows=p.rows // p.times, first=first)
                for (p, f, image), first in zip(made, firsts, strict=True)
            ],
            (rows, variables),
        )
        hessian, to_hessian = scattered(
            [hessian_targets(f.hessian, image, times=p.times) for p, f, image in made], (variables, variables)
        )
        order = elimination(hessian, jacobian, pairs={})
        row_limits = [np.clip(side, -UNBOUNDED, UNBOUNDED) for side in limits]
        arrays = {
            **dict(zip(("lower", "upper"), self._bounds, strict=True)),
            **dict(zip(("row_lower", "row_upper"), row_limits, strict=True)),
            "hessian_starts": hessian.starts,
            "hessian_rows": hessian.rows,
            "jacobian_starts": jacobian.starts,
            "jacobian_rows": jacobian.rows,
            **{name: getattr(order, name) for name in order.__dataclass_fields__},
        }
        tables = zip(self._constants, to_jacobian, to_hessian, strict=True)
        blocks = [self._record(*each, *to) for each, to in zip(made, tables, strict=True)]
        shared = int(parts[0].block.shared.numel())
        problem = self._memory.problem(
            arrays,
            blocks,
            variables=variables,
            rows=rows,
            work=max(f.lanes * (f.work + _kept_by(p, f)) for p, f, _ in made),
            integers=max(f.integers for f in functions),
            shared=shared,
        )
        own = sum(part.times * int(part.block.own.numel()) for part in parts)
        self._called = CalledSolver(
            method, problem, variables=variables, rows=rows, parameters=shared + own, fixed=0
        )

    def _record(
        self,
        part: Repeated,
        functions: BlockFunctions,
        image: Any,
        constants: Array,
        jacobian: Scatter,
        hessian: Scatter,
    ) -> BlockRecord:
        block, memory = part.block, self._memory
        return BlockRecord(
            repetitions=part.times,
            lanes=functions.lanes,
            symbols=block.symbols.numel(),
            own=block.own.numel(),
            rows=block.rows.numel(),
            jacobian_entries=len(functions.jacobian[0]),
            hessian_entries=len(functions.hessian[0]),
            values=functions.address("values"),
            derivatives=functions.address("derivatives"),
            image_starts=memory.integers(image.indptr),
            image_columns=memory.integers(image.indices),
            image=memory.reals(image.data),
            constants=memory.reals(constants),
            jacobian=memory.table(jacobian),
            hessian=memory.table(hessian),
        )

    def solve(
        self, options: SolverOptions, start: Array, bounds: tuple[Array, Array], parameters: Array
    ) -> Ending:
        """The end of the solve, with all variables, multipliers of free ones' bounds, and no slopes.

        Args:
            options: of the solve.
            start: all variables; those with one value have it.
            bounds: lower and upper bounds of all variables.
            parameters: shared numbers, then those of each block's repetitions.
        """
        for own, side in zip(self._bounds, bounds, strict=True):
            own[:] = np.clip(side[self._free], -UNBOUNDED, UNBOUNDED)
        for constants, image in zip(self._constants, self._fixed, strict=True):
            constants[:] = image @ start[self._held]
        found, _ = self._called.solve(options, start[self._free], parameters)
        symbols = start.copy()
        symbols[self._free] = found.symbols
        return replace(found, symbols=symbols)


def _kept_by(part: Repeated, functions: BlockFunctions) -> int:
    """Numbers that the C keeps of a lane: cost, symbols, slopes, parameters, rows, multipliers, entries."""
    block = part.block
    numbers = 2 * block.symbols.numel() + block.own.numel() + block.shared.numel() + 2 * block.rows.numel()
    return 1 + int(numbers) + len(functions.jacobian[0]) + len(functions.hessian[0])
