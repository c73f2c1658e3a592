"""Gathers that repeat to the bit, forwards and backwards, on a CPU and on a GPU.

The gradient of a gather is a sum over everything that gathered a row. The stock gradient adds in
the order of arrival (GPU, or several CPU threads), or walks the rows one by one (slow). Here the
transpose of the gather is itself a gather-and-sum over sorted positions: a fixed order, and the
same fast routine in both directions.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import torch
from torch.nn import functional

from lcrl_bench.mdp.dynamics import sum_into


@dataclass(frozen=True)
class Bags:
    """Rows to gather for each bag, and for each row of the table the bags that gathered it."""

    index: torch.Tensor
    """int32 [bag, member]: rows of the table."""
    position: torch.Tensor
    """int32 [bag * member]: positions in the flattened `index`, sorted by the row they name."""
    bag: torch.Tensor
    """int32 [bag * member]: the bag of each `position`."""
    offset: torch.Tensor
    """int32 [row]: where each row's positions begin."""

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
        """Keep the rows that are named at all, and number them afresh: one sort for both.

        Args:
            index: int [bag, member].

        Returns:
            int [kept] the rows that are named, ascending, and bags into a table of these alone.
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
    """Take the largest of several rows, feature by feature; tied rows share the gradient.

    Args:
        table: float [row, feature].
        bags: Its `index` is [member, set], members first: several times faster on a CPU.

    Returns:
        float [set, feature].
    """
    return _MaxBags.apply(table, bags)  # type: ignore[return-value]


def gather_bags(table: torch.Tensor, bags: Bags) -> torch.Tensor:
    """Lay the rows of each bag side by side: float [row, f] -> float [bag, member * f]."""
    single = Bags(bags.index.view(-1, 1), bags.position, bags.position, bags.offset)
    return sum_bags(table, single).view(len(bags.index), -1)


def gather_rows(table: torch.Tensor, index: torch.Tensor) -> torch.Tensor:
    """Gather rows: float [row, feature], int64 [...] -> float [..., feature]."""
    rows = sum_bags(table, Bags.of(index.reshape(-1, 1), size=len(table)))
    return rows.view(*index.shape, table.shape[1])


def take_entries(values: torch.Tensor, entry: torch.Tensor) -> torch.Tensor:
    """Pick single numbers out of a table: float [...], int64 [...] into it flattened."""
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
    """Forward: maximum over the members. Backward: to the members that equal it, in equal parts.

    Equal parts matter: the members of a pool over a flat area are one and the same patch.
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
    """The bag that a position in the flattened `index` lies in: int32."""
    return torch.div(position.int(), index.shape[1], rounding_mode="floor")
