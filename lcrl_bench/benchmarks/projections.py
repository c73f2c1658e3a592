"""The true reward as a function of the observation: three projections and what they mean.

A panorama does not determine the state. From most tiles of a PICK task, neither place of the object
is visible, and all three object states look alike.

- `CELLS`: the mean over the cells that look alike, each counted once. It pays a third of the reward
  on every tile that sees neither place, from the first step on; if the goal is far, standing there
  gains more than arriving late. Which tasks fail depends on the distance, not on the
  cameras.
- `EPISODE`: the mean over what can happen in an episode, each state counted once for each step at
  which some sequence of actions from the task's start leads to it. The object can't be at its new
  place before it was fetched and carried, so on a tile that sees neither place the mean is low. The
  weights reflect what can happen, not what a particular policy does.
- `CERTAIN`: the reward if the goal holds in all states that look alike, else 0. Its optimum
  succeeds with certainty exactly if a view that proves the goal can be reached in time. It is not
  an upper bound: a mean may pay for waiting where a tied action solves a task unseen.
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
"""Success with the projected reward from which views count as sufficient."""


class Projection(StrEnum):
    """How to reward a panorama shared by several states; see the module."""

    CELLS = "cells"
    EPISODE = "episode"
    CERTAIN = "certain"


def project_reward(tasks: TaskSet, projection: Projection) -> torch.Tensor:
    """The true reward of each task as a function of the observation.

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
    # Views that no episode can reach are paid nothing; no solver ever collects it.
    return (total / count.clamp(min=1)).gather(1, looks)


def success_by_sight(tasks: TaskSet, projection: Projection) -> torch.Tensor:
    """Exact success of each task when its projected reward is optimised: float64 [task]."""
    reward = project_reward(tasks, projection)
    return success_probability(tasks, q_iteration(tasks, reward).policy)


def alike(tasks: TaskSet) -> torch.Tensor:
    """A number for the view in each cell, equal for equal views: int64 [task, cell]."""
    rows = tasks.views.panorama_views
    return torch.unique(rows, dim=0, return_inverse=True)[1][tasks.panoramas]


def episode_weights(batch: TaskBatch) -> torch.Tensor:
    """Number of steps t = 0..H at which some actions lead from the start to each cell.

    Headings are counted separately.

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
