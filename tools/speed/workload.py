"""A house to measure in: compiled and prepared, with a network to train."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, cast

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.errors import UsageError
from lcrl_bench.methods.network_method import NetworkMethod, network_config
from lcrl_bench.methods.preparation import PreparedHouse, prepare_house
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.train_set import train_set
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import PatchIndex
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

METHOD: Final = "lcrl"
"""The method whose network and training step are measured."""


@dataclass(frozen=True, eq=False)
class Workload:
    """A house, ready for every comparison."""

    tasks: tuple[TaskSet, ...]
    """All its tasks, of every split."""
    house: tuple[TaskSet, ...]
    """What training sees of it."""
    prepared: PreparedHouse
    method: NetworkMethod[Any, RewardNetwork]
    network: RewardNetwork
    """Untrained."""

    @property
    def encoder(self) -> PanoramaEncoder:
        """The network's image encoder."""
        return cast(PanoramaEncoder, self.network.image)

    @property
    def index(self) -> PatchIndex:
        """The index of distinct patches in the views."""
        return cast(PatchIndex, self.prepared.index)


def spread_houses(benchmark: Benchmark, count: int) -> tuple[str, ...]:
    """Training houses from the smallest to the largest, evenly spaced by rank.

    Args:
        benchmark: The benchmark to choose from.
        count: How many; all if there are fewer, the median for 1.

    Raises:
        UsageError: If `count` is not positive.
    """
    if count < 1:
        raise UsageError(f"--houses {count}: measure in 1 house or more.")
    sizes = {name: benchmark.grids[name].tiles for name in benchmark.houses_of(Split.TRAIN)}
    names = sorted(sizes, key=lambda name: (sizes[name], name))
    if count == 1:
        return (names[len(names) // 2],)
    count = min(count, len(names))
    return tuple(names[k * (len(names) - 1) // max(count - 1, 1)] for k in range(count))


def workloads(
    benchmark: Benchmark, houses: Sequence[str], *, device: torch.device, renderer: str = "auto"
) -> Iterator[Workload]:
    """Prepare training houses of a benchmark, one after the other.

    Args:
        benchmark: The benchmark they belong to.
        houses: Their ids.
        device: Where to compute.
        renderer: Draws views that are not in the cache.
    """
    method = cast("NetworkMethod[Any, RewardNetwork]", resolve_method(METHOD)())
    vocabulary = Vocabulary.of(benchmark.vocabulary)
    for name in houses:
        alone = replace(benchmark, houses={name: benchmark.houses[name]})
        sets = tuple(load_task_sets(alone, device=device, renderer=renderer))
        train = train_set(benchmark, sets, oracle=method.oracle, expert=method.expert)
        sizes = network_config(method.config, train)
        network = method.make_network(
            sizes, words=len(vocabulary), generator=torch.Generator().manual_seed(0)
        )
        yield Workload(
            tasks=sets,
            house=train.houses[0],
            prepared=prepare_house(train.houses[0], vocabulary, sizes, device),
            method=method,
            network=network.to(device),
        )
