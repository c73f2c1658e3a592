"""From a learned reward or policy to an `Episode`: re-optimise it, follow it, record everything."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.compiled import CompiledHouse, CompiledTasks
from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.evaluation.outcome import Outcome
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.expert import expert_policy, true_reward
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.rollouts import rollout
from lcrl_bench.mdp.task_batch import HEADINGS, Action, TaskBatch
from lcrl_bench.mdp.visitation import occupancy
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.methods.observed_house import ObservedHouse, ask
from lcrl_bench.recording.episode import Episode


def episode_of(
    learned: Reward | Policy,
    problem: Problem,
    tasks: CompiledTasks,
    row: int,
    *,
    benchmark: Benchmark,
    method: str,
    seed: int,
) -> Episode:
    """Follow the most likely actions in one task.

    Args:
        learned: A reward is re-optimised exactly in the task's house; a policy acts as it is.
        problem: The house.
        tasks: A compiled set of that house, on the device of `problem.views`.
        row: Which of its tasks.
        benchmark: Gives name, fingerprint, discount and the true reward.
        method: Name of the method that learned it.
        seed: Of the run that learned it.
    """
    one = tasks.rows([row])
    batch = one.batch
    reward, value, policy = solve(learned, problem.observed, one)
    trajectory = rollout(batch, policy)
    states, actions = _array(trajectory.states[0, 0]), _array(trajectory.actions[0, 0])
    goal = _array(batch.goal[0])
    success_reward = benchmark.semantics.success_reward
    near_start, near_end = _near(one, problem.compiled)
    return Episode(
        compiled=problem.compiled,
        task=one.tasks[0],
        panoramas=_array(one.panoramas[0]),
        goal=goal,
        states=states,
        actions=actions,
        action_probabilities=_array(policy[0])[np.arange(len(actions)), states[:-1]],
        reward=reward,
        value=value,
        true_reward=_array(true_reward(batch, success_reward, dtype=torch.float64)[0]),
        occupancy=_visits(batch, policy),
        # Without a goal there is no expert.
        expert_occupancy=_visits(batch, expert_policy(batch, success_reward))
        if goal.any()
        else None,
        success=bool(goal[states // HEADINGS].any()),
        method=method,
        seed=seed,
        benchmark=benchmark.name,
        fingerprint=benchmark.fingerprint,
        near_start=near_start,
        near_end=near_end,
    )


def episodes_of(
    learned: Reward | Policy,
    problems: Sequence[Problem],
    outcomes: Sequence[Outcome],
    *,
    benchmark: Benchmark,
    method: str,
    seed: int,
) -> tuple[Episode, ...]:
    """The episode of each outcome, in order.

    Args:
        learned: What was evaluated.
        problems: The houses it was evaluated in.
        outcomes: Of tasks of those houses, such as a selection.
        benchmark: The benchmark.
        method: Name of the method.
        seed: Of the run.
    """
    places = {
        task.id: (problem, tasks, row)
        for problem in problems
        for tasks in problem.compiled.sets
        for row, task in enumerate(tasks.tasks)
    }
    return tuple(
        episode_of(learned, *places[outcome.task.id], benchmark=benchmark, method=method, seed=seed)
        for outcome in outcomes
    )


def solve(
    learned: Reward | Policy, house: ObservedHouse, one: CompiledTasks
) -> tuple[NDArray[np.float64] | None, NDArray[np.float64] | None, torch.Tensor]:
    """Apply a learned reward or policy to one task.

    Args:
        learned: A reward is re-optimised exactly; a policy acts as it is.
        house: What it is shown of the house.
        one: A set of one task.

    Returns:
        Reward [cell] and V_0 [state], None for a policy; the policy [1, horizon, state, action].
    """
    commands = [one.tasks[0].command]
    answers = ask(learned, house, commands)
    if answers.of_reward:
        reward = answers.reward(one.panoramas, commands)
        solution = q_iteration(one.batch, reward)
        return _array(reward[0]), _array(solution.values[0, 0]), solution.policy
    policy = answers.policy(one.panoramas, one.held, commands)
    return None, None, policy[:, None].expand(-1, one.batch.horizon, -1, -1)


def _visits(batch: TaskBatch, policy: torch.Tensor) -> NDArray[np.float64]:
    """Discounted visitation of each cell."""
    rho = occupancy(batch, policy.double(), discount=batch.discount)
    return _array(fold_cells(rho)[0])


def _near(
    one: CompiledTasks, compiled: CompiledHouse
) -> tuple[NDArray[np.bool_] | None, NDArray[np.bool_] | None]:
    """Where the object of PICK can be taken at A and put at B, read off the dynamics."""
    if one.tasks[0].kind == Kind.NAV:
        return None, None
    tiles = compiled.grid.tiles
    table = _array(one.batch.next_state[0])[::HEADINGS, Action.INTERACT] // HEADINGS // tiles
    by_state = table.reshape(len(ObjectState), tiles)
    return by_state[ObjectState.AT_A] == ObjectState.HELD, (
        by_state[ObjectState.HELD] == ObjectState.AT_B
    )


def _array(tensor: torch.Tensor) -> NDArray:
    return tensor.detach().cpu().numpy().copy()
