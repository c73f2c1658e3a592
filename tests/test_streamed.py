"""Streamed items are equal to what was made, made once, and few of them are in memory."""

from __future__ import annotations

import gc
import weakref
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
import torch

from lcrl_bench.streamed import Streamed, of_each


@dataclass(frozen=True, eq=False)
class Leaf:
    values: torch.Tensor
    name: str

    @cached_property
    def doubled(self) -> torch.Tensor:
        return self.values * 2

    @cached_property
    def array(self) -> np.ndarray:
        return self.values.numpy()

    @cached_property
    def itself(self) -> tuple[Leaf, ...]:
        return (self,)


@dataclass(frozen=True, eq=False)
class Pair:
    first: Leaf
    second: Leaf


def streamed(count: int = 4, kept: int = 1) -> tuple[Streamed[Pair], list[int]]:
    made = []

    def make(number: int) -> Pair:
        made.append(number)
        leaf = Leaf(torch.arange(5) + number, str(number))
        return Pair(leaf, leaf)

    return Streamed(count, make, kept=kept), made


def test_an_item_is_made_once_and_comes_back_equal():
    items, made = streamed()
    assert len(items) == 4
    assert made == []
    for _ in range(3):
        for number, item in enumerate(items):
            assert item.first.name == str(number)
            assert item.first.values.tolist() == list(range(number, number + 5))
            assert item.first is item.second, "what is shared stays shared"
    assert made == [0, 1, 2, 3]
    assert items[-1].first.name == "3"
    assert [each.first.name for each in items[1:3]] == ["1", "2"]
    with pytest.raises(IndexError):
        items[4]


def test_what_an_item_has_computed_comes_back_except_arrays():
    items, _ = streamed()
    leaf = items[0].first
    assert leaf.doubled.tolist() == [0, 2, 4, 6, 8]
    assert leaf.array.shape == (5,)
    assert leaf.itself == (leaf,)
    items[1]
    again = items[0].first
    assert again is not leaf
    assert "array" not in vars(again)
    assert vars(again)["doubled"].tolist() == [0, 2, 4, 6, 8]
    assert again.itself == (again,)


@pytest.mark.parametrize(
    "tensor",
    [
        torch.arange(24.0).view(2, 3, 4),
        torch.arange(24).view(2, 3, 4).permute(2, 0, 1),
        torch.arange(24, dtype=torch.int32).view(4, 6)[:, ::2],
        torch.zeros(3, 1).expand(3, 4),
        torch.tensor([True, False]),
        torch.empty(0, 3),
        torch.tensor(2.5),
    ],
    ids=["plain", "permuted", "with gaps", "expanded", "bool", "empty", "scalar"],
)
def test_tensors_of_any_kind_come_back(tensor):
    items = Streamed(2, lambda _: Leaf(tensor, ""), kept=1)
    for _ in range(2):
        for item in items:
            assert item.values.dtype == tensor.dtype
            assert torch.equal(item.values, tensor)
    if not any(size == 0 for size in tensor.shape):
        assert items[0].values.data_ptr() % 64 == 0


def test_no_more_items_are_in_memory_than_are_kept():
    items, _ = streamed(6, kept=2)
    alive = [weakref.ref(items[number]) for number in range(6)]
    gc.collect()
    assert [ref() is not None for ref in alive] == [False] * 4 + [True] * 2


def test_changing_an_item_does_not_reach_the_file():
    items, _ = streamed()
    items[0], items[1]
    items[0].first.values.zero_()
    items[1]
    assert items[0].first.values.tolist() == [0, 1, 2, 3, 4]


def test_nothing_is_left_behind_in_the_cache_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    items, _ = streamed()
    assert [each.first.name for each in (*items, *items)] == list("01230123")
    assert list(tmp_path.iterdir()) == []


def test_what_is_made_of_streamed_items_is_streamed():
    items, made = streamed()
    names = of_each(lambda pair: (Leaf(pair.first.values + 1, ""),), items)
    assert made == []
    assert [each.values.sum().item() for (each,) in names] == [15, 20, 25, 30]
    assert isinstance(names, Streamed)
    assert of_each(len, ["a", "bc"]) == [1, 2]
