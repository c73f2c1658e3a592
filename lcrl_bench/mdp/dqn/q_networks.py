"""One small Q-network per task, all evaluated in one batch: Q(s, .) from one-hot inputs."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.mdp.dqn.draws import Draws
from lcrl_bench.mdp.dqn.stack import INPUTS
from lcrl_bench.mdp.task_batch import ACTIONS


class QNetworks(nn.Module):
    """Multi-layer perceptrons over one-hot inputs; weights are [task, in, out].

    The first layer sums the rows of its weights that belong to active inputs: a product with a
    one-hot vector, without the zeros.
    """

    def __init__(self, rows: int, *, hidden: int, layers: int, draws: Draws) -> None:
        """Draw initial weights.

        Args:
            rows: Rows of the first layer.
            hidden: Units of each hidden layer.
            layers: Number of hidden layers, the first included.
            draws: One stream per task; each layer takes a branch of its own.
        """
        super().__init__()
        sizes = [(hidden, hidden)] * (layers - 1) + [(hidden, ACTIONS)]
        self.first = _weights(rows, hidden, fan_in=INPUTS, draws=draws.branch(0))
        self.weights = nn.ParameterList(
            _weights(*size, fan_in=size[0], draws=draws.branch(1 + number))
            for number, size in enumerate(sizes)
        )
        tasks = len(draws.seeds)
        self.biases = nn.ParameterList(
            nn.Parameter(self.first.new_zeros(tasks, 1, size[1])) for size in sizes
        )

    @property
    def layers(self) -> list[nn.Parameter]:
        """All weights: the first layer's, the others', their biases."""
        return [self.first, *self.weights, *self.biases]

    def forward(self, inputs: torch.Tensor) -> torch.Tensor:
        """Q-values of the four actions.

        Args:
            inputs: int64 [task, n, 3], rows of each task's first layer.

        Returns:
            float [task, n, action].
        """
        tasks, rows, hidden = self.first.shape
        offsets = torch.arange(tasks, device=inputs.device)[:, None, None] * rows
        flat = (inputs + offsets).view(-1, INPUTS)
        units = functional.embedding_bag(flat, self.first.view(-1, hidden), mode="sum")
        units = units.view(tasks, -1, hidden)
        for weight, bias in zip(self.weights, self.biases, strict=True):
            units = torch.baddbmm(bias, functional.relu(units), weight)
        return units


def _weights(rows: int, columns: int, *, fan_in: int, draws: Draws) -> nn.Parameter:
    """Uniform in +-sqrt(3 / fan_in), of variance 1 / fan_in: float [task, row, column]."""
    values = draws.uniform(rows * columns).view(-1, rows, columns)
    return nn.Parameter((2.0 * values - 1.0) * (3.0 / fan_in) ** 0.5)
