"""The comparisons that are measured in a house: each computation that matters, and its variants.

Whatever is prepared once per house (one-hot images, the index of distinct patches) is prepared
before the clock starts, for every variant.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from typing import Final, cast

import torch

from lcrl_bench.mdp.dqn.agents import DqnAgents
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.learning import act_and_learn
from lcrl_bench.mdp.dqn.stack import TaskStack
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.maximum_entropy import soft_marginals
from lcrl_bench.mdp.planning import q_iteration, soft_q_iteration
from lcrl_bench.mdp.policy_outcome import PolicyOutcome, follow, follow_greedy
from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch
from lcrl_bench.mdp.visitation import occupancy
from lcrl_bench.networks.fusion import gather_panoramas
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from tools.speed.dense_encoder import convolve_views, one_hot_images
from tools.speed.timing import Comparison, Kernel, Variant, kernel_set_to
from tools.speed.workload import Workload

NETWORK_LIMIT: Final = 1e-3
"""Networks are float32, and where two windows of a view tie within rounding, either may receive the
gradient."""
SOFT_LIMIT: Final = 1e-4
"""The soft planner is float32."""
GREEDY_LIMIT: Final = 1e-9
"""Greedy evaluation is float64."""

_TEMPERATURE: Final = 1.0

_Embed = Callable[[PanoramaEncoder], torch.Tensor]
"""Maps an encoder to the embeddings of all views: float [view, size]."""


def comparisons(load: Workload, *, kernels: bool) -> tuple[Comparison, ...]:
    """All comparisons to measure in a house.

    Args:
        load: The house.
        kernels: Whether compiled kernels are available; variants that need them are left out if
            not, and so is a comparison with no other variant beside its reference.
    """
    images = one_hot_images(load.house[0].views.views, classes=load.index.classes)

    def dense(encoder: PanoramaEncoder) -> torch.Tensor:
        return convolve_views(encoder, images)

    distinct = embed_distinct(load)
    made = (
        _encoding(load, dense, distinct),
        _soft_planning(load),
        _greedy_evaluation(load),
        _training_step(load, dense, distinct),
        _agents(load),
    )
    if kernels:
        return made
    plain = [tuple(v for v in each.variants if v.kernel != "numba") for each in made]
    return tuple(
        Comparison(each.name, variants, each.limit)
        for each, variants in zip(made, plain, strict=True)
        if len(variants) > 1
    )


def embed_distinct(load: Workload) -> _Embed:
    """The suite's own encoder: each distinct patch of a house once."""

    def distinct(encoder: PanoramaEncoder) -> torch.Tensor:
        return encoder.embed_views(load.index)

    return distinct


def _encoding(load: Workload, dense: _Embed, distinct: _Embed) -> Comparison:
    """Embeddings of every view, and the gradient of their sum with respect to every weight."""
    parameters = list(load.encoder.parameters())

    def by(embed: _Embed) -> Callable[[], Sequence[torch.Tensor]]:
        def compute() -> Sequence[torch.Tensor]:
            output = embed(load.encoder)
            return [output.detach(), *torch.autograd.grad(output.sum(), parameters)]

        return compute

    variants = (
        Variant("dense convolution", by(dense)),
        Variant("distinct patches, torch", by(distinct)),
        Variant("distinct patches, compiled", by(distinct), "numba"),
    )
    return Comparison("image encoder, forward and backward", variants, NETWORK_LIMIT)


def _soft_planning(load: Workload) -> Comparison:
    """Occupancy and start values of the soft-optimal policy of every training task."""
    pairs = [(tasks, _reward(tasks).float()) for tasks in load.prepared.tasks]

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

    variants = (
        Variant("soft Q-iteration, then occupancy", policy),
        Variant("marginals alone, torch", marginals),
        Variant("marginals alone, compiled", marginals, "numba"),
    )
    return Comparison("soft planner", variants, SOFT_LIMIT)


def _greedy_evaluation(load: Workload) -> Comparison:
    """Outcome of the greedy policy of a random reward, for every task of every split."""
    given = [(part, _reward(part), part.held) for tasks in load.tasks for part in tasks.parts]

    def by(
        go: Callable[[TaskBatch, torch.Tensor, torch.Tensor], PolicyOutcome],
    ) -> Callable[[], Sequence[torch.Tensor]]:
        def compute() -> Sequence[torch.Tensor]:
            outcomes = [go(*each) for each in given]
            return [part for o in outcomes for part in (o.arrival, o.final, o.goal_value, o.passed)]

        return compute

    def planned(batch: TaskBatch, r: torch.Tensor, held: torch.Tensor) -> PolicyOutcome:
        return follow(batch, q_iteration(batch, r).policy, waypoint=held)

    def fused(batch: TaskBatch, r: torch.Tensor, held: torch.Tensor) -> PolicyOutcome:
        return follow_greedy(batch, r, waypoint=held)

    variants = (
        Variant("Q-iteration, then its policy followed", by(planned)),
        Variant("outcome alone, compiled", by(fused), "numba"),
    )
    return Comparison("greedy evaluation", variants, GREEDY_LIMIT)


def _training_step(load: Workload, dense: _Embed, distinct: _Embed) -> Comparison:
    """One LC-RL step on the tasks of the house: loss, gradients, Adam."""

    def by_torch(encoder: PanoramaEncoder) -> torch.Tensor:
        with kernel_set_to("torch"):
            return distinct(encoder)

    variants = (
        Variant("dense convolution, torch", TrainingStep(load, dense)),
        Variant("distinct patches, torch", TrainingStep(load, distinct)),
        Variant("distinct patches, compiled", TrainingStep(load, distinct), "numba"),
        Variant("the same, encoder by torch", TrainingStep(load, by_torch), "numba"),
        Variant("the same, planner by torch", TrainingStep(load, distinct, "torch"), "numba"),
    )
    return Comparison("training step of LC-RL", variants, NETWORK_LIMIT)


class TrainingStep:
    """Repeated training steps on one house, with a network of its own."""

    def __init__(self, load: Workload, embed: _Embed, planner: Kernel | None = None) -> None:
        """Start with the network of a house.

        Args:
            load: The house.
            embed: Embeds its views.
            planner: `LCRL_BENCH_KERNEL` while it plans; None for that of the rest.
        """
        self._load, self._embed = load, embed
        self._planner: Kernel | None = planner
        self._network = copy.deepcopy(load.network)
        # As `train_house_by_house` does.
        self._optimizer = torch.optim.AdamW(
            self._network.parameters(),
            lr=load.method.config.learning_rate,
            weight_decay=load.method.config.weight_decay,
            fused=True,
        )

    def __call__(self) -> Sequence[torch.Tensor]:
        """One step; returns the loss, and all gradients as one vector.

        One vector, because the gradient of the output's bias is nothing but rounding: two
        distributions are compared, and a constant adds the same to both.
        """
        network, house = self._network, self._load.prepared
        views = self._embed(cast(PanoramaEncoder, network.image))
        features = gather_panoramas(network.config.views, views, self._load.index.panoramas)
        commands = network.embed_commands(house.tokens, house.lengths)
        with kernel_set_to(self._planner) if self._planner else nullcontext():
            surrogate, loss = self._load.method.objective(network, features, commands, house)
        self._optimizer.zero_grad()
        surrogate.backward()
        self._optimizer.step()
        gradients = [each.grad for each in network.parameters() if each.grad is not None]
        return [torch.tensor(loss), torch.cat([each.flatten() for each in gradients])]


def _agents(load: Workload) -> Comparison:
    """AGILE's agents of all training tasks act and learn for some rounds."""
    variants = (
        Variant("all agents, round by round, torch", AgentRounds(load)),
        Variant("agent by agent, compiled", AgentRounds(load), "numba"),
    )
    return Comparison(f"{AgentRounds.ROUNDS} rounds of AGILE's agents", variants, NETWORK_LIMIT)


class AgentRounds:
    """Repeated rounds of the agents of a house, with networks of their own."""

    ROUNDS: Final = 10

    def __init__(self, load: Workload) -> None:
        """Put new agents at the starts of the training tasks of a house."""
        stack = TaskStack.of(load.prepared.tasks)
        seeds = torch.arange(stack.tasks)
        # The sizes of AGILE's, which pays for about one observation in ten.
        config = DqnConfig(hidden=32, replay=10_000, shaping="none")
        self._agents = DqnAgents(stack, config, seeds=seeds)
        parameters = self._agents.networks.parameters()
        self._optimizer = torch.optim.AdamW(parameters, lr=3e-3, weight_decay=0.0, fused=True)
        shape = stack.tasks, stack.states // HEADINGS
        drawn = torch.rand(shape, generator=torch.Generator().manual_seed(0))
        self._rewards = (drawn > 0.9).float().to(stack.start.device)

    def __call__(self) -> Sequence[torch.Tensor]:
        """Some rounds; returns their mean loss."""
        agents, optimizer = self._agents, self._optimizer
        loss = act_and_learn(agents, self._rewards, None, optimizer, rounds=self.ROUNDS)
        return [torch.tensor(loss)]


def _reward(batch: TaskBatch) -> torch.Tensor:
    """A random reward, the same on every call: float64 [task, cell]."""
    generator = torch.Generator().manual_seed(0)
    drawn = torch.randn(batch.goal.shape, generator=generator, dtype=torch.float64)
    return drawn.to(batch.goal.device)
