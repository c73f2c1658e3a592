"""Re-optimise rewards by DQN, without knowledge of the dynamics."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch

from lcrl_bench.mdp.dqn.agents import DqnAgents
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.learning import act_and_learn
from lcrl_bench.mdp.dqn.shaping import optimal_values
from lcrl_bench.mdp.dqn.stack import TaskStack, pad_states
from lcrl_bench.mdp.dynamics import check_reward
from lcrl_bench.mdp.task_batch import TaskBatch

Progress = Callable[[int, int], None]
"""Called with the number of rounds done and their total."""

_ROUNDS_AT_ONCE = 100
"""Rounds between two reports of progress."""


def solve_dqn(
    batches: Sequence[TaskBatch],
    rewards: Sequence[torch.Tensor],
    config: DqnConfig,
    *,
    generator: torch.Generator,
    potentials: Sequence[torch.Tensor] | None = None,
    progress: Progress = lambda _done, _rounds: None,
) -> list[torch.Tensor]:
    """Learn a policy for each task by interaction.

    Args:
        batches: Tasks of any houses, all solved in parallel.
        rewards: float [task, cell] for each batch; paid on arrival.
        config: Settings.
        generator: A CPU generator: one seed per task is drawn, in order.
        potentials: float [task, state] for each batch: phi, overriding `config.shaping`; None for
            the potential named there.
        progress: Called after every hundred rounds, and after the last.

    Returns:
        The greedy policies, float [task, horizon, state, action] for each batch, the same at all
        times.

    Raises:
        ValueError: If a reward does not fit its batch.
        UsageError: If there is no batch, or batches differ in horizon or discount.
    """
    tasks = sum(len(batch) for batch in batches)
    seeds = torch.randint(1 << 62, (tasks,), generator=generator)
    return solve_seeded(
        batches, rewards, config, seeds=seeds, potentials=potentials, progress=progress
    )


def solve_seeded(
    batches: Sequence[TaskBatch],
    rewards: Sequence[torch.Tensor],
    config: DqnConfig,
    *,
    seeds: torch.Tensor,
    potentials: Sequence[torch.Tensor] | None = None,
    progress: Progress = lambda _done, _rounds: None,
) -> list[torch.Tensor]:
    """As `solve_dqn`, with given seeds: int64 [task], over all batches.

    A task's policy depends on its own seed alone, not on the other tasks.
    """
    for batch, reward in zip(batches, rewards, strict=True):
        check_reward(batch, reward)
    if potentials is None and config.shaping == "optimal-value":
        potentials = [optimal_values(*pair) for pair in zip(batches, rewards, strict=True)]
    stack = TaskStack.of(batches)
    agents = DqnAgents(stack, config, seeds=seeds)
    paid = _stacked(rewards, stack.states)
    phi = None if potentials is None else _stacked(potentials, stack.states)
    optimizer = torch.optim.Adam(agents.networks.parameters(), lr=config.learning_rate, fused=True)
    for done in range(0, config.rounds, _ROUNDS_AT_ONCE):
        rounds = min(_ROUNDS_AT_ONCE, config.rounds - done)
        act_and_learn(agents, paid, phi, optimizer, rounds=rounds)
        progress(done + rounds, config.rounds)
    parts = agents.greedy().split([len(batch) for batch in batches])
    return [
        part[:, None, : batch.states].expand(-1, batch.horizon, -1, -1)
        for batch, part in zip(batches, parts, strict=True)
    ]


def _stacked(values: Sequence[torch.Tensor], length: int) -> torch.Tensor:
    """Stack [task, n] of several batches, padded with zeros: float32 [task, length]."""
    return torch.cat([pad_states(part.detach().float(), length) for part in values])
