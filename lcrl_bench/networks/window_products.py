"""The second convolution's products as one piece of LLVM code, for numba.

Several windows are multiplied side by side, so that a weight is loaded once for all of them, and
their sums stay in registers. numba's own language can't say the latter.

Imports numba: only the kernel may import this module.
"""

# Arguments of an intrinsic are numba types while it is typed and LLVM values while it is lowered.
# ruff: noqa: ANN001, ANN202

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types

from lcrl_bench.networks.lanes import LANES, address, as_vector, fused, intrinsic, spread

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
        places = self._number(PLACES)
        with cgutils.for_range(builder, places, intp=places.type) as loop:
            totals = [builder.load(total) for total in sums]
            for total, value in zip(sums, self._place(windows, loop.index, totals), strict=True):
                builder.store(value, total)
        for entry, total in enumerate(sums):
            offset = builder.mul(windows[entry // 2], self._number(OUTPUTS))
            where = self._at(3, offset, entry % 2 * LANES)
            builder.store(builder.load(total), as_vector(builder, where), align=4)

    def _place(self, windows, place, totals):
        """Add the products of one place of every window; two sums a window."""
        builder = self.builder
        cells = [self._cell(window, place) for window in windows]
        base = builder.mul(place, self._number(LANES * OUTPUTS))
        for channel in range(LANES):
            halves = [self._weights(base, channel * OUTPUTS + half) for half in (0, LANES)]
            factors = [spread(builder, builder.load(self._at(0, cell, channel))) for cell in cells]
            totals = [
                fused(builder, factors[entry // 2], halves[entry % 2], total)
                for entry, total in enumerate(totals)
            ]
        return totals

    def _cell(self, window, place):
        """Where the cell at a place of a window begins."""
        builder = self.builder
        offset = builder.add(builder.mul(window, self._number(PLACES)), place)
        cell = builder.sext(builder.load(self._at(1, offset, 0)), place.type)
        return builder.mul(cell, self._number(LANES))

    def _weights(self, base, offset):
        """Sixteen weights."""
        where = as_vector(self.builder, self._at(2, base, offset))
        return self.builder.load(where, align=4)

    def _at(self, argument, offset, more):
        """The address of an element of an argument."""
        offset = self.builder.add(offset, self._number(more))
        kind, value = self.kinds[argument], self.values[argument]
        return address(self.context, self.builder, kind, value, offset)

    def _number(self, value):
        return self.context.get_constant(types.intp, value)
