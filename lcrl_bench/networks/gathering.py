"""Deterministic gathers: forward and backward repeat to the bit, on a CPU and on a GPU.

The gradient of a gather is a sum over everything that gathered a row. PyTorch's own gradient adds
in arbitrary order (on a GPU, or in several CPU threads) or row by row (slow). Here the transpose of
the gather is itself a gather-and-sum over sorted positions: a fixed order, and the same fast
routine in both directions.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import torch
from torch.nn import functional

from lcrl_bench.mdp.dynamics import sum_into


@dataclass(frozen=True)
class Bags:
    """Rows to gather for each bag, and the inverse: for each row, the bags that gather it."""

    index: torch.Tensor
    """int32 [bag, member]: rows of the table."""
    position: torch.Tensor
    """int32 [bag * member]: positions in the flattened `index`, sorted by the row they refer to."""
    bag: torch.Tensor
    """int32 [bag * member]: the bag of each `position`."""
    offset: torch.Tensor
    """int32 [row]: the first of each row's positions."""

    @classmethod
    def of(cls, index: torch.Tensor, *, size: int) -> Bags:
        """Invert an index into a table of `size` rows."""
        flat = index.reshape(-1).to(torch.int64)
        position = torch.argsort(flat, stable=True)
        counts = torch.bincount(flat, minlength=size)
        offset = torch.cumsum(counts, 0) - counts
        bag = _bag_of(position, index)
        return cls(index.to(torch.int32).contiguous(), position.int(), bag, offset.int())

    @classmethod
    def compact(cls, index: torch.Tensor) -> tuple[torch.Tensor, Bags]:
        """Renumber the rows that are used at all, with a single sort.

        Args:
            index: int [bag, member].

        Returns:
            int [kept], the rows in use, ascending, and bags into a table of these rows alone.
        """
        flat = index.reshape(-1)
        position = torch.argsort(flat, stable=True)
        ordered = flat[position]
        new = torch.ones_like(ordered, dtype=torch.bool)
        torch.ne(ordered[1:], ordered[:-1], out=new[1:])
        offset = new.nonzero().squeeze(1)
        number = torch.empty(len(flat), dtype=torch.int32, device=flat.device)
        number[position] = (new.cumsum(0) - 1).int()
        bags = cls(number.view(index.shape), position.int(), _bag_of(position, index), offset.int())
        return ordered[offset], bags

    def to(self, device: torch.device | str) -> Bags:
        """The same bags on another device."""
        return Bags(*(getattr(self, field.name).to(device) for field in fields(self)))


def sum_bags(table: torch.Tensor, bags: Bags) -> torch.Tensor:
    """Sum the rows of each bag: float [row, feature] -> float [bag, feature]."""
    return _SumBags.apply(table, bags)  # type: ignore[return-value]


def max_bags(table: torch.Tensor, bags: Bags) -> torch.Tensor:
    """Maximum over the rows of each set, feature by feature; tied rows share the gradient.

    Args:
        table: float [row, feature].
        bags: Their `index` is [member, set]: members first is several times faster on a CPU.

    Returns:
        float [set, feature].
    """
    return _MaxBags.apply(table, bags)  # type: ignore[return-value]


def gather_bags(table: torch.Tensor, bags: Bags) -> torch.Tensor:
    """Concatenate the rows of each bag: float [row, feature] -> float [bag, member * feature]."""
    single = Bags(bags.index.view(-1, 1), bags.position, bags.position, bags.offset)
    return sum_bags(table, single).view(len(bags.index), -1)


def gather_rows(table: torch.Tensor, index: torch.Tensor) -> torch.Tensor:
    """Gather rows: float [row, feature], int64 [...] -> float [..., feature]."""
    rows = sum_bags(table, Bags.of(index.reshape(-1, 1), size=len(table)))
    return rows.view(*index.shape, table.shape[1])


def take_entries(values: torch.Tensor, entry: torch.Tensor) -> torch.Tensor:
    """Take single entries of a table: float [...], indexed flat by int64 [...]."""
    return _TakeEntries.apply(values, entry)  # type: ignore[return-value]


class _SumBags(torch.autograd.Function):
    """Forward: sum the members of each bag. Backward: sum the bags of each member."""

    @staticmethod
    def forward(ctx: Any, table: torch.Tensor, bags: Bags) -> torch.Tensor:  # noqa: ANN401
        ctx.bags = bags
        return functional.embedding_bag(bags.index, table.contiguous(), mode="sum")

    @staticmethod
    def backward(ctx: Any, *gradients: torch.Tensor) -> tuple[torch.Tensor, None]:  # noqa: ANN401
        bags: Bags = ctx.bags
        gradient = gradients[0].contiguous()
        return functional.embedding_bag(bags.bag, gradient, bags.offset, mode="sum"), None


class _MaxBags(torch.autograd.Function):
    """Forward: maximum over the members. Backward: split equally among the members that equal it.

    Ties are common: over a flat area, all members of a pool are the same patch.
    """

    @staticmethod
    def forward(ctx: Any, table: torch.Tensor, bags: Bags) -> torch.Tensor:  # noqa: ANN401
        members = table.index_select(0, bags.index.view(-1)).view(*bags.index.shape, -1)
        largest = members.amax(0)
        ctx.bags = bags
        ctx.save_for_backward(members, largest)
        return largest

    @staticmethod
    def backward(ctx: Any, *gradients: torch.Tensor) -> tuple[torch.Tensor, None]:  # noqa: ANN401
        members, largest = ctx.saved_tensors
        bags: Bags = ctx.bags
        won = (members == largest).to(largest.dtype)
        flow = (won * (gradients[0] / won.sum(0))).view(-1, won.shape[-1])
        return functional.embedding_bag(bags.position, flow, bags.offset, mode="sum"), None


class _TakeEntries(torch.autograd.Function):
    """Forward: `values.view(-1)[entry]`. Backward: a sum in a fixed order."""

    @staticmethod
    def forward(ctx: Any, values: torch.Tensor, entry: torch.Tensor) -> torch.Tensor:  # noqa: ANN401
        ctx.shape = values.shape
        ctx.save_for_backward(entry)
        return values.reshape(-1)[entry]

    @staticmethod
    def backward(ctx: Any, *gradients: torch.Tensor) -> tuple[torch.Tensor, None]:  # noqa: ANN401
        (entry,) = ctx.saved_tensors
        size = ctx.shape.numel()
        return sum_into(size, entry.reshape(-1), gradients[0].reshape(-1)).view(ctx.shape), None


def _bag_of(position: torch.Tensor, index: torch.Tensor) -> torch.Tensor:
    """The bag of each position in the flattened `index`: int32."""
    return torch.div(position.int(), index.shape[1], rounding_mode="floor")
