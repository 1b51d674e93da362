"""The C's structures of a program of blocks, filled from arrays that they keep alive."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from evodesign.nlp.native.scatter import Scatter

_Integers, _Reals = ctypes.POINTER(ctypes.c_int), ctypes.POINTER(ctypes.c_double)
_Fields = tuple[tuple[str, Any], ...]


def _all_of(kind: Any, names: str) -> _Fields:
    return tuple((name, kind) for name in names.split())


class _ScatterTable(ctypes.Structure):
    """The C's `Scatter`."""

    _fields_ = (*_all_of(_Integers, "starts places"), ("weights", _Reals))


class BlockRecord(ctypes.Structure):
    """The C's `Block`."""

    _fields_ = (
        *_all_of(ctypes.c_int, "repetitions lanes symbols own rows jacobian_entries hessian_entries"),
        *_all_of(ctypes.c_void_p, "values derivatives"),
        *_all_of(_Integers, "image_starts image_columns"),
        *_all_of(_Reals, "image constants"),
        *_all_of(_ScatterTable, "jacobian hessian"),
    )


class BlockProblem(ctypes.Structure):
    """The C's `Problem`."""

    _fields_ = (
        *_all_of(ctypes.c_int, "variables rows"),
        *_all_of(_Reals, "lower upper row_lower row_upper"),
        *_all_of(_Integers, "hessian_starts hessian_rows jacobian_starts jacobian_rows"),
        *_all_of(_Integers, "order system_starts system_rows"),
        *_all_of(_Integers, "hessian_places jacobian_places diagonal_places"),
        *_all_of(_Integers, "factor_starts factor_rows pattern_starts pattern"),
        *_all_of(ctypes.c_void_p, "values derivatives slopes"),
        *_all_of(ctypes.c_longlong, "work integers"),
        *_all_of(ctypes.c_int, "block_count shared"),
        ("blocks", ctypes.POINTER(BlockRecord)),
    )


class Memory:
    """Arrays that C is told of, kept as long as this lives."""

    def __init__(self) -> None:
        self._kept: list[Any] = []

    def reals(self, values: Any) -> Any:
        """A pointer to numbers; to the array itself where it is one of float64 in one piece."""
        array = np.ascontiguousarray(values, np.float64)
        self._kept.append(array)
        return array.ctypes.data_as(_Reals)

    def integers(self, values: Any) -> Any:
        """A pointer to integers."""
        array = np.ascontiguousarray(values, np.int32)
        self._kept.append(array)
        return array.ctypes.data_as(_Integers)

    def table(self, scatter: Scatter) -> _ScatterTable:
        """Where entries are added."""
        return _ScatterTable(
            self.integers(scatter.starts), self.integers(scatter.places), self.reals(scatter.weights)
        )

    def problem(self, arrays: Mapping[str, Any], blocks: Sequence[BlockRecord], **numbers: int) -> int:
        """The address of a `BlockProblem`.

        Args:
            arrays: by name of its field.
            blocks: of the program.
            numbers: by name of its field.
        """
        pointers = {
            name: self.reals(values) if values.dtype == np.float64 else self.integers(values)
            for name, values in arrays.items()
        }
        records = (BlockRecord * len(blocks))(*blocks)
        made = BlockProblem(**pointers, **numbers, block_count=len(blocks), blocks=records)
        self._kept += [*blocks, records, made]
        return ctypes.addressof(made)
