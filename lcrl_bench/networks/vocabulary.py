"""Words to numbers: lower-case words, and one number for every word that training never has."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import torch

UNKNOWN = 0
"""The number of a word that is not in the vocabulary, and of the padding after a command."""
_WORD = re.compile(r"[a-z0-9]+")


@dataclass(frozen=True)
class Vocabulary:
    """Known words, in a fixed order: the k-th has the number k + 1."""

    words: tuple[str, ...]

    @classmethod
    def of(cls, words: Iterable[str]) -> Vocabulary:
        """A vocabulary of distinct words, in the order given."""
        return cls(tuple(dict.fromkeys(words)))

    def __len__(self) -> int:
        """How many numbers there are, the unknown word's included."""
        return len(self.words) + 1

    def encode(self, commands: Sequence[str]) -> tuple[torch.Tensor, torch.Tensor]:
        """Number the words of commands.

        Args:
            commands: Sentences; case and punctuation don't matter.

        Returns:
            int64 [command, word], filled up with `UNKNOWN`, and int64 [command]: word counts.
        """
        number = {word: k for k, word in enumerate(self.words, start=1)}
        rows = [[number.get(word, UNKNOWN) for word in tokenise(text)] for text in commands]
        lengths = torch.tensor([len(row) for row in rows], dtype=torch.int64)
        longest = max((len(row) for row in rows), default=0)
        padded = [row + [UNKNOWN] * (longest - len(row)) for row in rows]
        tokens = torch.tensor(padded, dtype=torch.int64).view(len(rows), longest)
        return tokens, lengths


def tokenise(command: str) -> list[str]:
    """The lower-case words of a command: `"Go to the TV-stand."` gives go, to, the, tv, stand."""
    return _WORD.findall(command.lower())
