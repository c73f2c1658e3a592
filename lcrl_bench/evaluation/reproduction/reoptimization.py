"""A run's reward optimised again by DQN, kept beside the run."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Final

import torch

from lcrl_bench.evaluation.optimizers import evaluate_with_dqn, sample_tasks
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.evaluation.reproduction.experiments import Optimizer
from lcrl_bench.evaluation.reproduction.jobs import Job, episodes_file, summary_file
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.summary import split_table
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.storage import write_json

TASKS_PER_SPLIT: Final = 60
"""DQN is run on so many tasks of each split, the same ones for every row and seed."""
TASKS_SEED: Final = 0
"""Which tasks these are."""


def optimize_again(
    job: Job,
    folder: RunFolder,
    learned: Reward | Policy,
    problems: Sequence[Problem],
    *,
    tell: Callable[[float], None],
) -> None:
    """Optimise by DQN what a run learned, on a sample of the tasks, and write what came of it.

    Args:
        job: Which optimizer, and the seed of all its randomness.
        folder: The run's; two files are written into it, the summary last.
        learned: What the run learned.
        problems: The houses and their tasks.
        tell: Told the share that is done.

    Raises:
        UsageError: If a policy was learned, which there is nothing to optimise of.
    """
    began = time.perf_counter()
    config = dqn_config(job)
    per_split = max(1, math.ceil(TASKS_PER_SPLIT * (job.budget or 1.0)))
    sampler = torch.Generator().manual_seed(TASKS_SEED)
    outcomes = evaluate_with_dqn(
        learned,
        problems,
        config,
        generator=torch.Generator().manual_seed(job.seed),
        chosen=sample_tasks(problems, per_split, sampler),
        progress=lambda done, total: tell(done / total),
    )
    folder.write_episodes(outcomes, file=episodes_file(job, folder).name)
    summary = {
        "optimizer": job.optimizer.value,
        "config": asdict(config),
        "tasks_per_split": per_split,
        "splits": split_table(outcomes),
        "wall_s": round(time.perf_counter() - began, 3),
    }
    write_json(summary_file(job, folder), summary)


def dqn_config(job: Job) -> DqnConfig:
    """The settings of a job's agents: the defaults, with fewer steps under a budget."""
    shaped = job.optimizer == Optimizer.DQN_SHAPED
    config = DqnConfig(shaping="optimal-value" if shaped else "none")
    if job.budget is None:
        return config
    steps = max(config.episodes, math.ceil(config.steps * job.budget))
    return DqnConfig(steps=steps, shaping=config.shaping)
