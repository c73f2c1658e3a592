"""`TextSpace`: text that works with the shared memory of asynchronous environments.

Gymnasium reads shared memory once, when an `AsyncVectorEnv` is made, and keeps the arrays, whose
content changes with every step. For a `Text` space it keeps strings, which never change: they keep
the empty memory's content. Here, the letters are read on each access.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, overload

import numpy as np
from gymnasium import spaces
from gymnasium.vector.utils import read_from_shared_memory
from numpy.typing import NDArray


class TextSpace(spaces.Text):
    """Strings over the letters of some texts, no longer than the longest of them."""

    def __init__(self, texts: Iterable[str]) -> None:
        """Take the texts, at least one, none of them empty."""
        texts = tuple(texts)
        # A sorted string, not a set, so that letters have the same numbers in every process.
        super().__init__(max(map(len, texts)), charset="".join(sorted(set("".join(texts)))))


class SharedTexts(Sequence[str]):
    """The texts of all environments, read from shared memory on access.

    Copies are tuples of strings, as from any other vector environment.
    """

    def __init__(self, letters: tuple[str, ...], numbers: NDArray[np.int32]) -> None:
        """Wrap shared memory.

        Args:
            letters: The letters the numbers stand for; larger numbers are padding.
            numbers: int32 [environment, place].
        """
        self._letters, self._numbers = letters, numbers

    def __len__(self) -> int:
        """Number of environments."""
        return len(self._numbers)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[str, ...]: ...
    def __getitem__(self, index: int | slice) -> str | tuple[str, ...]:
        """The current text of one environment, or of several."""
        if isinstance(index, slice):
            return tuple(map(self._text, self._numbers[index]))
        return self._text(self._numbers[index])

    def __repr__(self) -> str:
        """As a tuple of strings."""
        return repr(tuple(self))

    def __copy__(self) -> tuple[str, ...]:
        """The current texts."""
        return tuple(self)

    def __deepcopy__(self, memo: dict[int, Any]) -> tuple[str, ...]:
        """The current texts."""
        return tuple(self)

    def _text(self, numbers: NDArray[np.int32]) -> str:
        return "".join(self._letters[number] for number in numbers if number < len(self._letters))


@read_from_shared_memory.register(TextSpace)
def _read(space: TextSpace, shared_memory: Any, n: int = 1) -> Any:  # noqa: ANN401 - `SharedTexts`
    numbers = np.frombuffer(shared_memory.get_obj(), np.int32).reshape(n, space.max_length)
    return SharedTexts(space.character_list, numbers)
