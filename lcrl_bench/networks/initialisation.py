"""Initial weights drawn from a generator that is handed in: no global seed is read or set.

Layers are made on the meta device, which draws nothing, and given their weights afterwards. The
rules are PyTorch's own defaults: uniform within 1 / sqrt(fan in) for linear layers and
convolutions, within 1 / sqrt(size) for recurrent ones, standard normal for embeddings.
"""

from __future__ import annotations

import math

import torch
from torch import nn


def uniform(shape: tuple[int, ...], *, fan_in: int, generator: torch.Generator) -> nn.Parameter:
    """A parameter uniform within 1 / sqrt(fan_in).

    Args:
        shape: Its shape.
        fan_in: Number of inputs that are summed into one output; for a convolution of one-hot
            images that is classes * height * width, although only height * width of them are set.
        generator: A CPU generator.
    """
    bound = 1.0 / math.sqrt(fan_in)
    return nn.Parameter(torch.empty(shape).uniform_(-bound, bound, generator=generator))


def linear(inputs: int, outputs: int, *, generator: torch.Generator) -> nn.Linear:
    """A linear layer."""
    layer = nn.Linear(inputs, outputs, device="meta")
    layer.weight = uniform((outputs, inputs), fan_in=inputs, generator=generator)
    layer.bias = uniform((outputs,), fan_in=inputs, generator=generator)
    return layer


def lstm_cell(inputs: int, size: int, *, generator: torch.Generator) -> nn.LSTMCell:
    """An LSTM cell."""
    cell = nn.LSTMCell(inputs, size, device="meta")
    for name, parameter in list(cell.named_parameters()):
        drawn = uniform(tuple(parameter.shape), fan_in=size, generator=generator)
        setattr(cell, name, drawn)
    return cell


def embedding(rows: int, size: int, *, generator: torch.Generator) -> nn.Parameter:
    """A table of standard normal vectors."""
    return nn.Parameter(torch.empty(rows, size).normal_(generator=generator))
