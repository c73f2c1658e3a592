"""LC-RL: a reward of panorama and command, learned by maximum causal entropy IRL.

Letters of the paper: r_theta(o, L) reward, rho_D state marginal of the demonstrations, rho_theta
that of the optimal policy under r_theta, gamma discount, alpha temperature.

    maximise   E_task E_demonstrations log p_theta(tau, L)                        (equation 3)
    gradient   sum_s (rho_D(s) - rho_theta(s)) grad r_theta(o(s), L)              (equation 2)

Both marginals are exact sums over the horizon, sum_t gamma^t d_t(s), the last state included.

Source: Fu et al., "From Language to Goals: Inverse Reinforcement Learning for Vision-Based
Instruction Following" (ICLR 2019), section "Language-Conditioned Reward Learning", Algorithm 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.occupancy import empirical_occupancy, occupancy, occupancy_mass
from lcrl_bench.mdp.q_iteration import soft_q_iteration
from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.methods.checkpoint import restore_checkpoint, save_checkpoint, training_identity
from lcrl_bench.methods.contract import Log, Method, TrainHouse, TrainSet
from lcrl_bench.methods.network_reward import NetworkReward, config_document
from lcrl_bench.networks.fusion import FusionName
from lcrl_bench.networks.grounding import build_index
from lcrl_bench.networks.patches import PatchIndex
from lcrl_bench.networks.reward_network import RewardNetwork, RewardNetworkConfig
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class LcRlConfig:
    """Settings of LC-RL."""

    passes: int = 60
    """How often every training house is taken; one step of Adam a house."""
    least_steps: int = 1_000
    """Where houses are few, passes are added until there are this many steps."""
    learning_rate: float = 2e-3
    """Adam's, at the start; it falls to zero along half a cosine. (Paper: 5e-4.)"""
    temperature: float = 1.0
    """alpha of the soft policy, in units of reward. (The paper gives none.)"""
    clip: float = 0.0
    """Largest norm of a gradient; 0 for no limit."""
    fusion: FusionName = "mult"
    """How image and command embeddings combine: mult (the paper's choice), add or concat."""
    filters: int = 16
    """Filters of the first convolution."""
    size: int = 32
    """Length of every embedding."""
    hidden: int = 32
    """Units of the fully connected layer before the output."""
    checkpoint_passes: int = 5
    """Passes from one checkpoint to the next."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        if self.least_steps < 0:
            raise UsageError("least_steps must not be negative.")
        if min(self.passes, self.checkpoint_passes, self.filters, self.size, self.hidden) < 1:
            raise UsageError("passes, checkpoint_passes, filters, size and hidden start at 1.")
        if not (self.learning_rate > 0 and self.temperature > 0 and self.clip >= 0):
            raise UsageError("learning_rate and temperature must be positive, clip not negative.")


class LcRl(Method):
    """Algorithm 1 of the paper, a house at a time."""

    Config: ClassVar[type[LcRlConfig]] = LcRlConfig

    def __init__(self, config: LcRlConfig | None = None) -> None:
        """Keep the settings; None for the defaults."""
        self.config = config or LcRlConfig()
        self._reward: NetworkReward | None = None

    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> NetworkReward:
        """Learn a reward from demonstrations and dynamics; see `Method.fit`."""
        config = self.config
        identity = training_identity(train, config_document(config), generator)

        # Line 2: initialise r_theta.
        vocabulary = Vocabulary.of(train.vocabulary)
        network_config = RewardNetworkConfig(
            filters=config.filters, size=config.size, hidden=config.hidden, fusion=config.fusion
        )
        network = RewardNetwork(network_config, words=len(vocabulary), generator=generator)
        network.to(device)
        optimizer = torch.optim.Adam(network.parameters(), lr=config.learning_rate)

        # What stays the same at every step: repeated patches, rho_D, numbered words.
        houses = [_prepare(house, vocabulary, network_config, device) for house in train.houses]
        passes = max(config.passes, math.ceil(config.least_steps / len(houses)))
        steps = passes * len(houses)

        first = 0
        if checkpoint is not None:
            first = restore_checkpoint(checkpoint, network, optimizer, generator, identity=identity)
        for done in range(first, passes):
            order = torch.randperm(len(houses), generator=generator).tolist()
            # Lines 3 and 4: take a house, all its tasks, demonstrations and commands.
            for step, house in enumerate(order, start=done * len(houses)):
                for group in optimizer.param_groups:
                    group["lr"] = config.learning_rate * _cosine(step, steps)
                loss = self._step(network, optimizer, houses[house])
                log({"step": step + 1, "steps": steps, "loss": loss})
            if checkpoint is not None and _due(done + 1, passes, config):
                save_checkpoint(
                    checkpoint, network, optimizer, generator, done=done + 1, identity=identity
                )

        self._reward = NetworkReward(network.requires_grad_(False), vocabulary)
        return self._reward

    def _step(
        self, network: RewardNetwork, optimizer: torch.optim.Optimizer, house: _House
    ) -> float:
        """One gradient step on all tasks of a house.

        Returns:
            The mean negative log-likelihood of the demonstrations, in nats a step.
        """
        embeddings = network.encode(house.index)
        surrogate = embeddings.new_zeros(())
        likelihood_loss = 0.0
        for tasks in house.tasks:
            commands = network.embed_commands(tasks.tokens, tasks.lengths)
            r = network.score(embeddings, tasks.panoramas, commands)
            batch, mass = tasks.batch, occupancy_mass(tasks.batch.horizon, tasks.batch.discount)

            # Line 5: q* by soft Q-iteration, rho_theta by the forward algorithm. The dynamics hold
            # no end of episode, which would tell the planner where the goal is.
            solution = soft_q_iteration(batch, r.detach(), temperature=self.config.temperature)
            rho_theta = fold_cells(occupancy(batch, solution.policy, discount=batch.discount))

            # Line 6: the gradient of this sum in theta is minus equation (2). Dividing by the
            # mass of an occupancy makes it a difference of distributions, alike for any horizon.
            surrogate = surrogate + ((rho_theta - tasks.rho_demonstrations) * r).sum() / mass

            # V_0(s_0) - sum rho_D r is alpha times the negative log-likelihood, exactly: the
            # terms log pi_t = (Q_t - V_t) / alpha, weighted by gamma^t, telescope.
            v_start = solution.values[:, 0].gather(1, batch.start[:, None]).squeeze(1)
            fit = (tasks.rho_demonstrations * r.detach()).sum(1)
            likelihood_loss += float((v_start - fit).sum()) / mass / self.config.temperature

        optimizer.zero_grad()
        (surrogate / house.count).backward()
        if self.config.clip:
            torch.nn.utils.clip_grad_norm_(network.parameters(), self.config.clip)
        optimizer.step()
        return likelihood_loss / house.count

    def save(self, folder: Path) -> None:
        """Write the learned reward into `folder`.

        Raises:
            UsageError: If nothing has been learned yet.
        """
        if self._reward is None:
            raise UsageError("Nothing to save: call fit or load first.")
        self._reward.save(folder)

    def load(self, folder: Path) -> NetworkReward:
        """Read a learned reward back; its sizes are those it was saved with."""
        self._reward = NetworkReward.load(folder)
        return self._reward


@dataclass(frozen=True)
class _Tasks:
    """The tasks of one kind in a house, and what stays the same at every step."""

    batch: TaskBatch
    panoramas: torch.Tensor
    """int64 [task, cell]."""
    tokens: torch.Tensor
    """int64 [task, word]."""
    lengths: torch.Tensor
    """int64 [task]."""
    rho_demonstrations: torch.Tensor
    """float [task, cell]: discounted visits of the demonstrations."""


@dataclass(frozen=True)
class _House:
    """A training house, prepared."""

    index: PatchIndex
    tasks: tuple[_Tasks, ...]

    @property
    def count(self) -> int:
        """Number of tasks, of all kinds."""
        return sum(tasks.batch.tasks for tasks in self.tasks)


def _prepare(
    house: TrainHouse, vocabulary: Vocabulary, config: RewardNetworkConfig, device: torch.device
) -> _House:
    prepared = []
    for tasks in house.tasks:
        batch = tasks.batch.to(device)
        tokens, lengths = vocabulary.encode(tasks.commands)
        rho = empirical_occupancy(batch, tasks.demonstrations.to(device), discount=batch.discount)
        prepared.append(
            _Tasks(
                batch=batch,
                panoramas=tasks.panoramas.to(device),
                tokens=tokens.to(device),
                lengths=lengths.to(device),
                rho_demonstrations=fold_cells(rho),
            )
        )
    index = build_index(house.views.views, house.views.panorama_views, config).to(device)
    return _House(index, tuple(prepared))


def _cosine(step: int, steps: int) -> float:
    """From 1 at the first step to 0 after the last."""
    return 0.5 * (1.0 + math.cos(math.pi * step / steps))


def _due(done: int, passes: int, config: LcRlConfig) -> bool:
    """Whether a checkpoint is due after so many passes of all."""
    return done % config.checkpoint_passes == 0 or done == passes
