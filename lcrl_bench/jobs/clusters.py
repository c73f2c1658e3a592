"""The clusters that `--cluster` names, and the executors for them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from lcrl_bench.errors import UsageError
from lcrl_bench.jobs.engine import Executor

LOCAL: Final = "local"
CLUSTERS: Final = (LOCAL, "ray", "slurm", "host:port", "ray://host:port")
"""What `--cluster` takes."""


def check_cluster(name: str) -> None:
    """Refuse what is no cluster.

    Raises:
        UsageError: If it is neither a word nor an address.
    """
    if name not in (LOCAL, "ray", "slurm") and not _is_address(name):
        raise UsageError(f"--cluster {name}: name one of {', '.join(CLUSTERS)}.")


def cluster_executor(name: str, options: Sequence[str], *, workers: int) -> Executor:
    """The executor of a cluster other than this machine; nothing is started yet.

    Args:
        name: `"ray"`, an address or `"slurm"`.
        options: What each job asks for, `"key=value"`.
        workers: Most jobs at the same time; 0 for as many as the cluster takes.

    Raises:
        UsageError: If there is no such cluster, or an option has no value.
        EnvironmentMissingError: If its package is not installed.
    """
    check_cluster(name)
    asked = dict(map(_option, options))
    if name == "slurm":
        from lcrl_bench.jobs.slurm import SlurmExecutor

        return SlurmExecutor(asked, workers=workers)
    from lcrl_bench.jobs.ray_cluster import RayExecutor

    return RayExecutor(None if name == "ray" else name, asked, workers=workers)


def _is_address(name: str) -> bool:
    return re.fullmatch(r"(ray://)?[\w.\[\]:-]+:\d{1,5}", name) is not None


def _option(word: str) -> tuple[str, int | float | str]:
    """Read `timeout_min=240`: a number where it is one."""
    key, equals, text = word.partition("=")
    if not (key and equals and text):
        raise UsageError(f"--cluster-options takes key=value, found '{word}'.")
    for kind in (int, float):
        try:
            return key, kind(text)
        except ValueError:
            continue
    return key, text
