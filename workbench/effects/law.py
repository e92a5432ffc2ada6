"""State-dependent laws as machine code: written once, called on arrays or in a compiled time loop."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from llvmlite import ir
from numba import cfunc, types
from numba.extending import intrinsic

from workbench.core.compiled import compiled, kept

#: Most parameters of a law.
LONGEST = 6

_SIGNATURE = types.float64(types.float64, types.float64, types.CPointer(types.float64))


class Law:
    """A number computed from two others and a few parameters.

    Called with arrays, everything broadcasts: ``law(first, second, *parameters)``. A compiled loop calls it
    through its `address` by `call_law`.
    """

    def __init__(self, function: Callable[..., float]) -> None:
        self.function, self.__doc__ = function, function.__doc__
        self._alive: list[Any] = []

    @cached_property
    def address(self) -> int:
        """Return the address of the machine code; compiled at the first use, and kept on disk."""
        with kept():
            code = cfunc(_SIGNATURE, cache=True)(self.function)
        self._alive.append(code)  # two threads may come here at once, and each keeps its code
        address: Any = code.address
        return int(address)

    def __call__(
        self, first: np.ndarray | float, second: np.ndarray | float, *parameters: np.ndarray | float
    ) -> np.ndarray:
        """Values for arrays that broadcast."""
        parts = np.broadcast_arrays(first, second, *parameters)
        table = np.zeros((parts[0].size, LONGEST))
        for k, part in enumerate(parts[2:]):
            table[:, k] = part.ravel()
        x, y = (np.ascontiguousarray(p, float).ravel() for p in parts[:2])
        return _evaluate(self.address, x, y, table).reshape(parts[0].shape)


def law(function: Callable[..., float]) -> Law:
    """Return the law of a function ``(first, second, p)`` of two numbers and parameters ``p[0]``,
    ``p[1]``, ...

    The function is compiled: numbers, `math` and branches only.
    """
    return Law(function)


@intrinsic
def _call(context: Any, address: Any, first: Any, second: Any, parameters: Any) -> Any:
    """Call a law's machine code; `parameters` is an address of numbers.

    By hand: laws stand in arrays, by their addresses, and numba's own function types do not.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kinds = [context.get_value_type(t) for t in (types.float64, types.float64, types.voidptr)]
        function = ir.FunctionType(kinds[0], kinds)
        pointer = builder.inttoptr(arguments[0], function.as_pointer())
        table = builder.inttoptr(arguments[3], kinds[2])
        return builder.call(pointer, [arguments[1], arguments[2], table])

    return types.float64(types.intp, types.float64, types.float64, types.intp), generate


@compiled()
def call_law(address: int, first: float, second: float, parameters: np.ndarray) -> float:
    """Return the value of a law, for compiled code; `parameters` (LONGEST,), contiguous."""
    return _call(address, first, second, parameters.ctypes.data)  # pyright: ignore[reportCallIssue]


@compiled()
def _evaluate(address: int, first: np.ndarray, second: np.ndarray, table: np.ndarray) -> np.ndarray:
    out = np.empty(len(first))
    for k in range(len(first)):
        out[k] = call_law(address, first[k], second[k], table[k])
    return out
