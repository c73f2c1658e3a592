"""Re-optimise a learned reward by DQN instead of exact planning: the paper's second table.

The reward is scored in each house, and one agent per task learns from it by acting. Its greedy
policy is then evaluated exactly, like any policy: only learning is random.

Source: Fu et al. (2019), section "Experimental Procedure" and table "results_dqn".
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import Final

import torch

from lcrl_bench.benchmarks.house_sets import by_house, tasks_of
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.folder_lock import locked
from lcrl_bench.evaluation.model_identity import model_digest
from lcrl_bench.evaluation.outcome import Outcome, outcomes_of
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run_folder import EPISODES_FILE, RunFolder
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.solve import solve_seeded
from lcrl_bench.mdp.policy_outcome import follow
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.methods.learned import ask
from lcrl_bench.storage import read_json, write_json


class Optimizer(StrEnum):
    """The optimiser that finds a policy for a learned reward."""

    Q_ITERATION = "q-iteration"
    """Exact dynamic programming."""
    DQN = "dqn"
    """Deep Q-learning from samples, without knowledge of the dynamics."""
    DQN_SHAPED = "dqn-shaping"
    """The same with a potential that is the optimal value function of the learned reward."""


DQN_TASKS: Final = 60
"""Tasks per split learned by DQN, the same ones for every method and seed."""


@dataclass(frozen=True)
class DqnSettings:
    """DQN's settings, and the tasks it is run on."""

    config: DqnConfig
    tasks_per_split: int = DQN_TASKS
    tasks_seed: int = 0
    """Seed of the selection of tasks."""

    @classmethod
    def of(cls, optimizer: Optimizer, tasks_per_split: int, budget: float | None) -> DqnSettings:
        """The defaults, scaled down by a budget."""
        shaping = "optimal-value" if optimizer == Optimizer.DQN_SHAPED else "none"
        full = DqnConfig(shaping=shaping)
        if budget is None:
            return cls(full, tasks_per_split)
        steps = max(full.episodes, math.ceil(full.steps * budget))
        tasks = max(1, math.ceil(tasks_per_split * budget))
        return cls(DqnConfig(shaping=shaping, steps=steps), tasks)


TASKS_AT_ONCE = 128
"""Agents that learn in parallel; limits memory to about 150 MB with default settings."""


@dataclass(frozen=True, eq=False)
class _Part:
    """Tasks of one kind in one house, their rewards, and their seeds."""

    tasks: TaskSet
    reward: torch.Tensor
    seeds: torch.Tensor


def sample_tasks(
    sets: Sequence[TaskSet], per_split: int, generator: torch.Generator
) -> tuple[str, ...]:
    """Draw tasks of every split, without replacement.

    Args:
        sets: The tasks.
        per_split: Number of tasks per split; all of them if a split has fewer.
        generator: A CPU generator, which determines the subset.

    Returns:
        Ids, ordered by house.

    Raises:
        UsageError: If `per_split` is below 1.
    """
    if per_split < 1:
        raise UsageError(f"A subset needs at least 1 task per split, found {per_split}.")
    every = tasks_of(sets)
    drawn: set[str] = set()
    for split in Split:
        ids = [task.id for task in every if task.split == split]
        order = torch.randperm(len(ids), generator=generator)[:per_split]
        drawn.update(ids[k] for k in order.tolist())
    return tuple(task.id for task in every if task.id in drawn)


def evaluate_with_dqn(
    learned: Reward | Policy,
    sets: Sequence[TaskSet],
    config: DqnConfig,
    *,
    generator: torch.Generator,
    chosen: Collection[str] | None = None,
    progress: Callable[[int, int], None] = lambda _done, _total: None,
) -> tuple[Outcome, ...]:
    """Re-optimise a reward by DQN, and evaluate the greedy policies exactly.

    The result of a task doesn't depend on which others are chosen.

    Args:
        learned: The reward.
        sets: The tasks.
        config: Settings of the agents.
        generator: A CPU generator, which draws a seed for every task, chosen or not.
        chosen: Ids of the tasks to solve; None means all.
        progress: Called with the number of learning steps done, and their total.

    Raises:
        UsageError: If `learned` is a policy, or no task is chosen.
    """
    if isinstance(learned, Policy):
        reason = "A policy has no reward that DQN could optimise."
        raise UsageError(f"{reason} Evaluate it without an optimizer.")
    parts = _score(learned, sets, generator, chosen)
    if not parts:
        raise UsageError("None of the chosen tasks is in this benchmark: DQN has nothing to solve.")
    groups = _groups(parts)
    outcomes: list[Outcome] = []
    for number, group in enumerate(groups):

        def tell(done: int, rounds: int, before: int = number) -> None:
            progress(before * rounds + done, len(groups) * rounds)

        policies = solve_seeded(
            [part.tasks for part in group],
            [part.reward for part in group],
            config,
            seeds=torch.cat([part.seeds for part in group]),
            progress=tell,
        )
        for part, policy in zip(group, policies, strict=True):
            outcome = follow(part.tasks, policy.double(), waypoint=part.tasks.held)
            outcomes += outcomes_of(part.tasks, outcome)
    return tuple(outcomes)


def _score(
    learned: Reward,
    sets: Sequence[TaskSet],
    generator: torch.Generator,
    chosen: Collection[str] | None,
) -> list[_Part]:
    """Score the chosen tasks, and give each the seed of its position among all."""
    wanted = None if chosen is None else set(chosen)
    parts = []
    for house in by_house(sets):
        some: list[tuple[TaskSet, torch.Tensor]] = []
        for tasks in (part for each in house for part in each.parts):
            seeds = torch.randint(1 << 62, (len(tasks),), generator=generator)
            kept = [k for k, t in enumerate(tasks.tasks) if wanted is None or t.id in wanted]
            if kept:
                some.append((tasks.rows(kept), seeds[kept]))
        if some:
            said = [command for tasks, _ in some for command in tasks.commands]
            answers = ask(learned, house[0].views.observed, said)
            parts += [_Part(tasks, answers.reward_of(tasks), seeds) for tasks, seeds in some]
    return parts


def _groups(parts: Sequence[_Part]) -> list[list[_Part]]:
    """Groups of consecutive parts, of about `TASKS_AT_ONCE` tasks each."""
    groups: list[list[_Part]] = [[]]
    for part in parts:
        size = sum(len(other.tasks) for other in groups[-1])
        if groups[-1] and size + len(part.tasks) > TASKS_AT_ONCE:
            groups.append([])
        groups[-1].append(part)
    return groups


def optimize_again(
    folder: RunFolder,
    learned: Reward | Policy,
    sets: Sequence[TaskSet],
    optimizer: Optimizer,
    settings: DqnSettings,
    *,
    seed: int,
    tell: Callable[[float], None],
) -> Results:
    """Optimise a run's reward by DQN on a sample of the tasks, and write the results.

    Existing results of these settings and this model are read instead of computed again.

    Args:
        folder: The run's folder; two files are written into it, the summary last.
        learned: What the run learned.
        sets: The tasks.
        optimizer: DQN, with or without shaping.
        settings: The settings of DQN.
        seed: Seed of all its randomness.
        tell: Called with the fraction done.

    Raises:
        FolderInUseError: If another process is writing the run.
        UsageError: If the run learned a policy, which has no reward to optimise.
    """
    summary, episodes = optimizer_files(folder, optimizer)
    with locked(summary):
        model = model_digest(folder.path)
        if not is_current(summary, settings, model):
            _optimize(folder, learned, sets, optimizer, settings, seed, tell)
    return Results.read(f"{optimizer.value}", {seed: episodes})


def _optimize(
    folder: RunFolder,
    learned: Reward | Policy,
    sets: Sequence[TaskSet],
    optimizer: Optimizer,
    settings: DqnSettings,
    seed: int,
    tell: Callable[[float], None],
) -> None:
    began = time.perf_counter()
    sampler = torch.Generator().manual_seed(settings.tasks_seed)
    outcomes = evaluate_with_dqn(
        learned,
        sets,
        settings.config,
        generator=torch.Generator().manual_seed(seed),
        chosen=sample_tasks(sets, settings.tasks_per_split, sampler),
        progress=lambda done, total: tell(done / total),
    )
    summary, episodes = optimizer_files(folder, optimizer)
    results = Results.of(optimizer.value, seed, outcomes)
    folder.write_episodes(results, file=episodes.name)
    document = {
        "optimizer": optimizer.value,
        "settings": asdict(settings),
        "model": model_digest(folder.path),
        "splits": results.splits(),
        "finished": datetime.now().astimezone().isoformat(),
        "wall_s": round(time.perf_counter() - began, 3),
    }
    write_json(summary, document)


def optimizer_files(folder: RunFolder, optimizer: Optimizer) -> tuple[Path, Path]:
    """The summary of an optimizer's results for a run, which is written last, and its episodes."""
    if optimizer == Optimizer.Q_ITERATION:
        return folder.path / "summary.json", folder.path / EPISODES_FILE
    return folder.path / f"{optimizer.value}.json", folder.path / f"{optimizer.value}.parquet"


def is_current(summary: Path, settings: DqnSettings, model: str | None) -> bool:
    """Whether there is a summary of DQN, and it is of these settings and this model."""
    if not summary.exists():
        return False
    found = read_json(summary)
    return found.get("settings") == asdict(settings) and found.get("model") == model
