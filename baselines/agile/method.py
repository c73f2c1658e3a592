"""AGILE: a discriminator of goal states, and DQN agents that try to be taken for done.

Letters: D(o, L) probability that observation o fulfils command L, l its logit, rho share of the
agents' observations that are kept as negatives, s state, gamma discount.

    agents          maximise sum_t gamma^t 1[D(o_t, L) > 1/2]                    (by DQN)
    discriminator   minimise - E_goals log D(o, L) - E_kept log(1 - D(o, L))

Goals are what demonstrations see last. Of the observations that agents make, those with the highest
D may well be goals, too; only the share rho with the lowest D is kept. Agents know no dynamics:
they act.

Source: Bahdanau et al., "Learning to Understand Goal Specifications by Modelling Reward" (ICLR
2019); Fu et al. (2019), section "Experimental Procedure", for DQN and rho = 0.25.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch.nn import functional

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.dqn.agents import DqnAgents
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.learning import act_and_learn
from lcrl_bench.mdp.dqn.stack import TaskStack, pad_states
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.methods.logit_rewards import LogitReward, reward_of_logit
from lcrl_bench.methods.network_method import HouseObjective, NetworkMethod
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, Opponent, Row, TrainingConfig
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class AgileConfig(TrainingConfig):
    """Settings of AGILE: the discriminator's, as of any network, and the agents'."""

    learning_rate: float = 2e-3
    """Adam's initial learning rate. (Paper: 5e-4.)"""
    size: int = 32
    """Length of every embedding, as in the paper."""
    hidden: int = 32
    """Units of the fully connected layer before the output, as in the paper."""
    keep_fraction: float = 0.25
    """rho: fraction of the agents' observations, those with the lowest D, kept as negatives."""
    negatives: int = 40
    """Observations per task in a step of the discriminator, before the filter."""
    policy_reward: LogitReward = "binary"
    """The agents' reward for an observation; `binary` is AGILE's."""
    test_reward: LogitReward = "softplus"
    """The learned reward, which is optimised again in other houses."""
    acting: int = 60
    """Steps per episode between passes of the discriminator."""
    episodes: int = 10
    """Parallel episodes per task."""
    agent_hidden: int = 32
    """Units of each of the two hidden layers of an agent."""
    agent_learning_rate: float = 3e-3
    """Adam's learning rate for the agents."""
    agent_batch: int = 32
    """Transitions per gradient step of an agent."""
    replay: int = 10_000
    """Transitions that an agent remembers; negatives are drawn from them, too."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        if not 0 < self.keep_fraction <= 1:
            raise UsageError(f"keep_fraction lies in (0, 1], found {self.keep_fraction}.")
        if min(self.negatives, self.acting) < 1:
            raise UsageError("negatives and acting start at 1.")

    def agents(self, passes: int) -> DqnConfig:
        """The settings of the agents, for that many passes."""
        return DqnConfig(
            steps=passes * self.acting * self.episodes,
            episodes=self.episodes,
            hidden=self.agent_hidden,
            learning_rate=self.agent_learning_rate,
            batch=self.agent_batch,
            replay=self.replay,
            shaping="none",
        )


class Agile(NetworkMethod[AgileConfig, RewardNetwork]):
    """Agents act in all tasks at once; the discriminator learns one house at a time."""

    learns = NetworkReward
    Config: ClassVar[type[AgileConfig]] = AgileConfig
    presets: ClassVar = {
        "paper": {
            **PAPER_TRAINING,
            "mirror": False,
            "keep_fraction": 0.25,
            "policy_reward": "binary",
        }
    }

    def lessons(
        self, network: RewardNetwork, houses: Sequence[PreparedHouse], generator: torch.Generator
    ) -> tuple[HouseObjective, Opponent]:
        """The discriminator's objective, and the agents that it learns from."""
        game = _Game.begin(network, houses, self.config, generator=generator)
        networks = list(game.agents.networks.parameters())
        group = {"params": networks, "lr": self.config.agent_learning_rate, "weight_decay": 0.0}
        opponent = Opponent(module=game.agents, group=group, before_pass=game.act)
        return game.discriminate, opponent

    def wrap(self, network: RewardNetwork, vocabulary: Vocabulary) -> NetworkReward:
        """The reward for other houses, which is not the one that agents are paid."""
        return NetworkReward(network, vocabulary, transform=self.config.test_reward)


@dataclass(eq=False)
class _Game:
    """The two sides, and what each needs to know of the other."""

    config: AgileConfig
    network: RewardNetwork
    """D, as a logit."""
    agents: DqnAgents
    houses: Sequence[PreparedHouse]
    rows: Sequence[slice]
    """Which agents are in each house."""
    visited: torch.Tensor
    """int64 [task, n]: states that each agent came to, drawn before each pass."""
    policy_loss: float = 0.0
    """The agents' mean temporal-difference loss before this pass."""

    @classmethod
    def begin(
        cls,
        network: RewardNetwork,
        houses: Sequence[PreparedHouse],
        config: AgileConfig,
        *,
        generator: torch.Generator,
    ) -> _Game:
        """Make an agent for every task of every house."""
        stack = TaskStack.of([tasks for house in houses for tasks in house.tasks])
        seeds = torch.randint(1 << 62, (stack.tasks,), generator=generator)
        settings = config.agents(config.passes_over(len(houses)))
        agents = DqnAgents(stack, settings, seeds=seeds)
        rows, first = [], 0
        for house in houses:
            rows.append(slice(first, first + house.count))
            first += house.count
        return cls(config, network, agents, houses, rows, visited=agents.states)

    def act(self, optimizer: torch.optim.Optimizer) -> None:
        """Let the agents act and learn, paid by the discriminator as it is now."""
        self.policy_loss = act_and_learn(
            self.agents, self.pay(), None, optimizer, rounds=self.config.acting
        )
        self.visited = self.agents.visited(self.config.negatives)

    @torch.no_grad()
    def pay(self) -> torch.Tensor:
        """The agents' reward in every cell: float [task, cell], padded."""
        parts = []
        for house in self.houses:
            features = self.network.encode(house.index)
            commands = self.network.embed_commands(house.tokens, house.lengths)
            for tasks, said in house.with_commands(commands):
                logit = self.network.score(features, tasks.panoramas, said)
                paid = reward_of_logit(self.config.policy_reward, logit)
                parts.append(pad_states(paid, self.agents.stack.states // HEADINGS))
        return torch.cat(parts)

    def discriminate(
        self, number: int, features: torch.Tensor, commands: torch.Tensor
    ) -> tuple[torch.Tensor, Row]:
        """The discriminator's loss on all tasks of a house, in nats; a `HouseObjective`.

        It logs `accepted`, the fraction of the agents' observations with D > 1/2 before the filter,
        and `recognised`, that of the goals.
        """
        here = self.visited[self.rows[number]] // HEADINGS
        house = self.houses[number]
        goals, others = [], []
        visits = [part for _, part in house.with_commands(here)]
        for (tasks, said), part in zip(house.with_commands(commands), visits, strict=True):
            cells = torch.cat([tasks.last_cells, part], 1)
            seen = tasks.panoramas.gather(1, cells)
            logit = self.network.score(features, seen, said)
            goals.append(logit[:, : tasks.last_cells.shape[1]].reshape(-1))
            others.append(logit[:, tasks.last_cells.shape[1] :].reshape(-1))
        positive, negative = torch.cat(goals), torch.cat(others)
        kept = keep_lowest(negative, self.config.keep_fraction)
        # -log D = softplus(-l) and -log(1 - D) = softplus(l); each side weighs one half, so that
        # D = 1/2 is where both are equally likely.
        loss = functional.softplus(-positive).mean() + functional.softplus(kept).mean()
        return loss, {
            "loss": float(loss.detach()),
            "accepted": float((negative > 0).float().mean()),
            "recognised": float((positive > 0).float().mean()),
            "policy_loss": self.policy_loss,
        }


def keep_lowest(logits: torch.Tensor, fraction: float) -> torch.Tensor:
    """The lowest fraction of the logits, over all tasks of a batch: float [n] -> float [kept].

    At least one is kept. Ties are broken arbitrarily.
    """
    return logits.topk(max(1, math.floor(fraction * len(logits))), largest=False).values
