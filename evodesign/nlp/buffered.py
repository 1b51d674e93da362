"""CasADi functions of columns, called with arrays of numbers and no copies through CasADi's own matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class BufferedFunction:
    """A function whose arguments and results are dense columns.

    Args:
        function: of CasADi.
    """

    def __init__(self, function: Any) -> None:
        self._function = function
        self._rows = [function.numel_out(place) for place in range(function.n_out())]

    def __call__(self, *columns: Array) -> list[Array]:
        """The results, one array each, in CasADi's order: column after column."""
        buffer, call = self._function.buffer()
        given = [np.ascontiguousarray(column, dtype=float) for column in columns]
        results = [np.empty(rows) for rows in self._rows]
        for place, column in enumerate(given):
            buffer.set_arg(place, column.data)
        for place, result in enumerate(results):
            buffer.set_res(place, result.data)
        call()
        return results
