"""`PanoramaEncoder.largest_cells` by the compiled kernel, as one autograd operation.

The forward pass uses as many threads as torch has, the backward pass at most two: each computes a
part of every layer, and the bits are the same on any number of threads. Threads live for one layer,
so that a fork finds none.

Importing this module does not import numba; calling `largest_cells` does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from torch.autograd.function import once_differentiable

from lcrl_bench.mdp.kernels.dispatch import parallel_for
from lcrl_bench.networks.patches import PatchIndex

FILTERS, OUTPUTS = 16, 32
"""Filters of the first convolution, and filters of the second computed at a time: the paper's."""

PARTS = 2
"""Partial sums of the backward pass: fixed, so that sums don't depend on the number of threads."""


def covers(table: torch.Tensor, first_bias: torch.Tensor, weight: torch.Tensor) -> bool:
    """Whether the kernel supports these weights: 16 filters, then a multiple of 32, in float32.

    Its comparisons would drop NaNs, which must propagate: torch computes where there are any. A sum
    is finite only if all terms are, and is several times faster than looking at each.
    """
    return (
        len(first_bias) == FILTERS
        and len(weight) % OUTPUTS == 0
        and all(
            tensor.dtype == torch.float32
            and tensor.device.type == "cpu"
            and math.isfinite(float(tensor.detach().sum()))
            for tensor in (table, first_bias, weight)
        )
    )


def largest_cells(
    table: torch.Tensor, first_bias: torch.Tensor, second_weight: torch.Tensor, index: PatchIndex
) -> torch.Tensor:
    """The largest output of the second convolution in every view, without its bias; needs numba.

    Args:
        table: float32 [class * 5 + column, line * 16 + filter]; the last class is padding.
        first_bias: float32 [16].
        second_weight: float32 [output, 16, 3, 3], a multiple of 32 outputs.
        index: The house's index.

    Returns:
        float32 [view, output].
    """
    weights = second_weight.permute(0, 2, 3, 1).reshape(len(second_weight), -1)
    return _LargestCells.apply(table, first_bias, weights, index)  # type: ignore[return-value]


class _LargestCells(torch.autograd.Function):
    """Forward: every distinct window. Backward: only those that won in some view."""

    @staticmethod
    def forward(
        ctx: Any,  # noqa: ANN401
        table: torch.Tensor,
        first_bias: torch.Tensor,
        weights: torch.Tensor,
        index: PatchIndex,
    ) -> torch.Tensor:
        from lcrl_bench.networks.kernels import panorama_encoder as kernel

        rows, cells, windows, viewers, viewer_starts = _arrays(index)
        sums = np.empty(len(index.row_classes) * table.shape[1], np.float32)
        _spread(kernel.sum_rows, len(index.row_classes), _flat(table), rows, sums)
        pooled = np.zeros((len(index.cell_rows) + 1) * FILTERS, np.float32)
        best = np.empty(len(index.cell_rows) * 4, np.uint16)
        layer = sums, cells, _flat(first_bias), pooled, best
        _spread(kernel.pool_patches, len(index.cell_rows), *layer)
        outputs, parts = len(weights), min(torch.get_num_threads(), len(index.windows))
        largest = np.full((parts, (len(index.starts) - 1) * outputs), -np.inf, np.float32)
        winners = np.zeros(largest.shape, np.int32)
        for first, group in zip(range(0, outputs, OUTPUTS), weights.split(OUTPUTS), strict=True):
            layer = pooled, windows, _flat(group.t()), viewers, viewer_starts, outputs, first
            _divide(kernel.search_windows, len(index.windows), layer, largest, winners)
        _merge(largest, winners)
        ctx.index, ctx.pooled, ctx.best, ctx.winners = index, pooled, best, winners[0]
        ctx.save_for_backward(table, weights)
        return torch.from_numpy(largest[0].reshape(-1, outputs))

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: torch.Tensor) -> tuple[torch.Tensor | None, ...]:  # noqa: ANN401
        from lcrl_bench.networks.kernels import panorama_encoder as kernel

        table, weights = ctx.saved_tensors
        rows, cells, windows, _, _ = _arrays(ctx.index)
        flows = np.zeros((PARTS, len(ctx.pooled)), np.float32)
        for_weights = np.zeros((PARTS, weights.numel()), np.float32)
        layer = _flat(gradients[0]), ctx.winners, windows, ctx.pooled, _flat(weights)
        _divide(kernel.flow_from_views, len(gradients[0]), layer, flows, for_weights)
        for_sums = np.zeros((PARTS, len(rows) // 5 * table.shape[1]), np.float32)
        for_bias = np.zeros((PARTS, FILTERS), np.float32)
        layer = flows.reshape(-1), ctx.pooled, cells, ctx.best
        _divide(kernel.flow_from_cells, len(cells) // 12, layer, for_sums, for_bias)
        for_table = np.zeros((PARTS, table.numel()), np.float32)
        layer = for_sums.reshape(-1), rows
        _divide(kernel.flow_from_rows, len(rows) // 5, layer, for_table)
        sums = zip((for_table, for_bias, for_weights), (table, for_bias[0], weights), strict=True)
        return *(torch.from_numpy(each.sum(0)).view(like.shape) for each, like in sums), None


def _spread(function: Callable[..., None], count: int, *arguments: np.ndarray | int) -> None:
    """Call function(*arguments, begin, end) on parts of range(count)."""
    parallel_for(count, lambda begin, end: function(*arguments, begin, end))


def _divide(
    function: Callable[..., None],
    count: int,
    arguments: tuple[np.ndarray | int, ...],
    *results: np.ndarray,
) -> None:
    """Call function(*arguments, result[part], ..., begin, end) on parts of range(count).

    Args:
        function: A kernel.
        count: Size of the range, which has as many parts as each result has rows.
        arguments: The same for all parts.
        results: [part, ...]: each part has its own.
    """
    parts = len(results[0])
    edges = [count * part // parts for part in range(parts + 1)]
    calls = list(zip(*results, edges[:-1], edges[1:], strict=True))

    def work(begin: int, end: int) -> None:
        for call in calls[begin:end]:
            function(*arguments, *call)

    parallel_for(parts, work)


def _merge(largest: np.ndarray, winners: np.ndarray) -> None:
    """Merge the maxima of all parts into those of the first; of equals the first part's wins."""
    for values, numbers in zip(largest[1:], winners[1:], strict=True):
        better = values > largest[0]
        np.copyto(largest[0], values, where=better)
        np.copyto(winners[0], numbers, where=better)


def _arrays(index: PatchIndex) -> tuple[np.ndarray, ...]:
    """Rows, cells, windows, viewers and where they begin, flattened."""
    layers = index.row_classes, index.cell_rows, index.windows
    return tuple(_flat(tensor) for tensor in (*layers, index.viewers, index.viewer_starts))


def _flat(tensor: torch.Tensor) -> np.ndarray:
    """The tensor as a flat array; without a copy if it is contiguous."""
    return tensor.detach().reshape(-1).numpy()
