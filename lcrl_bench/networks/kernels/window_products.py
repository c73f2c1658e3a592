"""The second convolution's products as one piece of LLVM code, for numba.

Several windows are multiplied side by side, so that a weight is loaded once for all of them, and
their sums stay in registers. numba's own language can't say the latter.

Imports numba: only the kernel may import this module.
"""

# Arguments of an intrinsic are numba types while it is typed and LLVM values while it is lowered.
# ruff: noqa: ANN001, ANN202

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types

from lcrl_bench.networks.kernels.lanes import LANES, address, as_vector, fused, intrinsic, spread

OUTPUTS = 2 * LANES
"""Outputs of the second convolution: two vectors."""
PLACES = 9
"""Cells in a window."""


def window_products(count: int) -> Any:  # noqa: ANN401
    """Make the product of `count` windows side by side.

    Returns:
        An intrinsic (pooled, windows, weights, out, first) -> None on flat arrays:
        pooled: float32 [cell, channel].
        windows: int32 [window, place]: cells.
        weights: float32 [place, channel, output].
        out: float32 [window, output]: written from window `first` on.
        first: The first of the windows.
    """

    @intrinsic
    def products(_typing, pooled, windows, weights, out, first):
        def lower(context, builder, signature, values):
            _Code(context, builder, signature.args, values).write(count)
            return context.get_dummy_value()

        return types.void(pooled, windows, weights, out, types.intp), lower

    return products


@dataclass(frozen=True)
class _Code:
    """Where code is written to, and the arguments it is about."""

    context: Any
    builder: Any
    kinds: Any
    values: Any

    def write(self, count: int) -> None:
        """Write the whole product."""
        builder = self.builder
        zero = ir.Constant(ir.VectorType(ir.FloatType(), LANES), None)
        sums = [cgutils.alloca_once_value(builder, zero) for _ in range(2 * count)]
        for total in sums:
            builder.store(zero, total)
        windows = [builder.add(self.values[4], self._number(window)) for window in range(count)]
        with self._loop(PLACES) as place:
            cells = [self._cell(window, place) for window in windows]
            # A loop in the code, too: written out, LLVM loads ahead until it runs out of registers.
            with self._loop(LANES) as channel:
                halves = self._weights(
                    builder.add(builder.mul(place, self._number(LANES)), channel)
                )
                for window, cell in enumerate(cells):
                    entry = builder.load(self._at(0, builder.add(cell, channel)))
                    factor = spread(builder, entry)
                    for total, half in zip(sums[2 * window :], halves, strict=False):
                        value = fused(builder, factor, half, builder.load(total))
                        builder.store(value, total)
        for entry, total in enumerate(sums):
            where = self._at(3, self._vector(windows[entry // 2], entry % 2))
            builder.store(builder.load(total), as_vector(builder, where), align=4)

    @contextmanager
    def _loop(self, count: int) -> Iterator[Any]:
        """Write what is inside as the body of a loop; gives the loop's number."""
        stop = self._number(count)
        with cgutils.for_range(self.builder, stop, intp=stop.type) as loop:
            yield loop.index

    def _cell(self, window, place):
        """Where the cell at a place of a window begins."""
        builder = self.builder
        offset = builder.add(builder.mul(window, self._number(PLACES)), place)
        cell = builder.sext(builder.load(self._at(1, offset)), place.type)
        return builder.mul(cell, self._number(LANES))

    def _weights(self, line):
        """The weights of a place and channel: two vectors."""
        builder = self.builder
        places = [as_vector(builder, self._at(2, self._vector(line, half))) for half in (0, 1)]
        return [builder.load(place, align=4) for place in places]

    def _vector(self, line, half):
        """Where the first or the second half of a line of outputs begins."""
        first = self.builder.mul(line, self._number(OUTPUTS))
        return self.builder.add(first, self._number(half * LANES))

    def _at(self, argument, offset):
        """The address of an element of an argument."""
        kind, value = self.kinds[argument], self.values[argument]
        return address(self.context, self.builder, kind, value, offset)

    def _number(self, value):
        return self.context.get_constant(types.intp, value)
