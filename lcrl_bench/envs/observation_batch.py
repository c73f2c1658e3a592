"""Observations of many sub-environments at once, gathered from shared tables.

They equal what Gymnasium's `SyncVectorEnv` makes of the observations of single environments.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.envs.table_pool import TablePool
from lcrl_bench.mdp.task_batch import HEADINGS, OBJECT_STATES
from lcrl_bench.panoramas import CLASSES

Positions = NDArray[np.int64]
"""int64 [sub-environment]."""
# As an array: NumPy takes as long to convert a Python number as to compute with it.
_HEADINGS = np.array(HEADINGS)
_CLASSES = np.arange(CLASSES, dtype=np.uint8)[:, None, None]


def one_hot_panoramas(panoramas: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Make panoramas one-hot: from uint8 [..., 4, height, width] to [..., 4, 61, height, width]."""
    return (panoramas[..., None, :, :] == _CLASSES).view(np.uint8)


class ObservationBatch(ABC):
    """Turns the positions of sub-environments into a batch of observations."""

    @abstractmethod
    def begin(self, number: int, task: Task) -> None:
        """Start an episode.

        Args:
            number: Index of the sub-environment.
            task: The task it plays.
        """

    @abstractmethod
    def observe(self, pool: TablePool, positions: Positions, cells: Positions) -> Any:  # noqa: ANN401
        """The observations of all sub-environments, as the batched space holds them.

        Args:
            pool: The tables.
            positions: Their states, as positions in the tables.
            cells: The rows of their cells, `positions // 4`.
        """

    @abstractmethod
    def single(self, pool: TablePool, number: int, position: int) -> Any:  # noqa: ANN401
        """The observation of one sub-environment, newly allocated, as the single space holds it.

        Args:
            pool: The tables.
            number: Index of the sub-environment.
            position: Its state, as a position in the tables.
        """


class PanoramaBatch(ObservationBatch):
    """A dictionary of arrays; the commands as a tuple of strings."""

    def __init__(
        self,
        environments: int,
        *,
        copy: bool,
        one_hot: bool,
        words: Mapping[str, NDArray[np.int64]],
        text: bool,
        position: bool,
    ) -> None:
        """Start with no episodes.

        Args:
            environments: Number of sub-environments.
            copy: Whether each observation is newly allocated.
            one_hot: Whether panoramas are one-hot.
            words: The numbers of each command's words.
            text: Whether to include the command as text.
            position: Whether to include the agent's tile.
        """
        self._one_hot, self._text, self._position = one_hot, text, position
        self._known = words
        longest = len(next(iter(words.values())))
        self._words = np.zeros((environments, longest), np.int64)
        self._texts = [""] * environments
        self._text_tuple: tuple[str, ...] | None = None
        self._kept: dict[str, Any] | None = None
        self._copy = copy

    def begin(self, number: int, task: Task) -> None:
        """Remember the command."""
        self._words[number] = self._known[task.command]
        self._texts[number] = task.command
        self._text_tuple = None

    def observe(self, pool: TablePool, positions: Positions, cells: Positions) -> dict[str, Any]:
        """The dictionary."""
        sides = pool.cell_views.rows.take(cells, 0)
        seen: dict[str, Any] = {
            "panorama": self._panoramas(pool.views.rows, sides),
            "heading": positions % _HEADINGS,
            "held": pool.held.rows.take(cells),
            "command": self._words.copy(),
        }
        if self._text:
            if self._text_tuple is None:
                self._text_tuple = tuple(self._texts)
            seen["text"] = self._text_tuple
        if self._position:
            seen["tile"] = pool.tile.rows.take(cells)
        return seen if self._copy else self._overwrite(seen)

    def single(self, pool: TablePool, number: int, position: int) -> dict[str, Any]:
        """The dictionary of one sub-environment."""
        cell = position // HEADINGS
        panorama = pool.views.rows.take(pool.cell_views.rows[cell], 0)
        seen: dict[str, Any] = {
            "panorama": one_hot_panoramas(panorama) if self._one_hot else panorama,
            "heading": np.int64(position % HEADINGS),
            "held": pool.held.rows[cell],
            "command": self._words[number].copy(),
        }
        if self._text:
            seen["text"] = self._texts[number]
        if self._position:
            seen["tile"] = pool.tile.rows[cell]
        return seen

    def _panoramas(self, views: NDArray[np.uint8], sides: NDArray[np.int32]) -> NDArray[np.uint8]:
        if self._one_hot:
            return one_hot_panoramas(views.take(sides, 0))
        if self._copy or self._kept is None:
            return views.take(sides, 0)
        # In place; with "raise", the default mode, NumPy would write into a copy first.
        return views.take(sides, 0, self._kept["panorama"], "clip")

    def _overwrite(self, seen: dict[str, Any]) -> dict[str, Any]:
        """The same arrays on every call, with new content."""
        if self._kept is None:
            self._kept = seen
        for key, value in seen.items():
            kept = self._kept[key]
            if isinstance(kept, np.ndarray) and kept is not value:
                kept[...] = value
        return seen | {k: v for k, v in self._kept.items() if isinstance(v, np.ndarray)}


class TabularBatch(ObservationBatch):
    """float32 [sub-environment, tiles + 4 + 3]."""

    def __init__(self, environments: int, *, copy: bool, tiles: int) -> None:
        """Size the vectors.

        Args:
            environments: Number of sub-environments.
            copy: Whether each observation is newly allocated.
            tiles: Number of tiles of the largest house.
        """
        self._tiles = tiles
        self._rows = np.arange(environments)
        self._kept = None if copy else self._zeros(environments)

    def begin(self, number: int, task: Task) -> None:
        """Do nothing: the vector does not contain the command."""

    def observe(
        self, pool: TablePool, positions: Positions, cells: Positions
    ) -> NDArray[np.float32]:
        """The vectors."""
        vectors = self._zeros(len(positions)) if self._kept is None else self._kept
        if self._kept is not None:
            vectors[...] = 0.0
        self._mark(pool, vectors, self._rows, positions, cells)
        return vectors

    def single(self, pool: TablePool, number: int, position: int) -> NDArray[np.float32]:
        """The vector of one sub-environment."""
        del number
        vectors = self._zeros(1)
        positions = np.array([position])
        self._mark(pool, vectors, self._rows[:1], positions, positions // _HEADINGS)
        return vectors[0]

    def _zeros(self, environments: int) -> NDArray[np.float32]:
        return np.zeros((environments, self._tiles + HEADINGS + OBJECT_STATES), np.float32)

    def _mark(
        self,
        pool: TablePool,
        vectors: NDArray[np.float32],
        rows: Positions,
        positions: Positions,
        cells: Positions,
    ) -> None:
        vectors[rows, pool.tile.rows.take(cells)] = 1.0
        vectors[rows, self._tiles + positions % _HEADINGS] = 1.0
        vectors[rows, self._tiles + HEADINGS + pool.object_state.rows.take(cells)] = 1.0


class StateBatch(ObservationBatch):
    """int64 [sub-environment]: the states' indices."""

    def __init__(self, environments: int, *, copy: bool) -> None:
        """Allocate what is overwritten if not copied."""
        self._kept = None if copy else np.zeros(environments, np.int64)

    def begin(self, number: int, task: Task) -> None:
        """Do nothing: the index does not contain the command."""

    def observe(self, pool: TablePool, positions: Positions, cells: Positions) -> Positions:
        """The indices."""
        states = positions - pool.first_state.rows.take(cells)
        if self._kept is None:
            return states
        self._kept[...] = states
        return self._kept

    def single(self, pool: TablePool, number: int, position: int) -> np.int64:
        """The index of one sub-environment."""
        del number
        return np.int64(position - pool.first_state.rows[position // HEADINGS])
