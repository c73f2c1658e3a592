"""Initial weights drawn from a given generator: no global random state is read or changed.

Layers are created on the meta device, which draws nothing, and get their weights afterwards. The
distributions are PyTorch's defaults: uniform within 1 / sqrt(fan in) for linear layers and
convolutions, within 1 / sqrt(size) for recurrent ones, standard normal for embeddings.
"""

from __future__ import annotations

import math

import torch
from torch import nn


def uniform(shape: tuple[int, ...], *, fan_in: int, generator: torch.Generator) -> nn.Parameter:
    """A parameter uniform within 1 / sqrt(fan_in).

    Args:
        shape: Shape of the parameter.
        fan_in: Number of inputs summed into one output; for a convolution of one-hot images
            classes * height * width, although only height * width of them are non-zero.
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
