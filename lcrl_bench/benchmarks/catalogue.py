"""Locating benchmarks: the frozen ones shipped with the suite, and folders of your own."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from lcrl_bench.errors import UnknownNameError


def _shipped() -> Path:
    return Path(str(resources.files("lcrl_bench.tasks")))


def list_benchmarks() -> tuple[str, ...]:
    """Names of the frozen benchmarks shipped with the suite, sorted.

    Example:
        >>> lcrl_bench.list_benchmarks()
        ('lcrl-v1', 'mini')
    """
    return tuple(sorted(path.parent.name for path in _shipped().glob("*/benchmark.json")))


def benchmark_folder(name: str) -> Path:
    """The folder of a benchmark, given its name or its path.

    Raises:
        UnknownNameError: If it is neither a shipped benchmark nor a benchmark folder.
    """
    if name in list_benchmarks():
        return _shipped() / name
    folder = Path(name)
    if (folder / "benchmark.json").is_file():
        return folder
    raise UnknownNameError("benchmark", name, list_benchmarks())
