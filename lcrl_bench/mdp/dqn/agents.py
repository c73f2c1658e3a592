"""`DqnAgents`: epsilon-greedy acting, replay and temporal-difference learning, a network per task.

Letters: s state, a action, s' = f(s, a) next state, r(s') reward on arrival, phi potential,
gamma discount, Q network, Q' target network.

    R = r(s') + gamma phi(s') - phi(s)
    y = R + gamma Q'(s', argmax_a Q(s', a))        (Double DQN; plain: max_a Q'(s', a))
    minimise huber(Q(s, a) - y)

With rewards paid on arrival, a return is sum_{t>=1} gamma^(t-1) r(s_t): the usual one without the
constant r(s_0), divided by gamma. Episodes are truncated at the horizon and restart; truncation is
not termination, so y bootstraps there. Nor do episodes end at the goal, which would leak where it
is.

Rewards are normalised to (R - mean) / spread, with running statistics of sampled transitions:
without termination, neither shift nor scale changes the optimal policy.

Source: Mnih et al., "Human-level control through deep reinforcement learning" (2015); van Hasselt
et al., "Deep Reinforcement Learning with Double Q-learning" (2016); Ng et al., "Policy invariance
under reward transformations" (1999).
"""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.draws import Draws
from lcrl_bench.mdp.dqn.q_networks import QNetworks
from lcrl_bench.mdp.dqn.replay import Replay
from lcrl_bench.mdp.dqn.shaping import shaped_reward
from lcrl_bench.mdp.dqn.stack import TaskStack
from lcrl_bench.mdp.task_batch import ACTIONS

MEMORY = 200
"""Window, in gradient steps, of the running mean and spread of rewards."""
_STATES_AT_ONCE = 64


class DqnAgents(nn.Module):
    """One agent per task: networks, replay memory and the state of its episodes."""

    states: torch.Tensor
    """int64 [task, episode]: the current state of each episode."""
    rounds: torch.Tensor
    """int64 []: steps taken by every episode."""
    learned: torch.Tensor
    """int64 []: gradient steps taken."""
    mean: torch.Tensor
    """float [task, 1]: running mean of R."""
    square: torch.Tensor
    """float [task, 1]: running mean of R squared."""

    def __init__(self, stack: TaskStack, config: DqnConfig, *, seeds: torch.Tensor) -> None:
        """Draw initial networks, and put every episode at its start.

        Args:
            stack: The tasks.
            config: Settings; `steps` only sets how fast exploration decays.
            seeds: int64 [task]: seed of all of a task's random numbers.
        """
        super().__init__()
        device = stack.next_state.device
        self.stack, self.config = stack, config
        self.draws = Draws(seeds.to(device))
        sizes = {"hidden": config.hidden, "layers": config.layers}
        self.networks = QNetworks(stack.rows, **sizes, draws=self.draws)
        self.targets = QNetworks(stack.rows, **sizes, draws=self.draws).requires_grad_(False)
        self.replay = Replay(stack.tasks, config.replay, device=device)
        starts = stack.start[:, None].repeat(1, config.episodes)
        self.register_buffer("states", starts)
        self.register_buffer("rounds", torch.zeros((), dtype=torch.int64))
        self.register_buffer("learned", torch.zeros((), dtype=torch.int64))
        self.register_buffer("mean", torch.zeros(stack.tasks, 1, device=device))
        self.register_buffer("square", torch.zeros(stack.tasks, 1, device=device))

    @torch.no_grad()
    def act(self) -> torch.Tensor:
        """Take one step in every episode, and store it in the replay memory.

        Returns:
            int64 [task, episode]: the new states.
        """
        stack, episodes = self.stack, self.config.episodes
        epsilon = self.config.exploration(int(self.rounds))
        choice, explore = self.draws.uniform(2 * episodes).split(episodes, 1)
        random = (choice * ACTIONS).long()
        greedy = self.networks(self._inputs(self.states)).argmax(-1)
        actions = torch.where(explore < epsilon, random, greedy)
        arrived = stack.step(self.states, actions)
        self.replay.add(self.states, actions, arrived)
        self.rounds += 1
        over = int(self.rounds) % stack.horizon == 0
        self.states = stack.start[:, None].repeat(1, episodes) if over else arrived
        return arrived

    def loss(self, rewards: torch.Tensor, potentials: torch.Tensor | None) -> torch.Tensor:
        """The temporal-difference loss of a batch of transitions, with gradients.

        Args:
            rewards: float [task, cell] of the stack.
            potentials: float [task, state] of the stack: phi; None for no shaping.

        Returns:
            float [task].
        """
        states, actions, successors = self.replay.sample(self.config.batch, self.draws)
        with torch.no_grad():
            r = shaped_reward(rewards, potentials, states, successors, discount=self.stack.discount)
            after = self._inputs(successors)
            values = self.targets(after)
            chooser = self.networks(after) if self.config.double else values
            best = values.gather(-1, chooser.argmax(-1, keepdim=True)).squeeze(-1)
            aim = self._normalise(r) + self.stack.discount * best
        q = self.networks(self._inputs(states)).gather(-1, actions[..., None]).squeeze(-1)
        return functional.smooth_l1_loss(q, aim, reduction="none").mean(1)

    def visited(self, count: int) -> torch.Tensor:
        """Sample visited states from each agent's replay memory: int64 [task, count]."""
        return self.replay.sample(count, self.draws)[2]

    def copy_targets(self) -> None:
        """Count a gradient step; update the target networks every `target_interval` steps."""
        self.learned += 1
        if int(self.learned) % self.config.target_interval == 0:
            self.targets.load_state_dict(self.networks.state_dict())

    @torch.no_grad()
    def greedy(self) -> torch.Tensor:
        """The greedy, stationary policy: float [task, state, action], one-hot."""
        policy = torch.zeros(
            self.stack.tasks, self.stack.states, ACTIONS, device=self.states.device
        )
        for part in range(0, self.stack.states, _STATES_AT_ONCE):
            rows = slice(part, part + _STATES_AT_ONCE)
            best = self.networks(self.stack.inputs[:, rows]).argmax(-1, keepdim=True)
            policy[:, rows].scatter_(-1, best, 1.0)
        return policy

    def _inputs(self, states: torch.Tensor) -> torch.Tensor:
        """Active inputs of states: int64 [task, n] -> int64 [task, n, 3]."""
        task = torch.arange(self.stack.tasks, device=states.device)[:, None]
        return self.stack.inputs[task, states]

    def _normalise(self, r: torch.Tensor) -> torch.Tensor:
        """Normalise R by its running mean and spread: float [task, n]."""
        weight = 1.0 / min(int(self.learned) + 1, MEMORY)
        self.mean.lerp_(r.mean(1, keepdim=True), weight)
        self.square.lerp_(r.square().mean(1, keepdim=True), weight)
        spread = (self.square - self.mean.square()).clamp(min=0).sqrt()
        # Where all rewards are equal, their spread is rounding error and must not be amplified.
        floor = 1e-3 * self.square.sqrt() + 1e-8
        return (r - self.mean) / torch.maximum(spread, floor)
