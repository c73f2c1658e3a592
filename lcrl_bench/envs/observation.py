"""Observations of states, and their Gymnasium spaces.

Sizes are those of the whole benchmark, not of the tasks played, so that an agent trained on one
split can be tested on another.

An observer prepares what stays the same throughout an episode, so that a step only looks up the
rest: `Observer.episode` for one environment, `Observer.batch` for a vector of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.envs.arguments import check_flag, check_name
from lcrl_bench.envs.observation_batch import (
    ObservationBatch,
    PanoramaBatch,
    StateBatch,
    TabularBatch,
    one_hot_panoramas,
)
from lcrl_bench.envs.text_space import TextSpace
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import HEADINGS, OBJECT_STATES, ObjectState
from lcrl_bench.networks.vocabulary import Vocabulary

OBSERVATIONS: Final = ("panorama", "tabular", "state")
"""The kinds of observation."""


@dataclass(frozen=True, eq=False)
class Layout:
    """What the states of a set of tasks are, by state: looked up faster than computed."""

    heading: Sequence[np.int64]
    """0..3 for north, east, south, west."""
    held: Sequence[np.int64]
    """1 while the object is held."""
    tile: Sequence[np.int64]
    """Where the agent is."""
    sides: Sequence[NDArray[np.int64]]
    """By panorama, not by state: the views to the north, east, south and west."""

    @classmethod
    def of(cls, tasks: TaskSet) -> Layout:
        """The layout of a set of tasks."""
        cells, headings = np.divmod(np.arange(tasks.states), HEADINGS)
        object_states, tiles = np.divmod(cells, tasks.tiles)
        numbers = tuple(map(np.int64, range(max(tasks.tiles, HEADINGS))))
        return cls(
            heading=tuple(numbers[each] for each in headings.tolist()),
            held=tuple(numbers[each == ObjectState.HELD] for each in object_states.tolist()),
            tile=tuple(numbers[each] for each in tiles.tolist()),
            sides=tuple(tasks.views.panorama_views.numpy()),
        )


class Observer(ABC):
    """Turns states into observations."""

    space: spaces.Space[Any]
    """Space of the observations."""

    @abstractmethod
    def episode(self, tasks: TaskSet, row: int, layout: Layout) -> Callable[[int], Any]:
        """A function from a state of a task to its observation, newly allocated on each call.

        Args:
            tasks: A set of tasks.
            row: Index of the task.
            layout: Of the set.
        """

    @abstractmethod
    def batch(self, environments: int, *, copy: bool) -> ObservationBatch:
        """Observations of many sub-environments at once.

        Args:
            environments: Their number.
            copy: Whether each observation is newly allocated, or overwrites the last.
        """


class PanoramaObserver(Observer):
    """Dict observation, as for the paper's agent.

    - `panorama`: uint8 [4, 24, 32] class ids 0..60, the views north, east, south and west; if
      one-hot, uint8 [4, 61, 24, 32].
    - `heading`: 0..3 for north, east, south, west.
    - `held`: 1 while the agent holds the task's object.
    - `command`: int64 [word]: indices of the command's words in the benchmark's vocabulary, padded
      with 0, which also stands for words that don't occur in training.
    - `text`: the command itself.
    - `tile`: the agent's position, which its views alone don't determine.
    """

    space: spaces.Dict

    def __init__(self, benchmark: Benchmark, *, one_hot: bool, text: bool, position: bool) -> None:
        """Choose the contents of the dictionary.

        Args:
            benchmark: Determines the sizes.
            one_hot: Whether the panorama is one-hot.
            text: Whether to include `text`.
            position: Whether to include `tile`.
        """
        self._one_hot, self._text, self._position = one_hot, text, position
        classes = len(semantic_classes())
        view = (benchmark.semantics.view_height, benchmark.semantics.view_width)
        vocabulary = Vocabulary.of(benchmark.vocabulary)
        commands = sorted({task.command for task in benchmark.tasks})
        words = vocabulary.encode(commands)[0].numpy()
        self._words = dict(zip(commands, words, strict=True))
        parts: dict[str, spaces.Space[Any]] = {
            "panorama": spaces.Box(0, 1, (HEADINGS, classes, *view), np.uint8)
            if one_hot
            else spaces.Box(0, classes - 1, (HEADINGS, *view), np.uint8),
            "heading": spaces.Discrete(HEADINGS),
            "held": spaces.Discrete(2),
            "command": spaces.MultiDiscrete([len(vocabulary)] * words.shape[1]),
        }
        if text:
            parts["text"] = TextSpace(commands)
        if position:
            parts["tile"] = spaces.Discrete(most_tiles(benchmark))
        self.space = spaces.Dict(parts)

    def episode(self, tasks: TaskSet, row: int, layout: Layout) -> Callable[[int], dict[str, Any]]:
        """A function from a state to its observation, with new arrays."""
        take_views = tasks.views.views.numpy().take
        panoramas = tasks.panoramas[row].tolist()
        rows = [layout.sides[panorama] for panorama in panoramas for _ in range(HEADINGS)]
        heading, held, tile = layout.heading, layout.held, layout.tile
        command = tasks.tasks[row].command
        copy_words, one_hot = self._words[command].copy, self._one_hot
        text, position = self._text, self._position

        def observe_plain(state: int) -> dict[str, Any]:
            return {
                "panorama": take_views(rows[state], 0),
                "heading": heading[state],
                "held": held[state],
                "command": copy_words(),
                "text": command,
            }

        if text and not position and not one_hot:
            return observe_plain

        def observe(state: int) -> dict[str, Any]:
            panorama = take_views(rows[state], 0)
            seen: dict[str, Any] = {
                "panorama": one_hot_panoramas(panorama) if one_hot else panorama,
                "heading": heading[state],
                "held": held[state],
                "command": copy_words(),
            }
            if text:
                seen["text"] = command
            if position:
                seen["tile"] = tile[state]
            return seen

        return observe

    def batch(self, environments: int, *, copy: bool) -> PanoramaBatch:
        """Observations of many sub-environments at once."""
        return PanoramaBatch(
            environments,
            copy=copy,
            one_hot=self._one_hot,
            words=self._words,
            text=self._text,
            position=self._position,
        )


class TabularObserver(Observer):
    """Position, orientation and object as a binary vector, for a DQN on one task.

    float32 [tiles + 4 + 3]: one-hot tile, heading and object state (at A, held, at B; always A for
    NAV).

    Source: paper, section "Experimental Procedure": DQN gets "the position, orientation, and
    whether an object is held [...] (this is identical to the state representation)". Two values
    would not distinguish A from B, hence three.
    """

    def __init__(self, benchmark: Benchmark) -> None:
        """Size the vector for the largest house of a benchmark."""
        self._tiles = most_tiles(benchmark)
        shape = (self._tiles + HEADINGS + OBJECT_STATES,)
        self.space = spaces.Box(0.0, 1.0, shape, np.float32)

    def episode(self, tasks: TaskSet, row: int, layout: Layout) -> Callable[[int], Any]:
        """A function from a state to its observation, a new array."""
        del row, layout
        tiles, most = tasks.tiles, self._tiles
        size = most + HEADINGS + OBJECT_STATES

        def observe(state: int) -> NDArray[np.float32]:
            object_state, tile = divmod(state // HEADINGS, tiles)
            vector = np.zeros(size, np.float32)
            vector[tile] = 1.0
            vector[most + state % HEADINGS] = 1.0
            vector[most + HEADINGS + object_state] = 1.0
            return vector

        return observe

    def batch(self, environments: int, *, copy: bool) -> TabularBatch:
        """Observations of many sub-environments at once."""
        return TabularBatch(environments, copy=copy, tiles=self._tiles)


class StateObserver(Observer):
    """The state's index, for tabular methods: `(object_state * tiles + tile) * 4 + heading`."""

    def __init__(self, benchmark: Benchmark) -> None:
        """Size the space for the largest house of a benchmark."""
        self.space = spaces.Discrete(most_tiles(benchmark) * OBJECT_STATES * HEADINGS)

    def episode(self, tasks: TaskSet, row: int, layout: Layout) -> Callable[[int], np.int64]:
        """A function from a state to its index; `tiles` is that of the task's house."""
        del tasks, row, layout
        return np.int64

    def batch(self, environments: int, *, copy: bool) -> StateBatch:
        """Observations of many sub-environments at once."""
        return StateBatch(environments, copy=copy)


def make_observer(
    observation: str, benchmark: Benchmark, *, one_hot: bool, text: bool, position: bool
) -> Observer:
    """The observer of that name; the flags are those of `PanoramaObserver`.

    Raises:
        UnknownNameError: If there is no such observation.
        UsageError: If a flag is neither True nor False.
    """
    check_name("observation", observation, OBSERVATIONS)
    for argument, flag in (("one_hot", one_hot), ("text", text), ("position", position)):
        check_flag(argument, flag)
    if observation == "tabular":
        return TabularObserver(benchmark)
    if observation == "state":
        return StateObserver(benchmark)
    return PanoramaObserver(benchmark, one_hot=one_hot, text=text, position=position)


def most_tiles(benchmark: Benchmark) -> int:
    """Number of tiles of the largest house of a benchmark."""
    return max(grid.tiles for grid in benchmark.grids.values())
