"""The LSTM in one operation against `torch.nn.LSTMCell`, step by step."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import nn

from lcrl_bench.networks.command_encoder import CommandEncoder
from lcrl_bench.networks.initialisation import lstm_cell
from lcrl_bench.networks.lstm import last_hidden

laws = settings(derandomize=True, deadline=None, max_examples=25)


def step_by_step(cell: nn.LSTMCell, inputs: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
    rows = []
    for sequence, length in zip(inputs, lengths.tolist(), strict=True):
        state = (inputs.new_zeros(1, cell.hidden_size), inputs.new_zeros(1, cell.hidden_size))
        for vector in sequence[:length]:
            state = cell(vector[None], state)
        rows.append(state[0])
    return torch.cat(rows)


@laws
@given(st.lists(st.integers(0, 6), min_size=1, max_size=5), st.integers(0, 10_000))
def test_it_gives_what_the_cell_gives_step_by_step(lengths, seed):
    generator = torch.Generator().manual_seed(seed)
    cell = lstm_cell(3, 5, generator=generator).double()
    steps = max(lengths)
    inputs = torch.randn(len(lengths), steps, 3, generator=generator).double().requires_grad_()
    counts, tensors = torch.tensor(lengths), [inputs, *cell.parameters()]
    found, expected = last_hidden(cell, inputs, counts), step_by_step(cell, inputs, counts)
    torch.testing.assert_close(found, expected)
    weights = torch.randn(found.shape, generator=generator).double()
    if steps:
        one = torch.autograd.grad((weights * found).sum(), tensors)
        other = torch.autograd.grad((weights * expected).sum(), tensors)
        torch.testing.assert_close(one, other)


def test_commands_are_embedded_alike_with_and_without_gradients():
    encoder = CommandEncoder(9, generator=torch.Generator().manual_seed(0))
    tokens = torch.tensor([[1, 2, 3, 4], [5, 6, 0, 0], [0, 0, 0, 0]])
    lengths = torch.tensor([4, 2, 0])
    trained = encoder(tokens, lengths)
    with torch.no_grad():
        torch.testing.assert_close(encoder(tokens, lengths), trained)
    assert float(trained[2].detach().abs().max()) == 0.0


def test_what_follows_the_end_of_a_sequence_has_no_effect():
    cell = lstm_cell(2, 4, generator=torch.Generator().manual_seed(1))
    inputs = torch.ones(1, 3, 2)
    longer = torch.cat([inputs, torch.full((1, 2, 2), torch.nan)], 1)
    lengths = torch.tensor([3])
    assert torch.equal(last_hidden(cell, inputs, lengths), last_hidden(cell, longer, lengths))
    with pytest.raises(IndexError):
        last_hidden(cell, inputs, torch.tensor([4]))
