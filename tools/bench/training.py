"""Training: one pass of LC-RL, beside the loop that most would write first."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Final, cast

import torch

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.cli.bench import Figure
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.planning import soft_q_iteration
from lcrl_bench.mdp.visitation import occupancy
from lcrl_bench.networks.fusion import combine_views
from lcrl_bench.networks.grounding import build_index
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from tools.speed.comparisons import TrainingStep, embed_distinct
from tools.speed.dense_encoder import convolve_views, one_hot_images
from tools.speed.timing import kernel_set_to, torch_threads
from tools.speed.workload import Workload

PASS_GOAL: Final = 1500
"""How many times less CPU time than the plain loop."""
FIT_GOAL: Final = 60
"""CPU seconds."""

_REPEATS: Final = 5


def measure_training(loads: Sequence[Workload], houses: int) -> tuple[Figure, Figure]:
    """Train on every task of some houses, and on one task per kind by the plain loop.

    Args:
        loads: The houses. The plain loop's time for a house is that of the task measured, times
            the number of tasks of its kind.
        houses: Training houses of the whole benchmark, for the time of a whole training.
    """
    ours = theirs = preparing = 0.0
    with torch_threads(1):
        for load in loads:
            views = load.house[0].views
            config = load.network.config
            preparing += _cpu_seconds(
                partial(build_index, views.views, views.panorama_views, config)
            )
            step = TrainingStep(load, embed_distinct(load))
            with kernel_set_to("auto"):
                step()
                ours += min(_cpu_seconds(step) for _ in range(_REPEATS))
            plain = PlainLoop(load)
            for k, tasks in enumerate(load.prepared.tasks):
                theirs += len(tasks) * _cpu_seconds(partial(plain.step, k))
    tasks = sum(load.prepared.count for load in loads)
    passes = loads[0].method.config.passes_over(houses)
    fit = (preparing + passes * ours) / len(loads) * houses
    detail = {"ours_s": ours, "theirs_s": theirs, "houses": len(loads), "tasks": tasks}
    return (
        Figure(
            "training",
            f"a pass of LC-RL over {tasks} tasks",
            "plain torch, task by task",
            theirs / ours,
            "x",
            PASS_GOAL,
            detail=detail,
        ),
        Figure(
            "training",
            f"a whole fit of LC-RL, {passes} passes over {houses} houses, from these",
            "",
            fit,
            "s",
            FIT_GOAL,
            at_least=False,
            detail={"preparing_s": preparing, "step_s": ours / len(loads)},
        ),
    )


class PlainLoop:
    """LC-RL in plain torch: a step per task, on one-hot images of all that the task can see."""

    def __init__(self, load: Workload) -> None:
        """Start with the network of a house."""
        self._load = load
        self._network = copy.deepcopy(load.network)
        self._optimizer = torch.optim.Adam(
            self._network.parameters(), lr=load.method.config.learning_rate
        )

    def step(self, kind: int, row: int = 0) -> torch.Tensor:
        """Take one step on a task.

        Args:
            kind: Index of its task set among the house's.
            row: Its number in the set.

        Returns:
            The gradient, as one vector.
        """
        load, network = self._load, self._network
        task = cast(TaskSet, load.prepared.tasks[kind].rows([row]))
        number = sum(len(each) for each in load.prepared.tasks[:kind]) + row
        words, length = load.prepared.tokens[[number]], load.prepared.lengths[[number]]
        seen = task.views.panorama_views[task.panoramas[0]]
        images = one_hot_images(task.views.views[seen.flatten()], classes=load.index.classes)
        views = convolve_views(cast(PanoramaEncoder, network.image), images)
        features = combine_views(network.config.views, views.unflatten(0, seen.shape))
        command = network.embed_commands(words, length)
        r = network.score(features, torch.arange(len(features))[None], command)
        policy = soft_q_iteration(task, r.detach(), temperature=1.0).policy
        visits = fold_cells(occupancy(task, policy, discount=task.discount))
        loss = ((visits - task.demonstration_occupancy) * r).sum() / task.occupancy_mass
        self._optimizer.zero_grad()
        loss.backward()
        self._optimizer.step()
        gradients = [each.grad for each in network.parameters() if each.grad is not None]
        return torch.cat([each.flatten() for each in gradients])


def _cpu_seconds(work: Callable[[], object]) -> float:
    began = time.process_time()
    work()
    return time.process_time() - began
