"""Results of the controls on disk, so that each benchmark's are computed once.

They depend on nothing that a run chooses: only on the tasks, what is seen of houses, the code and
the device. A file in the cache folder is named by a digest of these. It is used only if the digest
in its header is that of its content; a damaged one is written again.
"""

from __future__ import annotations

import hashlib
import logging
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from lcrl_bench.benchmarks.house_sets import House, by_house, tasks_of
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.evaluation.figure import FAILURES, MEASURES
from lcrl_bench.evaluation.results import Results, TaskRow
from lcrl_bench.jobs.code import code_digest
from lcrl_bench.mdp.kernels.dispatch import kernel_name
from lcrl_bench.storage import cache_dir, canonical_json, sha256_of, write_bytes

_DIGEST: Final = "sha256"
_VALUES: Final = (*MEASURES.values(), *FAILURES.values())
_logger = logging.getLogger(__name__)


def controls_path(
    fingerprint: str, sets: Sequence[TaskSet], *, device: torch.device, threads: int
) -> Path | None:
    """The file of the controls' results; None if there is no cache folder.

    Args:
        fingerprint: Of the benchmark.
        sets: Its tasks, with what is seen of their houses.
        device: The device that they are computed on.
        threads: Number of torch threads.
    """
    content = {
        "fingerprint": fingerprint,
        "tasks": [[task.id, task.split.value] for task in tasks_of(sets)],
        "views": [_views_digest(house) for house in by_house(sets)],
        "code": code_digest(),
        "computed_by": [kernel_name(device), str(device), threads],
    }
    name = sha256_of(canonical_json(content))
    try:
        return cache_dir() / "controls" / name[:2] / f"{name}.safetensors"
    except EnvironmentMissingError:
        return None


def read_controls(
    path: Path, names: Sequence[str], sets: Sequence[TaskSet]
) -> dict[str, Results] | None:
    """The results in a file, by control; None if it is missing or damaged.

    Args:
        path: From `controls_path`.
        names: The controls.
        sets: The tasks.
    """
    # Not Path.exists, which raises where a parent folder can't be searched.
    if not os.path.exists(path):
        return None
    tasks = sorted(tasks_of(sets), key=lambda task: task.id)
    rows = tuple(map(TaskRow.of, tasks))
    try:
        with safe_open(path, framework="numpy") as file:
            written = (file.metadata() or {}).get(_DIGEST)
            arrays = {key: file.get_tensor(key) for key in file.keys()}  # noqa: SIM118
        if written != _digest(arrays):
            raise ValueError("its content is not what was written")
        found = {name: {key: arrays[f"{name}/{key}"] for key in _VALUES} for name in names}
    except (OSError, SafetensorError, KeyError, ValueError) as error:
        _logger.warning("notice: evaluating the controls again: %s: %s", path, error)
        return None
    return {name: Results(name, (0,), rows, values) for name, values in found.items()}


def write_controls(path: Path, results: Mapping[str, Results]) -> None:
    """Write the results of the controls, where the cache can be written.

    Args:
        path: From `controls_path`.
        results: By control.
    """
    arrays = {
        f"{name}/{key}": np.ascontiguousarray(value)
        for name, each in results.items()
        for key, value in each.values.items()
    }
    try:
        write_bytes(path, save(arrays, {_DIGEST: _digest(arrays)}))
    except EnvironmentMissingError as error:
        _logger.info("the controls are not cached: %s", error)


def _views_digest(house: House) -> str:
    """SHA-256 of what is seen of a house, and where its tasks see it."""
    digest, views = hashlib.sha256(), house[0].views
    for tensor in (views.views, views.panorama_views, *(tasks.panoramas for tasks in house)):
        digest.update(canonical_json([str(tensor.dtype), list(tensor.shape)]))
        digest.update(tensor.cpu().contiguous().numpy().data)
    return digest.hexdigest()


def _digest(arrays: Mapping[str, NDArray[np.float64]]) -> str:
    """SHA-256 of names, shapes and content."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        digest.update(canonical_json([name, list(arrays[name].shape)]))
        digest.update(arrays[name].tobytes())
    return digest.hexdigest()
