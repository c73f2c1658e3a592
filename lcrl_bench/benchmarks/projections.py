"""The true reward as a function of what is seen: three ways to project it, and what each means.

A panorama leaves open which of several states the agent is in. Most tiles of a PICK task see
neither place of the object, and there all three object states look alike.

- `CELLS`: the mean over the cells that look alike, each counted once. It pays a third of the reward
  at every tile that sees neither place, from the first step on; whoever has a long way to go gains
  more by standing there than by arriving late. What it fails depends on the length of the way, not
  on the eyes.
- `EPISODE`: the mean over what an episode can be, each state counted once for each step at which
  some sequence of actions leads there from the task's start. The object can't be at its new place
  before it was fetched and carried, so at a tile that sees nothing the mean is low. It weighs what
  can happen, not what some policy does.
- `CERTAIN`: the reward where the goal holds in every state that looks like it, else 0. Its optimum
  succeeds surely exactly where some view that proves the goal can be had in time. It is no upper
  bound: a mean may pay for waiting where a tied action fulfils a task unseen.
"""

from __future__ import annotations

from enum import StrEnum

import torch

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.dynamics import flat_start, flat_successors, fold_cells
from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.success import success_probability
from lcrl_bench.mdp.task_batch import TaskBatch

MIN_SUCCESS = 0.99
"""Success of the projected reward from which seeing counts as enough."""


class Projection(StrEnum):
    """How a panorama is paid that may mean several states; see the module."""

    CELLS = "cells"
    EPISODE = "episode"
    CERTAIN = "certain"


def project_reward(tasks: TaskSet, projection: Projection) -> torch.Tensor:
    """The true reward of each task as a function of what is seen.

    Returns:
        float64 [task, cell]; equal in cells that look alike.
    """
    success_reward = tasks.scene.semantics.success_reward
    reward = true_reward(tasks, success_reward, dtype=torch.float64)
    looks = alike(tasks)
    if projection is Projection.CERTAIN:
        lowest = torch.full((len(reward), int(looks.max()) + 1), torch.inf, dtype=torch.float64)
        return lowest.scatter_reduce_(1, looks, reward, "amin").gather(1, looks)
    weight = torch.ones_like(reward)
    if projection is Projection.EPISODE:
        weight = episode_weights(tasks)
    total = torch.zeros((len(reward), int(looks.max()) + 1), dtype=torch.float64)
    count = total.clone().scatter_add_(1, looks, weight)
    total.scatter_add_(1, looks, reward * weight)
    # What no episode can look like is paid nothing; no solver ever collects it.
    return (total / count.clamp(min=1)).gather(1, looks)


def success_by_sight(tasks: TaskSet, projection: Projection) -> torch.Tensor:
    """Exact success of each task when its projected reward is optimised: float64 [task]."""
    reward = project_reward(tasks, projection)
    return success_probability(tasks, q_iteration(tasks, reward).policy)


def alike(tasks: TaskSet) -> torch.Tensor:
    """A number for what is seen in each cell, equal where it is equal: int64 [task, cell]."""
    rows = tasks.views.panorama_views
    return torch.unique(rows, dim=0, return_inverse=True)[1][tasks.panoramas]


def episode_weights(batch: TaskBatch) -> torch.Tensor:
    """At how many steps t = 0..H some actions lead from the start to each cell.

    Each heading counts for itself.

    Returns:
        float64 [task, cell], whole numbers.
    """
    successors = flat_successors(batch)
    here = torch.zeros(len(batch) * batch.states, dtype=torch.bool)
    here[flat_start(batch)] = True
    count = here.to(torch.float64)
    for _ in range(batch.horizon):
        onward = torch.zeros_like(here)
        onward[successors.view(-1, len(here))[:, here].reshape(-1)] = True
        here = onward
        count += here
    return fold_cells(count.view(len(batch), batch.states))
