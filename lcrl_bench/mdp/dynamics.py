"""Index arithmetic shared by the solvers: all tasks of a batch as one flat state space.

Letters: N = tasks * states; the flat index of state s of task k is `k * states + s`. Actions come
first in every internal tensor, `[action, N]`, so that a maximum over actions is a maximum of
contiguous rows: several times faster on a CPU than a reduction over an innermost axis of four.
"""

from __future__ import annotations

from typing import Protocol

import torch

from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch


class Transitions(Protocol):
    """Tabular dynamics of several tasks: a `TaskBatch`, or a stack of them."""

    @property
    def next_state(self) -> torch.Tensor:
        """int64 [task, state, action]."""
        ...

    @property
    def start(self) -> torch.Tensor:
        """int64 [task]."""
        ...

    @property
    def states(self) -> int:
        """Number of states of each task."""
        ...


def flat_successors(batch: TaskBatch) -> torch.Tensor:
    """The flat index that each action leads to: int64 [action * N], actions first."""
    offsets = torch.arange(len(batch), device=batch.next_state.device) * batch.states
    return (batch.next_state + offsets[:, None, None]).permute(2, 0, 1).reshape(-1)


def flat_start(batch: TaskBatch) -> torch.Tensor:
    """The flat index of each task's first state: int64 [task]."""
    offsets = torch.arange(len(batch), device=batch.start.device) * batch.states
    return batch.start + offsets


def start_mass(batch: TaskBatch, *, dtype: torch.dtype) -> torch.Tensor:
    """d_0, all mass at each task's start: float [task, state]."""
    ones = torch.ones(len(batch), dtype=dtype, device=batch.start.device)
    mass = sum_into(len(batch) * batch.states, flat_start(batch), ones)
    return mass.view(len(batch), batch.states)


def spread_cells(values: torch.Tensor) -> torch.Tensor:
    """Repeat the values of cells for all four headings: [task, cell] -> [task, state]."""
    return values.repeat_interleave(HEADINGS, dim=-1)


def fold_cells(values: torch.Tensor) -> torch.Tensor:
    """Sum over the four headings of a cell: [..., state] -> [..., cell]."""
    return values.unflatten(-1, (-1, HEADINGS)).sum(-1)


def check_reward(batch: TaskBatch, reward: torch.Tensor) -> None:
    """Check that a reward fits the batch.

    Raises:
        ValueError: If it is not float [task, cell], or not finite.
    """
    expected = (len(batch), batch.cells)
    if tuple(reward.shape) != expected or not reward.is_floating_point():
        found = f"{reward.dtype} {list(reward.shape)}"
        raise ValueError(f"reward must be float [task, cell] = {list(expected)}, found {found}")
    if not bool(torch.isfinite(reward).all()):
        raise ValueError("reward holds a NaN or an infinity")


def check_transitions(tasks: Transitions) -> None:
    """Check that starts and transitions lead to states: compiled kernels don't check bounds.

    Args:
        tasks: On a CPU.

    Raises:
        ValueError: If one leads outside.
    """
    for name, tensor in (("next_state", tasks.next_state), ("start", tasks.start)):
        index = tensor.numpy()
        if index.size:
            least, most = int(index.min()), int(index.max())
            if least < 0 or most >= tasks.states:
                found = least if least < 0 else most
                raise ValueError(f"{name} leads to state {found}, outside 0 to {tasks.states - 1}")


def check_policy(batch: TaskBatch, policy: torch.Tensor) -> None:
    """Check that a policy fits the batch.

    Raises:
        ValueError: If it is not float [task, horizon, state, action].
    """
    expected = (len(batch), batch.horizon, batch.states, batch.next_state.shape[2])
    if tuple(policy.shape) != expected or not policy.is_floating_point():
        found = f"{policy.dtype} {list(policy.shape)}"
        raise ValueError(
            f"policy must be float [task, horizon, state, action] = {list(expected)}, found {found}"
        )


def sum_into(size: int, index: torch.Tensor, values: torch.Tensor) -> torch.Tensor:
    """Sum `values` by `index`, always in the same order.

    Args:
        size: Length of the result.
        index: int64 [n].
        values: float [n].

    Returns:
        float [size].
    """
    total = values.new_zeros(size)
    if values.device.type == "cpu":
        # Serial on a CPU whatever the number of threads, so the bits repeat.
        return total.scatter_add_(0, index, values)
    # On a GPU scatter_add_ adds in an arbitrary order; index_put_ sorts first.
    return total.index_put_((index,), values, accumulate=True)


def advance(
    mass: torch.Tensor, policy: torch.Tensor, successors: torch.Tensor, time: int
) -> torch.Tensor:
    """One step of the forward algorithm: d_{t+1}(s') = sum over (s, a) leading to s'.

    Args:
        mass: float [task, state], d_t.
        policy: float [task, horizon, state, action].
        successors: What `flat_successors` returned.
        time: t.

    Returns:
        float [task, state], d_{t+1}.
    """
    flow = mass * policy[:, time].permute(2, 0, 1)
    return sum_into(mass.numel(), successors, flow.reshape(-1)).view_as(mass)
