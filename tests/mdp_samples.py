"""Random small MDPs, for laws that must hold whatever the dynamics."""

from __future__ import annotations

import torch

from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS, TaskBatch


def random_batch(
    seed: int, *, tasks: int = 2, cells: int = 3, horizon: int = 4, discount: float = 0.9
) -> TaskBatch:
    """Arbitrary dynamics, nothing like a house: any action may lead anywhere."""
    generator = torch.Generator().manual_seed(seed)
    states = cells * HEADINGS
    return TaskBatch(
        next_state=torch.randint(states, (tasks, states, ACTIONS), generator=generator),
        goal=torch.rand(tasks, cells, generator=generator) < 0.4,
        start=torch.randint(states, (tasks,), generator=generator),
        horizon=horizon,
        discount=discount,
    )


def random_reward(batch: TaskBatch, seed: int) -> torch.Tensor:
    """Standard normal rewards: float64 [task, cell]."""
    generator = torch.Generator().manual_seed(seed + 1_000_003)
    shape = (len(batch), batch.cells)
    return torch.randn(shape, generator=generator, dtype=torch.float64)


def random_policy(batch: TaskBatch, seed: int) -> torch.Tensor:
    """A stochastic time-indexed policy with some impossible actions: float64."""
    generator = torch.Generator().manual_seed(seed + 2_000_003)
    shape = (len(batch), batch.horizon, batch.states, ACTIONS)
    weights = torch.rand(shape, generator=generator, dtype=torch.float64)
    weights = weights * (weights > 0.3) + 1e-300
    return weights / weights.sum(-1, keepdim=True)


def corridor(length: int, *, goal_cell: int, horizon: int = 30) -> TaskBatch:
    """A straight corridor to the north, turning and all: one task, starting in cell 0 facing south.

    Cell k is the k-th tile; forward facing north or south moves along it, elsewhere it is blocked.
    """
    next_state = torch.zeros(1, length * HEADINGS, ACTIONS, dtype=torch.int64)
    for cell in range(length):
        for heading in range(HEADINGS):
            step = {0: 1, 2: -1}.get(heading, 0)
            ahead = cell + step if 0 <= cell + step < length else cell
            state = cell * HEADINGS + heading
            next_state[0, state, 0] = ahead * HEADINGS + heading
            next_state[0, state, 1] = cell * HEADINGS + (heading - 1) % HEADINGS
            next_state[0, state, 2] = cell * HEADINGS + (heading + 1) % HEADINGS
            next_state[0, state, 3] = state
    goal = torch.zeros(1, length, dtype=torch.bool)
    goal[0, goal_cell] = True
    return TaskBatch(next_state, goal, torch.tensor([2]), horizon, 0.99)
