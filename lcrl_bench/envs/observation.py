"""Observations of states, and their Gymnasium spaces.

Sizes are those of the whole benchmark, not of the tasks played, so that an agent trained on one
split can be tested on another.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.envs.arguments import check_flag, check_name
from lcrl_bench.envs.text_space import TextSpace
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import HEADINGS, OBJECT_STATES, ObjectState
from lcrl_bench.networks.vocabulary import Vocabulary

OBSERVATIONS: Final = ("panorama", "tabular", "state")
"""The kinds of observation."""


class Observer(ABC):
    """Turns a state of a task into an observation."""

    space: spaces.Space[Any]
    """Space of the observations."""

    @abstractmethod
    def observe(self, one: TaskSet, state: int) -> Any:  # noqa: ANN401 - what the space holds
        """The observation of a state, newly allocated."""


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
        self._classes = np.arange(classes, dtype=np.uint8)[:, None, None]
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

    def observe(self, one: TaskSet, state: int) -> dict[str, Any]:
        """The observation, with new arrays."""
        tile, heading, held = one.place(state)
        command = one.task.command
        panorama: NDArray[np.uint8] = one.panorama(state)
        if self._one_hot:
            panorama = (panorama[:, None] == self._classes).view(np.uint8)
        seen: dict[str, Any] = {
            "panorama": panorama,
            "heading": np.int64(heading),
            "held": np.int64(held == ObjectState.HELD),
            "command": self._words[command].copy(),
        }
        if self._text:
            seen["text"] = command
        if self._position:
            seen["tile"] = np.int64(tile)
        return seen


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

    def observe(self, one: TaskSet, state: int) -> NDArray[np.float32]:
        """The observation, as a new array."""
        tile, heading, held = one.place(state)
        vector = np.zeros(self._tiles + HEADINGS + OBJECT_STATES, np.float32)
        vector[[tile, self._tiles + heading, self._tiles + HEADINGS + held]] = 1.0
        return vector


class StateObserver(Observer):
    """The state's index, for tabular methods: `(object_state * tiles + tile) * 4 + heading`."""

    def __init__(self, benchmark: Benchmark) -> None:
        """Size the space for the largest house of a benchmark."""
        self.space = spaces.Discrete(most_tiles(benchmark) * OBJECT_STATES * HEADINGS)

    def observe(self, one: TaskSet, state: int) -> np.int64:
        """The state's index; `tiles` is that of the task's house."""
        del one
        return np.int64(state)


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
