"""Benchmarks: commands, tasks with proofs, splits, fingerprints and demonstrations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.benchmarks.benchmark import Benchmark as Benchmark
    from lcrl_bench.benchmarks.build import BuildConfig as BuildConfig
    from lcrl_bench.benchmarks.build import build_benchmark as build_benchmark
    from lcrl_bench.benchmarks.catalogue import benchmark_folder as benchmark_folder
    from lcrl_bench.benchmarks.catalogue import list_benchmarks as list_benchmarks
    from lcrl_bench.benchmarks.check import check_benchmark as check_benchmark
    from lcrl_bench.benchmarks.document import read_benchmark as read_benchmark
    from lcrl_bench.benchmarks.document import write_benchmark as write_benchmark
    from lcrl_bench.benchmarks.house_sets import by_house as by_house
    from lcrl_bench.benchmarks.task import Kind as Kind
    from lcrl_bench.benchmarks.task import Proof as Proof
    from lcrl_bench.benchmarks.task import Split as Split
    from lcrl_bench.benchmarks.task import Task as Task
    from lcrl_bench.benchmarks.task import Tasks as Tasks
    from lcrl_bench.benchmarks.task_set import TaskSet as TaskSet
    from lcrl_bench.benchmarks.task_sets import TaskSets as TaskSets
    from lcrl_bench.benchmarks.task_sets import house_task_sets as house_task_sets
    from lcrl_bench.benchmarks.task_sets import load_benchmark as load_benchmark
    from lcrl_bench.benchmarks.task_sets import load_task_sets as load_task_sets
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "Benchmark": ".benchmark",
            "BuildConfig": ".build",
            "build_benchmark": ".build",
            "benchmark_folder": ".catalogue",
            "list_benchmarks": ".catalogue",
            "check_benchmark": ".check",
            "read_benchmark": ".document",
            "write_benchmark": ".document",
            "Kind": ".task",
            "Proof": ".task",
            "Split": ".task",
            "Task": ".task",
            "Tasks": ".task",
            "TaskSet": ".task_set",
            "by_house": ".house_sets",
            "TaskSets": ".task_sets",
            "house_task_sets": ".task_sets",
            "load_benchmark": ".task_sets",
            "load_task_sets": ".task_sets",
        },
    )
