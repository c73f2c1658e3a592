"""Vocabulary of lower-case words, with one number for all unknown words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import torch

UNKNOWN = 0
"""Number of words that are not in the vocabulary, and of padding after a command."""
_WORD = re.compile(r"[a-z0-9]+")


@dataclass(frozen=True)
class Vocabulary:
    """Known words in a fixed order, numbered from 1."""

    words: tuple[str, ...]

    @classmethod
    def of(cls, words: Iterable[str]) -> Vocabulary:
        """A vocabulary of the distinct words, in the given order."""
        return cls(tuple(dict.fromkeys(words)))

    def __len__(self) -> int:
        """Number of words, the unknown word included."""
        return len(self.words) + 1

    def encode(self, commands: Sequence[str]) -> tuple[torch.Tensor, torch.Tensor]:
        """Number the words of commands.

        Args:
            commands: Sentences; case and punctuation don't matter.

        Returns:
            int64 [command, word], padded with `UNKNOWN`, and int64 [command], word counts.
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
