"""A run's reward optimised again by DQN, kept beside the run."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import torch

from lcrl_bench.evaluation.optimizers import evaluate_with_dqn, sample_tasks
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.evaluation.reproduction.jobs import (
    Job,
    dqn_settings,
    episodes_file,
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
    problems: Sequence[Problem],
    *,
    tell: Callable[[float], None],
    tasks_per_split: int | None = None,
) -> dict[str, Any]:
    """Optimise by DQN what a run learned, on a sample of the tasks, and write what came of it.

    What was done with these settings is read back, not repeated.

    Args:
        job: Which optimizer, and the seed of all its randomness.
        folder: The run's; two files are written into it, the summary last.
        learned: What the run learned.
        problems: The houses and their tasks.
        tell: Told the share that is done.
        tasks_per_split: How many tasks of each split; None: as many as the paper's table takes.

    Returns:
        The summary.

    Raises:
        UsageError: If a policy was learned, which there is nothing to optimise of.
    """
    began = time.perf_counter()
    settings = dqn_settings(job)
    if tasks_per_split is not None:
        settings = replace(settings, tasks_per_split=tasks_per_split)
    file = summary_file(job, folder)
    if file.exists() and read_json(file)["settings"] == settings.document():
        return read_json(file)
    sampler = torch.Generator().manual_seed(settings.tasks_seed)
    outcomes = evaluate_with_dqn(
        learned,
        problems,
        settings.config,
        generator=torch.Generator().manual_seed(job.seed),
        chosen=sample_tasks(problems, settings.tasks_per_split, sampler),
        progress=lambda done, total: tell(done / total),
    )
    folder.write_episodes(outcomes, file=episodes_file(job, folder).name)
    summary = {
        "optimizer": job.optimizer.value,
        "settings": settings.document(),
        "splits": split_table(outcomes),
        "wall_s": round(time.perf_counter() - began, 3),
    }
    write_json(file, summary)
    return summary
