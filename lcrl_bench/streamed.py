"""`Streamed`: many items of which a few are in memory, the others memory-mapped.

An item is made on first use. When it leaves memory, its tensors are written once to a file, and the
next use maps them from there: nothing is computed twice, and memory is bounded however many items
there are. The file has no name, so that none is left behind, however the process ends.
"""

from __future__ import annotations

import mmap
import tempfile
import weakref
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from typing import Any, Final, Generic, TypeVar, overload

import numpy as np
import torch

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import cache_dir, writing

Item = TypeVar("Item")
Made = TypeVar("Made")

_ALIGNED: Final = 64
"""Bytes that tensors are aligned to, as torch aligns its own."""


class Streamed(Sequence[Item], Generic[Item]):
    """A sequence whose items are made on use: dataclasses of tensors, or tuples of those."""

    def __init__(self, count: int, make: Callable[[int], Item], *, kept: int) -> None:
        """Store the arguments; nothing is made yet.

        Args:
            count: Number of items.
            make: Makes the item of a number; called once for each.
            kept: Most items in memory, at least 1. Tensors on a GPU stay there.
        """
        self.kept = kept
        self._count = count
        self._make = make
        self._latest: OrderedDict[int, Item] = OrderedDict()
        self._left: dict[int, _Left] = {}

    def __len__(self) -> int:
        """Number of items."""
        return self._count

    @overload
    def __getitem__(self, number: int) -> Item: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[Item]: ...
    def __getitem__(self, number: int | slice) -> Item | Sequence[Item]:
        """An item, or a list of some.

        Raises:
            IndexError: If there is none.
            EnvironmentMissingError: If what leaves memory can't be written.
        """
        if isinstance(number, slice):
            return [self[k] for k in range(self._count)[number]]
        number = range(self._count)[number]
        item = self._latest.pop(number, None)
        if item is None:
            left = self._left.get(number)
            item = self._make(number) if left is None else left.again()
        self._latest[number] = item
        while len(self._latest) > self.kept:
            gone, old = self._latest.popitem(last=False)
            if gone not in self._left:
                self._left[gone] = self._file.leave(old)
        return item

    @cached_property
    def _file(self) -> _File:
        return _File()


def of_each(function: Callable[[Item], Made], items: Sequence[Item]) -> Sequence[Made]:
    """What a function makes of each item: streamed if the items are, else at once."""
    if isinstance(items, Streamed):
        return Streamed(len(items), lambda number: function(items[number]), kept=items.kept)
    return [function(item) for item in items]


@dataclass(frozen=True)
class _Place:
    """Where a tensor is in the file of its item."""

    first: int
    """Offset from the start of the item, in bytes."""
    tensor: torch.Tensor
    """Its type, shape and strides, without content (on the device `meta`)."""


@dataclass(frozen=True)
class _Left:
    """An item that has left memory."""

    item: Any
    """The item, with a `_Place` for each tensor."""
    file: _File
    start: int
    """Offset in the file, in bytes."""
    size: int

    def again(self) -> Any:  # noqa: ANN401 - an item
        """The item, with tensors mapped from the file; what is changed in them is not kept."""
        if not self.size:
            return self.item
        # Copied on writing, as an item is its holder's own.
        mapped = mmap.mmap(self.file.number, self.size, access=mmap.ACCESS_COPY, offset=self.start)

        def read(value: object) -> object:
            if not isinstance(value, _Place):
                return value
            like = value.tensor
            flat = torch.frombuffer(
                mapped, dtype=like.dtype, count=like.numel(), offset=value.first
            )
            return flat.as_strided(like.shape, like.stride())

        return _replaced(self.item, read, {})


class _File:
    """A file without a name, in the cache folder or, if that can't be written, elsewhere."""

    def __init__(self) -> None:
        try:
            folder = cache_dir()
            with writing(folder):
                folder.mkdir(parents=True, exist_ok=True)
                self._opened = tempfile.TemporaryFile(dir=folder)  # noqa: SIM115
        except EnvironmentMissingError:
            self._opened = tempfile.TemporaryFile()  # noqa: SIM115
        self._end = 0
        # Closed quietly when it is no longer used, which a file on its own complains about.
        weakref.finalize(self, self._opened.close)

    @property
    def number(self) -> int:
        """Its descriptor."""
        return self._opened.fileno()

    def leave(self, item: object) -> _Left:
        """Write the tensors of an item."""
        start, end = self._end, self._end

        def write(value: object) -> object:
            nonlocal end
            if not (isinstance(value, torch.Tensor) and value.device.type == "cpu"):
                return value
            if not value.numel():
                return value
            dense = _dense(value)
            end += -end % _ALIGNED
            place = _Place(end - start, dense.to("meta"))
            flat = dense.as_strided((dense.numel(),), (1,)).view(torch.uint8).numpy()
            self._opened.seek(end)
            end += self._opened.write(flat.data)
            return place

        with writing(cache_dir()):
            kept = _replaced(item, write, {})
            self._opened.flush()
        # A mapping starts at a page.
        self._end = end + -end % mmap.ALLOCATIONGRANULARITY
        return _Left(kept, self, start, end - start)


def _dense(tensor: torch.Tensor) -> torch.Tensor:
    """A tensor without gaps: itself, in whatever order of axes, or a contiguous copy."""
    tensor = tensor.detach()
    order = sorted(range(tensor.ndim), key=lambda axis: -tensor.stride(axis))
    return tensor if tensor.permute(order).is_contiguous() else tensor.contiguous()


def _replaced(value: Any, change: Callable[[Any], Any], done: dict[int, Any]) -> Any:  # noqa: ANN401
    """A value with its leaves changed; what is shared in it, or refers to it, stays so.

    Dataclasses keep what they have computed, except arrays, which share memory with tensors.
    """
    if id(value) in done:
        return done[id(value)]
    if isinstance(value, tuple) and type(value) is tuple:
        changed: Any = tuple(_replaced(each, change, done) for each in value)
    elif is_dataclass(value) and not isinstance(value, type | _Place):
        changed = object.__new__(type(value))
        done[id(value)] = changed
        own = {each.name for each in fields(value)}
        vars(changed).update(
            (name, _replaced(each, change, done))
            for name, each in vars(value).items()
            if name in own or not _holds_array(each)
        )
    else:
        changed = change(value)
    done[id(value)] = changed
    return changed


def _holds_array(value: object) -> bool:
    if isinstance(value, tuple):
        return any(map(_holds_array, value))
    return isinstance(value, np.ndarray)
