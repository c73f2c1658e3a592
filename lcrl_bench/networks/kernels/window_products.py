"""The matrix products of the second convolution, emitted as LLVM code for numba.

Several windows are multiplied at a time, so that each weight is loaded once for all of them, and
their sums stay in registers, which can't be expressed in numba's Python.

Imports numba: only kernels may import this module.
"""

# An intrinsic's arguments are numba types during typing and LLVM values during lowering.
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
"""Cells per window."""


def window_products(count: int) -> Any:  # noqa: ANN401
    """Make an intrinsic that multiplies `count` windows at a time.

    Returns:
        An intrinsic (pooled, windows, weights, out, first) -> None on flat arrays:
        pooled: float32 [cell, channel].
        windows: uint16 or int32 [window, place]: cells.
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
    """Emits the code: LLVM builder and arguments of one call."""

    context: Any
    builder: Any
    kinds: Any
    values: Any

    def write(self, count: int) -> None:
        """Emit the product."""
        builder = self.builder
        zero = ir.Constant(ir.VectorType(ir.FloatType(), LANES), None)
        sums = [cgutils.alloca_once_value(builder, zero) for _ in range(2 * count)]
        for total in sums:
            builder.store(zero, total)
        windows = [builder.add(self.values[4], self._number(window)) for window in range(count)]
        with self._loop(PLACES) as place:
            cells = [self._cell(window, place) for window in windows]
            # Not unrolled: LLVM would load ahead until it ran out of registers.
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
        """Emit a loop around the body of the `with` block; yields the loop's index."""
        stop = self._number(count)
        with cgutils.for_range(self.builder, stop, intp=stop.type) as loop:
            yield loop.index

    def _cell(self, window, place):
        """Offset of the cell at a place of a window."""
        builder = self.builder
        offset = builder.add(builder.mul(window, self._number(PLACES)), place)
        # Never negative, whatever the type.
        cell = builder.zext(builder.load(self._at(1, offset)), place.type)
        return builder.mul(cell, self._number(LANES))

    def _weights(self, line):
        """Load the weights of a place and channel: two vectors."""
        builder = self.builder
        places = [as_vector(builder, self._at(2, self._vector(line, half))) for half in (0, 1)]
        return [builder.load(place, align=4) for place in places]

    def _vector(self, line, half):
        """Offset of the first or the second half of a line of outputs."""
        first = self.builder.mul(line, self._number(OUTPUTS))
        return self.builder.add(first, self._number(half * LANES))

    def _at(self, argument, offset):
        """The address of an element of an argument."""
        kind, value = self.kinds[argument], self.values[argument]
        return address(self.context, self.builder, kind, value, offset)

    def _number(self, value):
        return self.context.get_constant(types.intp, value)
