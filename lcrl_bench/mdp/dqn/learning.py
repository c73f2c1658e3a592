"""`act_and_learn`: rounds of acting and learning, for all agents at once.

A round is a step in every episode, and a step of Adam on a batch of every agent's memory. Between
two rounds agents know nothing of each other, so a compiled kernel may take the rounds of one agent
after the other.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch

from lcrl_bench.mdp.dqn.agents import MEMORY, DqnAgents
from lcrl_bench.mdp.dynamics import check_transitions
from lcrl_bench.mdp.kernels.dispatch import parallel_for, use_kernel


def act_and_learn(
    agents: DqnAgents,
    rewards: torch.Tensor,
    potentials: torch.Tensor | None,
    optimizer: torch.optim.Optimizer,
    *,
    rounds: int,
) -> float:
    """Let all agents act and learn.

    With two hidden layers, on a CPU, a compiled kernel is used where available (`mdp.kernels`): the
    same random numbers, and the same results within rounding, which learning amplifies.

    Args:
        agents: Changed in place.
        rewards: float32 [task, cell] of the stack, finite.
        potentials: float32 [task, state] of the stack: phi; None for no shaping.
        optimizer: Adam, in which the agents' networks are a group of their own, without weight
            decay. Nothing else in it has a gradient, or moves.
        rounds: How many.

    Returns:
        The mean temporal-difference loss of all rounds and agents.
    """
    kernel = use_kernel(rewards.device) and len(agents.networks.weights) == 2
    learn = _learn_compiled if kernel else _learn
    return learn(agents, rewards, potentials, optimizer, rounds)


def _learn(
    agents: DqnAgents,
    rewards: torch.Tensor,
    potentials: torch.Tensor | None,
    optimizer: torch.optim.Optimizer,
    rounds: int,
) -> float:
    """`act_and_learn` by torch, all agents round by round."""
    total = rewards.new_zeros(())
    for _ in range(rounds):
        agents.act()
        loss = agents.loss(rewards, potentials)
        optimizer.zero_grad()
        # A sum: each task's gradient is that of its own loss.
        loss.sum().backward()
        optimizer.step()
        agents.copy_targets()
        total += loss.detach().mean()
    return float(total) / rounds


def _learn_compiled(
    agents: DqnAgents,
    rewards: torch.Tensor,
    potentials: torch.Tensor | None,
    optimizer: torch.optim.Optimizer,
    rounds: int,
) -> float:
    """`act_and_learn` compiled, agent by agent."""
    # Here, so that importing the agents does not import numba.
    from lcrl_bench.mdp.dqn.kernels import learning as kernel

    stack, config = agents.stack, agents.config
    check_transitions(stack)
    parameters = agents.networks.layers
    moments = [_adam_state(optimizer, parameter) for parameter in parameters]
    shaping = rewards.new_zeros(stack.tasks, 0) if potentials is None else potentials
    losses = np.empty(stack.tasks)
    arguments = (
        _arrays(stack.next_state, stack.start, stack.inputs, rewards, shaping, agents.draws.seeds),
        _arrays(agents.states, agents.replay.ring),
        _arrays(*parameters),
        _arrays(*agents.targets.layers),
        _arrays(*(state["exp_avg"] for state in moments)),
        _arrays(*(state["exp_avg_sq"] for state in moments)),
        _arrays(agents.mean, agents.square),
        _plan(agents, _group_of(optimizer, parameters[0]), int(moments[0]["step"]), rounds),
    )
    parallel_for(stack.tasks, lambda first, end: kernel.learn(*arguments, first, end, losses))
    for state in moments:
        state["step"] += rounds
    agents.draws.counter += rounds * (2 * config.episodes + config.batch)
    agents.replay.written += rounds * config.episodes
    agents.rounds += rounds
    agents.learned += rounds
    return float(losses.mean()) / rounds


def _plan(agents: DqnAgents, group: dict[str, Any], descended: int, rounds: int) -> tuple[Any, ...]:
    """What is the same for all agents.

    Args:
        agents: Before the first round.
        group: Adam's settings.
        descended: Steps that Adam has taken.
        rounds: How many there will be.

    Returns:
        Three groups: numbers drawn, transitions written, rounds taken, horizon, gradient steps
        taken, steps between copies to the targets, batch, whether Double DQN, gamma; of Adam
        1 - beta_1, beta_2, 1 - beta_2, epsilon; and float32 [round, 4]: exploration, weight of new
        rewards, step size, square root of the second moment's correction.
    """
    config, learned = agents.config, int(agents.learned)
    beta, beta_square = group["betas"]
    each = [
        (
            config.exploration(int(agents.rounds) + t),
            1.0 / min(learned + t + 1, MEMORY),
            group["lr"] / (1.0 - beta ** (descended + t + 1)),
            math.sqrt(1.0 - beta_square ** (descended + t + 1)),
        )
        for t in range(rounds)
    ]
    return (
        (
            *(int(agents.draws.counter), int(agents.replay.written)),
            *(int(agents.rounds), agents.stack.horizon, learned, config.target_interval),
            *(config.batch, config.double, agents.stack.discount),
        ),
        tuple(
            np.float32(number)
            for number in (1.0 - beta, beta_square, 1.0 - beta_square, group["eps"])
        ),
        np.array(each, np.float32).reshape(rounds, 4),
    )


def _group_of(optimizer: torch.optim.Optimizer, parameter: torch.Tensor) -> dict[str, Any]:
    """The group of the optimizer that a parameter is in."""
    groups = optimizer.param_groups
    return next(g for g in groups if any(each is parameter for each in g["params"]))


def _adam_state(
    optimizer: torch.optim.Optimizer, parameter: torch.Tensor
) -> dict[str, torch.Tensor]:
    """Adam's state of a parameter, made as its first step would."""
    state = optimizer.state[parameter]
    if not state:
        state["step"] = torch.zeros(())
        state["exp_avg"] = torch.zeros_like(parameter, requires_grad=False)
        state["exp_avg_sq"] = torch.zeros_like(parameter, requires_grad=False)
    return state


def _arrays(*tensors: torch.Tensor) -> tuple[np.ndarray, ...]:
    """The same memory as arrays."""
    return tuple(tensor.detach().numpy() for tensor in tensors)
