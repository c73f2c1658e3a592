"""What `evaluation.speed` measures in a house: the computations that matter, each by several ways.

What is made once a house (one-hot images, the index of distinct patches) is made beforehand for
every way.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Final, cast

import torch

from lcrl_bench.evaluation.dense_encoder import convolve_views, one_hot_images
from lcrl_bench.evaluation.race import Contest, Way
from lcrl_bench.evaluation.workload import Workload
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.maximum_entropy import soft_marginals
from lcrl_bench.mdp.planning import q_iteration, soft_q_iteration
from lcrl_bench.mdp.policy_outcome import PolicyOutcome, follow, follow_greedy
from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.mdp.visitation import occupancy
from lcrl_bench.networks.fusion import gather_panoramas
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder

NETWORK_LIMIT: Final = 1e-3
"""Networks are float32; and where two windows of a view are equally large within rounding, either
may receive the gradient."""
SOFT_LIMIT: Final = 1e-4
"""The soft planner is float32."""
GREEDY_LIMIT: Final = 1e-9
"""Greedy evaluation is float64."""

_TEMPERATURE: Final = 1.0

_Embed = Callable[[PanoramaEncoder], torch.Tensor]
"""float [view, size] from an encoder."""


def contests(load: Workload, *, kernels: bool) -> tuple[Contest, ...]:
    """Everything that is measured in a house.

    Args:
        load: The house.
        kernels: Whether there are compiled kernels.
    """
    images = one_hot_images(load.house.views.views, classes=load.index.classes)

    def dense(encoder: PanoramaEncoder) -> torch.Tensor:
        return convolve_views(encoder, images)

    def distinct(encoder: PanoramaEncoder) -> torch.Tensor:
        return encoder.embed_views(load.index)

    made = (
        _encoding(load, dense, distinct),
        _soft_planning(load),
        _greedy_evaluation(load),
        _training_step(load, dense, distinct),
    )
    if kernels:
        return made
    without = [tuple(way for way in each.ways if way.kernel != "numba") for each in made]
    return tuple(
        Contest(each.name, ways, each.limit)
        for each, ways in zip(made, without, strict=True)
        if len(ways) > 1
    )


def _encoding(load: Workload, dense: _Embed, distinct: _Embed) -> Contest:
    """Embeddings of every view, and the gradient of their sum in every weight."""
    parameters = list(load.encoder.parameters())

    def by(embed: _Embed) -> Callable[[], Sequence[torch.Tensor]]:
        def compute() -> Sequence[torch.Tensor]:
            output = embed(load.encoder)
            return [output.detach(), *torch.autograd.grad(output.sum(), parameters)]

        return compute

    ways = (
        Way("dense convolution", by(dense)),
        Way("distinct patches, torch", by(distinct)),
        Way("distinct patches, compiled", by(distinct), "numba"),
    )
    return Contest("image encoder, forward and backward", ways, NETWORK_LIMIT)


def _soft_planning(load: Workload) -> Contest:
    """Visits and start values of the soft-optimal policy of every training task."""
    batches = [tasks.batch for tasks in load.prepared.tasks]
    pairs = [(batch, _reward(batch).float()) for batch in batches]

    def policy() -> Sequence[torch.Tensor]:
        found = []
        for batch, r in pairs:
            solution = soft_q_iteration(batch, r, temperature=_TEMPERATURE)
            rho = occupancy(batch, solution.policy, discount=batch.discount)
            start = solution.values[:, 0].gather(1, batch.start[:, None])
            found += [fold_cells(rho), start.squeeze(1)]
        return found

    def marginals() -> Sequence[torch.Tensor]:
        found = []
        for batch, r in pairs:
            solution = soft_marginals(batch, r, temperature=_TEMPERATURE)
            found += [solution.occupancy, solution.start_value]
        return found

    ways = (
        Way("soft Q-iteration, then occupancy", policy),
        Way("marginals alone, torch", marginals),
        Way("marginals alone, compiled", marginals, "numba"),
    )
    return Contest("soft planner", ways, SOFT_LIMIT)


def _greedy_evaluation(load: Workload) -> Contest:
    """What comes of a reward that is optimised again, for every task of every split."""
    given = [(part.batch, _reward(part.batch), part.held) for part in load.problem.parts]

    def by(
        go: Callable[[TaskBatch, torch.Tensor, torch.Tensor], PolicyOutcome],
    ) -> Callable[[], Sequence[torch.Tensor]]:
        def compute() -> Sequence[torch.Tensor]:
            journeys = [go(*each) for each in given]
            return [part for j in journeys for part in (j.arrival, j.final, j.goal_value, j.passed)]

        return compute

    def planned(batch: TaskBatch, r: torch.Tensor, held: torch.Tensor) -> PolicyOutcome:
        return follow(batch, q_iteration(batch, r).policy, waypoint=held)

    def fused(batch: TaskBatch, r: torch.Tensor, held: torch.Tensor) -> PolicyOutcome:
        return follow_greedy(batch, r, waypoint=held)

    ways = (
        Way("Q-iteration, then its policy followed", by(planned)),
        Way("journey alone, compiled", by(fused), "numba"),
    )
    return Contest("greedy evaluation", ways, GREEDY_LIMIT)


def _training_step(load: Workload, dense: _Embed, distinct: _Embed) -> Contest:
    """A step of LC-RL on the tasks of the house: loss, gradients, Adam."""
    ways = (
        Way("dense convolution, torch", _Step(load, dense)),
        Way("distinct patches, torch", _Step(load, distinct)),
        Way("distinct patches, compiled", _Step(load, distinct), "numba"),
    )
    return Contest("training step of LC-RL", ways, NETWORK_LIMIT)


class _Step:
    """Steps of training on one house, over and over, with a network of its own."""

    def __init__(self, load: Workload, embed: _Embed) -> None:
        self._load, self._embed = load, embed
        self._network = copy.deepcopy(load.network)
        # As `train_house_by_house` does.
        self._optimizer = torch.optim.AdamW(
            self._network.parameters(),
            lr=load.method.config.learning_rate,
            weight_decay=load.method.config.weight_decay,
            fused=True,
        )

    def __call__(self) -> Sequence[torch.Tensor]:
        """One step; the loss, and all gradients as one vector.

        One vector, as the output's bias has a gradient of nothing but rounding: two distributions
        are compared, and a constant adds the same to both.
        """
        network, house = self._network, self._load.prepared
        views = self._embed(cast(PanoramaEncoder, network.image))
        features = gather_panoramas(network.config.views, views, self._load.index.panoramas)
        commands = network.embed_commands(house.tokens, house.lengths)
        surrogate, loss = self._load.method.objective(network, features, commands, house)
        self._optimizer.zero_grad()
        surrogate.backward()
        self._optimizer.step()
        gradients = [each.grad for each in network.parameters() if each.grad is not None]
        return [torch.tensor(loss), torch.cat([each.flatten() for each in gradients])]


def _reward(batch: TaskBatch) -> torch.Tensor:
    """A reward drawn for every cell, always the same: float64 [task, cell]."""
    generator = torch.Generator().manual_seed(0)
    drawn = torch.randn(batch.goal.shape, generator=generator, dtype=torch.float64)
    return drawn.to(batch.goal.device)
