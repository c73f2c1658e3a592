"""The image encoder's layers, compiled: what `panorama_encoder` computes, forward and backward.

Both work on the same distinct windows. What is worth it is written in `lanes`, the rest in plain
loops (`docs/kernels.md`). Three things make this fast: filters lie side by side in
vectors; the second convolution multiplies several windows at a time, with all weights in the L1
cache; and the backward pass visits winners alone.

Every function computes a part, [begin, end). In the forward pass parts are independent: parts of
any size give the same bits. In the backward pass each part has its own sums, so the bits depend on
how the work is divided into parts, which is fixed.

Arrays are flat. Sizes: 5x5 convolution to 16 filters, 2x2 max pool, 3x3 convolution to
32 outputs.

Imports numba: import this module only where numba is installed. numba's cache notices edits of this
file alone: after an edit of `lanes`, `window_products` or `compilation`, touch this file.
"""

# numba infers the types of what it compiles.
# ruff: noqa: ANN001, ANN201, ANN202

from __future__ import annotations

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_features

from lcrl_bench.mdp.kernels.compilation import compiled
from lcrl_bench.networks.kernels.lanes import (
    LANES,
    add,
    differs,
    divide,
    equal,
    larger,
    load,
    load_integers,
    multiply_add,
    splat,
    splat_integer,
    store,
    subtract,
    where_larger,
    where_set,
)
from lcrl_bench.networks.kernels.window_products import OUTPUTS, PLACES, window_products

LINES = 5
"""Lines of the first convolution's window; a row has one vector per line."""
ROW = LINES * LANES
"""Numbers per row."""
WINDOW = PLACES * LANES
"""Numbers per window of the second convolution."""
POOLED_ROWS = 12
"""Rows of five class ids per pooled cell: six lines, two columns."""
# As many windows at a time as have their sums in registers: 32 of 16 numbers, or 16 of 8.
BLOCK = 6 if get_host_cpu_features().get("avx512f") else 2
TILE = 96
"""Windows whose values are kept at a time: 12 kB."""


_compiled = compiled()


@_compiled
def sum_rows(table, rows, out, begin, end):
    """Rows of five class ids: out[row] = sum of table[class * 5 + column].

    Args:
        table: float32 [class * 5 + column, line * 16 + filter].
        rows: [row, column]: class ids.
        out: float32 [row, line * 16 + filter].
        begin: First row.
        end: Row after the last.
    """
    table, out = table.reshape(-1, ROW), out.reshape(-1, ROW)
    for row in range(begin, end):
        a, b, c = rows[row * 5] * 5, rows[row * 5 + 1] * 5 + 1, rows[row * 5 + 2] * 5 + 2
        d, e = rows[row * 5 + 3] * 5 + 3, rows[row * 5 + 4] * 5 + 4
        for k in range(ROW):
            out[row, k] = (((table[a, k] + table[b, k]) + table[c, k]) + table[d, k]) + table[e, k]


@numba.njit(inline="always")
def _patch(sums, cells, cell, line, column):
    """One output of the first convolution: the sum of five consecutive rows."""
    at = cell * POOLED_ROWS + line * 2 + column
    total = load(sums, cells[at] * ROW)
    for below in range(1, LINES):
        total = add(total, load(sums, cells[at + 2 * below] * ROW + below * LANES))
    return total


@_compiled
def pool_patches(sums, cells, bias, out, largest, begin, end):
    """The first convolution, its max pool, bias and ReLU.

    Args:
        sums: What `sum_rows` wrote.
        cells: [cell, line * 2 + column]: rows.
        bias: float32 [filter].
        out: float32 [cell, filter].
        largest: uint16 [cell, member]: the filters in which each of the four is the largest.
        begin: First cell.
        end: Cell after the last.
    """
    zero, shift = splat(numba.float32(0)), load(bias, 0)
    for cell in range(begin, end):
        a, b = _patch(sums, cells, cell, 0, 0), _patch(sums, cells, cell, 0, 1)
        c, d = _patch(sums, cells, cell, 1, 0), _patch(sums, cells, cell, 1, 1)
        best = larger(larger(a, b), larger(c, d))
        store(out, cell * LANES, larger(add(best, shift), zero))
        largest[cell * 4], largest[cell * 4 + 1] = equal(a, best), equal(b, best)
        largest[cell * 4 + 2], largest[cell * 4 + 3] = equal(c, best), equal(d, best)


_block_of_products, _one_product = window_products(BLOCK), window_products(1)


@_compiled
def search_windows(
    pooled, windows, weights, viewers, viewer_starts, outputs, first, out, winners, begin, end
):
    """The second convolution, without its bias, its global max pool, and which window won.

    A tile of windows at a time: their values stay in the cache until every view has seen them.

    Args:
        pooled: What `pool_patches` wrote, and a last row of zeros for padding.
        windows: [window, place]: pooled cells.
        weights: float32 [place * 16 + channel, output]: 32 of the outputs.
        viewers: The views of every window, ascending, window after window.
        viewer_starts: int32 [window + 1]: where each window's views begin.
        outputs: Number of all outputs.
        first: The first of the 32 outputs.
        out: float32 [view, output], of lowest values: the largest of these windows.
        winners: int32 [view, output]: the first window that has it.
        begin: First window.
        end: Window after the last.
    """
    values = np.empty(TILE * OUTPUTS, np.float32)
    for start in range(begin, end, TILE):
        count = min(TILE, end - start)
        part = windows[start * PLACES : (start + count) * PLACES]
        blocks = count // BLOCK * BLOCK
        for window in range(0, blocks, BLOCK):
            _block_of_products(pooled, part, weights, values, window)
        for window in range(blocks, count):
            _one_product(pooled, part, weights, values, window)
        for window in range(count):
            number = splat_integer(np.int32(start + window))
            low = load(values, window * OUTPUTS)
            high = load(values, window * OUTPUTS + LANES)
            for entry in range(viewer_starts[start + window], viewer_starts[start + window + 1]):
                at = np.intp(viewers[entry]) * outputs + first
                _keep_larger(low, number, out, winners, at)
                _keep_larger(high, number, out, winners, at + LANES)


@numba.njit(inline="always")
def _keep_larger(value, number, out, winners, at):
    """Keep the larger of a value and the best so far, and whose it is."""
    best = load(out, at)
    store(winners, at, where_larger(value, best, number, load_integers(winners, at)))
    store(out, at, larger(value, best))


@_compiled
def flow_from_views(gradient, winners, windows, pooled, weights, flow, for_weights, begin, end):
    """Backward pass from the views to the pooled cells: through the winners alone.

    View by view, because all winners of a view are in the same few cells, which stay in the cache.

    Args:
        gradient: float32 [view, output].
        winners: What `search_windows` wrote.
        windows: [window, place]: pooled cells.
        pooled: float32 [cell, channel], the last row zeros for padding.
        weights: float32 [output, place * 16 + channel].
        flow: float32 [cell, channel]: the gradient of `pooled` is added to it.
        for_weights: float32 [output, place * 16 + channel]: the gradient of `weights` is added.
        begin: First view.
        end: View after the last.
    """
    outputs = len(weights) // WINDOW
    for view in range(begin, end):
        for output in range(outputs):
            entry = view * outputs + output
            if gradient[entry] == 0:
                continue
            factor = splat(gradient[entry])
            for place in range(PLACES):
                cell = windows[winners[entry] * PLACES + place] * LANES
                at = output * WINDOW + place * LANES
                total = multiply_add(factor, load(pooled, cell), load(for_weights, at))
                store(for_weights, at, total)
                store(flow, cell, multiply_add(factor, load(weights, at), load(flow, cell)))


@_compiled
def flow_from_cells(flows, pooled, cells, largest, for_sums, for_bias, begin, end):
    """Backward pass from the pooled cells to the rows; tied members of a pool get equal shares.

    Args:
        flows: float32 [part, cell, channel]: what `flow_from_views` wrote; the parts are added.
        pooled: float32 [cell, filter].
        cells: [cell, line * 2 + column]: rows.
        largest: What `pool_patches` wrote.
        for_sums: float32 [row, line * 16 + filter], zeros: the gradient of `sums` is added to it.
        for_bias: float32 [filter], zeros.
        begin: First cell.
        end: Cell after the last.
    """
    zero, one = splat(numba.float32(0)), splat(numba.float32(1))
    lost = np.zeros(LANES, np.float32)
    for cell in range(begin, end):
        value = zero
        for part in range(0, len(flows), len(pooled)):
            value = add(value, load(flows, part + cell * LANES))
        # No gradient where the ReLU gave zero.
        value = where_larger(load(pooled, cell * LANES), zero, value, zero)
        if not differs(value, zero):
            continue
        _add_exactly(for_bias, lost, 0, value)
        a, b = largest[cell * 4], largest[cell * 4 + 1]
        c, d = largest[cell * 4 + 2], largest[cell * 4 + 3]
        ties = add(where_set(a, one, zero), where_set(b, one, zero))
        ties = add(ties, add(where_set(c, one, zero), where_set(d, one, zero)))
        part = divide(value, ties)
        _flow_from_patch(where_set(a, part, zero), cells, cell, 0, 0, for_sums)
        _flow_from_patch(where_set(b, part, zero), cells, cell, 0, 1, for_sums)
        _flow_from_patch(where_set(c, part, zero), cells, cell, 1, 0, for_sums)
        _flow_from_patch(where_set(d, part, zero), cells, cell, 1, 1, for_sums)


@numba.njit(inline="always")
def _add_exactly(totals, lost, at, value):
    """Add to a long sum by Kahan summation: `lost` carries the rounding error."""
    total, corrected = load(totals, at), subtract(value, load(lost, at))
    larger_total = add(total, corrected)
    store(lost, at, subtract(subtract(larger_total, total), corrected))
    store(totals, at, larger_total)


@numba.njit(inline="always")
def _flow_from_patch(value, cells, cell, line, column, for_sums):
    """Backward pass of `_patch`."""
    start = cell * POOLED_ROWS + line * 2 + column
    for below in range(LINES):
        at = cells[start + 2 * below] * ROW + below * LANES
        store(for_sums, at, add(load(for_sums, at), value))


@_compiled
def flow_from_rows(for_sums, rows, for_table, begin, end):
    """Backward pass of `sum_rows`.

    Args:
        for_sums: float32 [part, row, line * 16 + filter]: what `flow_from_cells` wrote; the parts
            are added.
        rows: [row, column]: class ids.
        for_table: float32 [class * 5 + column, line * 16 + filter], zeros.
        begin: First row.
        end: Row after the last.
    """
    for_sums, for_table = for_sums.reshape(-1, ROW), for_table.reshape(-1, ROW)
    lost, value = np.zeros_like(for_table), np.empty(ROW, np.float32)
    for row in range(begin, end):
        value[:] = 0.0
        for part in range(row, len(for_sums), len(rows) // 5):
            for k in range(ROW):
                value[k] += for_sums[part, k]
        for column in range(5):
            entry = rows[row * 5 + column] * 5 + column
            for k in range(ROW):
                # Kahan summation, as `_add_exactly`.
                total, corrected = for_table[entry, k], value[k] - lost[entry, k]
                for_table[entry, k] = total + corrected
                lost[entry, k] = (for_table[entry, k] - total) - corrected
