"""What there is to run and to look at, by kind: names and one line each, with nothing imported.

Shared by the verbs `list` and `show`. The registries are imported when asked for, and none of them
imports torch or MuJoCo.
"""

from __future__ import annotations

from typing import Final, Literal

from lcrl_bench.registry import Entry
from lcrl_bench.storage import read_json

InventoryKind = Literal["methods", "benchmarks", "sources"]

KINDS: Final[tuple[InventoryKind, ...]] = ("methods", "benchmarks", "sources")


def entries(kind: InventoryKind) -> tuple[Entry, ...]:
    """All entries of a kind, sorted by name; a benchmark's target is its folder."""
    return {"methods": _methods, "benchmarks": _benchmarks, "sources": _sources}[kind]()


def _methods() -> tuple[Entry, ...]:
    from lcrl_bench.methods.registry import method_registry

    return tuple(method_registry())


def _sources() -> tuple[Entry, ...]:
    from lcrl_bench.houses.sources import house_sources

    return tuple(house_sources())


def _benchmarks() -> tuple[Entry, ...]:
    from lcrl_bench.benchmarks.catalogue import benchmark_folder, benchmark_names

    found = []
    for name in benchmark_names():
        folder = benchmark_folder(name)
        head = read_json(folder / "benchmark.json")
        summary = f"{len(head['houses'])} houses, fingerprint {head['fingerprint'][:12]}"
        found.append(Entry(name, str(folder), summary))
    return tuple(found)
