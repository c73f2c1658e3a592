"""An LSTM over whole sequences as one autograd operation.

`nn.LSTMCell` in a loop is hundreds of small calls in a training step. Here the inputs of all steps
are multiplied at once, and so are the gradients of all weights; only what depends on the step
before is left in the loop.

Letters, as in `torch.nn.LSTMCell`: i, f, o gates, g candidate, c memory, h hidden state:

    i, f, g, o = sigmoid, sigmoid, tanh, sigmoid of (W_x x + W_h h + b)
    c' = f * c + i * g,   h' = o * tanh(c')

Source: Hochreiter & Schmidhuber, "Long Short-Term Memory" (1997), with forget gates.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import nn
from torch.autograd.function import once_differentiable


def last_hidden(cell: nn.LSTMCell, inputs: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
    """The hidden state after the last step of each sequence.

    Args:
        cell: The weights.
        inputs: float [sequence, step, input]; what comes after a sequence's end has no effect.
        lengths: int64 [sequence].

    Returns:
        float [sequence, size]; zeros for an empty sequence.
    """
    bias = cell.bias_ih + cell.bias_hh
    return _LastHidden.apply(inputs, lengths, cell.weight_ih, cell.weight_hh, bias)  # type: ignore[return-value]


class _LastHidden(torch.autograd.Function):
    """Runs every sequence to the end of the longest, and picks the state at its own end."""

    @staticmethod
    def forward(
        ctx: Any,  # noqa: ANN401
        inputs: torch.Tensor,
        lengths: torch.Tensor,
        weight_x: torch.Tensor,
        weight_h: torch.Tensor,
        bias: torch.Tensor,
    ) -> torch.Tensor:
        sequences, steps, width = inputs.shape
        size = weight_h.shape[1]
        x = inputs.transpose(0, 1).reshape(sequences * steps, width)
        gates = torch.addmm(bias, x, weight_x.t()).view(steps, sequences, 4 * size)
        hidden = gates.new_zeros(steps + 1, sequences, size)
        memory = gates.new_zeros(steps + 1, sequences, size)
        squashed = gates.new_empty(steps, sequences, size)
        for t in range(steps):
            gates[t].addmm_(hidden[t], weight_h.t())
            i, f, g, o = gates[t].split(size, dim=1)
            gates[t, :, : 2 * size].sigmoid_()
            g.tanh_()
            o.sigmoid_()
            torch.addcmul(f * memory[t], i, g, out=memory[t + 1])
            torch.tanh(memory[t + 1], out=squashed[t])
            torch.mul(o, squashed[t], out=hidden[t + 1])
        ctx.save_for_backward(x, lengths, weight_x, weight_h, gates, hidden, memory, squashed)
        return hidden[lengths, torch.arange(sequences, device=lengths.device)]

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: torch.Tensor) -> tuple[torch.Tensor | None, ...]:  # noqa: ANN401
        x, lengths, weight_x, weight_h, gates, hidden, memory, squashed = ctx.saved_tensors
        steps, sequences, size = squashed.shape
        # What each step's h' receives from outside: only that of a sequence's last step counts.
        last = torch.arange(1, steps + 1, device=lengths.device)[:, None] == lengths
        received = last[:, :, None] * gradients[0]
        i, f, g, o = gates.split(size, dim=2)
        # Derivatives of all steps at once: of what is squashed, and of c' in h'.
        slopes = gates * (1.0 - gates)
        slopes[:, :, 2 * size : 3 * size] = 1.0 - g * g
        through = o * (1.0 - squashed * squashed)
        factors = torch.cat([g, memory[:-1], i], 2) * slopes[:, :, : 3 * size]
        output_factors = squashed * slopes[:, :, 3 * size :]
        flows = torch.empty_like(gates)
        to_hidden, to_memory = torch.zeros_like(received[0]), torch.zeros_like(received[0])
        for t in reversed(range(steps)):
            to_hidden = to_hidden + received[t]
            to_memory = torch.addcmul(to_memory, to_hidden, through[t])
            parts = flows[t].view(sequences, 4, size)
            torch.mul(to_memory[:, None], factors[t].view(sequences, 3, size), out=parts[:, :3])
            torch.mul(to_hidden, output_factors[t], out=parts[:, 3])
            to_memory = to_memory * f[t]
            to_hidden = flows[t] @ weight_h
        flat = flows.view(steps * sequences, 4 * size)
        for_inputs = (flat @ weight_x).view(steps, sequences, x.shape[1]).transpose(0, 1)
        for_hidden = flat.t() @ hidden[:-1].reshape(steps * sequences, size)
        return for_inputs, None, flat.t() @ x, for_hidden, flat.sum(0)
