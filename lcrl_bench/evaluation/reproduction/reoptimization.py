"""A run's reward optimised again by DQN, kept beside the run."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import datetime
from typing import Any

import torch

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.folder_lock import locked
from lcrl_bench.evaluation.model_identity import model_digest
from lcrl_bench.evaluation.optimizers import evaluate_with_dqn, sample_tasks
from lcrl_bench.evaluation.reproduction.jobs import (
    DqnSettings,
    Job,
    dqn_settings,
    episodes_file,
    is_current,
    summary_file,
)
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.summary import split_table
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.storage import read_json, write_json


def optimize_again(
    job: Job,
    folder: RunFolder,
    learned: Reward | Policy,
    sets: Sequence[TaskSet],
    *,
    tell: Callable[[float], None],
    tasks_per_split: int | None = None,
) -> dict[str, Any]:
    """Optimise by DQN what a run learned, on a sample of the tasks, and write what came of it.

    What was done with these settings and this model is read back, not repeated.

    Args:
        job: Which optimizer, and the seed of all its randomness.
        folder: The run's; two files are written into it, the summary last.
        learned: What the run learned.
        sets: The tasks.
        tell: Told the share that is done.
        tasks_per_split: How many tasks of each split; None: as many as the paper's table takes.

    Returns:
        The summary.

    Raises:
        FolderInUseError: If another process does the same.
        UsageError: If a policy was learned, which there is nothing to optimise of.
    """
    settings = dqn_settings(job)
    if tasks_per_split is not None:
        settings = replace(settings, tasks_per_split=tasks_per_split)
    with locked(summary_file(job, folder)):
        return _optimize_again(job, folder, learned, sets, settings, tell)


def _optimize_again(
    job: Job,
    folder: RunFolder,
    learned: Reward | Policy,
    sets: Sequence[TaskSet],
    settings: DqnSettings,
    tell: Callable[[float], None],
) -> dict[str, Any]:
    began = time.perf_counter()
    file, model = summary_file(job, folder), model_digest(folder.path)
    if file.exists() and is_current(read_json(file), settings, model):
        return read_json(file)
    sampler = torch.Generator().manual_seed(settings.tasks_seed)
    outcomes = evaluate_with_dqn(
        learned,
        sets,
        settings.config,
        generator=torch.Generator().manual_seed(job.seed),
        chosen=sample_tasks(sets, settings.tasks_per_split, sampler),
        progress=lambda done, total: tell(done / total),
    )
    folder.write_episodes(outcomes, file=episodes_file(job, folder).name)
    summary = {
        "optimizer": job.optimizer.value,
        "settings": settings.document(),
        "model": model,
        "splits": split_table(outcomes),
        "finished": datetime.now().astimezone().isoformat(),
        "wall_s": round(time.perf_counter() - began, 3),
    }
    write_json(file, summary)
    return summary
