"""Early checks of flags, before anything heavy is imported.

A flag means the same in every verb, so values are checked by the flag's name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from typing import Any, Final

from lcrl_bench.errors import UnknownNameError, UsageError

MAX_SEED: Final = 2**63 - 1
"""Largest seed that numpy, torch and a submission accept."""


def check_values(flags: Any) -> None:  # noqa: ANN401 - a dataclass of flags
    """Refuse values that no verb accepts.

    Raises:
        UsageError: If a list that needs values has none, a seed is repeated or negative, or the
            file of a method is missing.
        UnknownNameError: If no method, benchmark or house source has that name.
    """
    for field in fields(flags):
        value = getattr(flags, field.name)
        if is_dataclass(value):
            check_values(value)
            continue
        if value == () and not _may_be_empty(field):
            raise UsageError(f"{_spelled(field)}: give at least one value.")
        if field.name in CHECKS and value not in (None, "", ()):
            CHECKS[field.name](value)


def _may_be_empty(field: Field[Any]) -> bool:
    return field.default is not MISSING and field.default == ()


def _spelled(field: Field[Any]) -> str:
    # An argument without a default is positional.
    return field.name if field.default is MISSING else f"--{field.name.replace('_', '-')}"


def _seeds(seeds: Iterable[int]) -> None:
    taken: set[int] = set()
    for seed in seeds:
        if not 0 <= seed <= MAX_SEED:
            raise UsageError(f"--seeds {seed}: a seed is a number from 0 to {MAX_SEED}.")
        if seed in taken:
            raise UsageError(f"--seeds: {seed} is repeated. Give each seed once.")
        taken.add(seed)


def _seed(seed: int) -> None:
    if not 0 <= seed <= MAX_SEED:
        raise UsageError(f"--seed {seed}: a seed is a number from 0 to {MAX_SEED}.")


def _threads(threads: int | tuple[int, ...]) -> None:
    for number in (threads,) if isinstance(threads, int) else threads:
        if number < 1:
            raise UsageError(f"--threads {number}: give at least 1.")


def _workers(workers: int) -> None:
    if workers < 0:
        raise UsageError(f"--workers {workers}: give a number of jobs, or 0 for one per core.")


def _cluster(name: str) -> None:
    from lcrl_bench.jobs.clusters import check_cluster

    check_cluster(name)


def _shard(text: str) -> None:
    from lcrl_bench.jobs.shard import COLLECT, Shard

    if text != COLLECT:
        Shard.parse(text)


def _method(name: str) -> None:
    from lcrl_bench.methods.registry import check_method

    check_method(name)


def _benchmark(name: str) -> None:
    from lcrl_bench.benchmarks.catalogue import benchmark_folder

    benchmark_folder(name)


def _source(name: str) -> None:
    from lcrl_bench.houses.sources import house_sources

    registry = house_sources()
    if name not in registry:
        raise UnknownNameError(registry.kind, name, registry.entries)


CHECKS: Final[Mapping[str, Callable[[Any], None]]] = {
    "benchmark": _benchmark,
    "cluster": _cluster,
    "method": _method,
    "seed": _seed,
    "seeds": _seeds,
    "shard": _shard,
    "source": _source,
    "threads": _threads,
    "workers": _workers,
}
"""Flag → check of its value."""
