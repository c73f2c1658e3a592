"""The paper's language encoder: word embeddings and an LSTM's state after the last word.

Source: Fu et al. (2019), section "Architecture": "the final time-step of the topmost layer is used
as a fixed-dimensional embedding".
"""

from __future__ import annotations

import torch
from torch import nn

from lcrl_bench.networks.gathering import gather_rows
from lcrl_bench.networks.initialisation import embedding, lstm_cell
from lcrl_bench.networks.lstm import last_hidden
from lcrl_bench.networks.vocabulary import UNKNOWN


class CommandEncoder(nn.Module):
    """Embeds commands."""

    def __init__(self, words: int, *, size: int = 32, generator: torch.Generator) -> None:
        """Draw initial weights.

        Args:
            words: Size of the vocabulary, unknown word included.
            size: Size of word vectors, of the LSTM and of the embedding.
            generator: A CPU generator, for the initial weights.
        """
        super().__init__()
        self.size = size
        self.words = embedding(words, size, generator=generator)
        self.cell = lstm_cell(size, size, generator=generator)
        with torch.no_grad():
            # It is never trained, so a random vector would only be noise at test time.
            self.words[UNKNOWN] = 0.0

    def forward(self, tokens: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
        """Embed commands.

        Args:
            tokens: int64 [command, word], as `Vocabulary.encode` gives.
            lengths: int64 [command].

        Returns:
            float [command, size].
        """
        vectors = gather_rows(self.words, tokens)
        if vectors.requires_grad:
            return last_hidden(self.cell, vectors, lengths)
        return self._last_hidden(vectors, lengths)

    def _last_hidden(self, vectors: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
        """The same step by step, whose bits the evaluation of trained models depends on."""
        hidden = vectors.new_zeros(len(vectors), self.size)
        memory = hidden
        for position in range(vectors.shape[1]):
            # Commands that have ended keep their last state.
            running = (position < lengths)[:, None]
            new_hidden, new_memory = self.cell(vectors[:, position], (hidden, memory))
            hidden = torch.where(running, new_hidden, hidden)
            memory = torch.where(running, new_memory, memory)
        return hidden
