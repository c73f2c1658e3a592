"""`Task`: a command in a house, what fulfils it, and where the agent starts."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any, Protocol, SupportsIndex, overload

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.houses.house import PlacedObject, RoomType
from lcrl_bench.panoramas import Panorama


class Kind(StrEnum):
    """The paper's two kinds of task."""

    NAV = "nav"
    """Go somewhere."""
    PICK = "pick"
    """Move an object somewhere."""


class Split(StrEnum):
    """The paper's three segments of the tasks."""

    TRAIN = "train"
    TEST_TASK = "test-task"
    """New tasks in the training houses."""
    TEST_HOUSE = "test-house"
    """Tasks in houses that occur nowhere else."""


@dataclass(frozen=True)
class Proof:
    """What is known exactly of a task; see `benchmarks.proof`."""

    optimal_length: int
    """Actions of the shortest solution, 1 .. horizon."""
    value: float
    """V* of the start under the true reward: the best possible return."""
    random_success: float
    """Probability that uniformly random actions succeed within the horizon."""


class Home(Protocol):
    """What a task was loaded from: it knows the task's house and dynamics."""

    @property
    def benchmark(self) -> Any:  # noqa: ANN401 - a `Benchmark`, which knows tasks
        """The benchmark."""
        ...

    def single(self, task: Task) -> Any:  # noqa: ANN401 - a `TaskSet`, which knows tasks
        """The task as a `TaskSet` of one."""
        ...


@dataclass(frozen=True)
class Task:
    """One task of a benchmark.

    Example:
        >>> benchmark = lcrl_bench.load_benchmark("mini")
        >>> task = benchmark.tasks["test-house"][0]
        >>> task.command
        'go to the candle'
        >>> task.panorama(tile=4).shape
        (4, 24, 32)
    """

    id: str
    kind: Kind
    split: Split
    house: str
    """Id of its house."""
    command: str
    """The sentence the agent is given."""
    target: str
    """Class name or room type to go to, or to move the object to."""
    start_tile: int
    """Tile of the house's grid the agent starts in."""
    start_heading: int
    """0 .. 3: north, east, south, west."""
    proof: Proof
    moved: str | None = None
    """PICK: id of the object to move."""
    placement: PlacedObject | None = None
    """PICK: that object where it is to be put (place B)."""
    home: Home | None = field(default=None, repr=False, compare=False)
    """The benchmark that it was loaded with; see `load_benchmark`."""

    @property
    def target_room(self) -> RoomType | None:
        """The room type meant, or None if the target is a class of things."""
        return RoomType(self.target) if self.target in set(RoomType) else None

    def carried(self) -> tuple[str, PlacedObject]:
        """PICK: the id of the object to move, and that object where it is to be put.

        Raises:
            ValueError: If it is no PICK task.
        """
        if self.moved is None or self.placement is None:
            raise ValueError(f"task '{self.id}' moves nothing")
        return self.moved, self.placement

    def single(self) -> Any:  # noqa: ANN401 - a `TaskSet`, which knows tasks
        """The task as a `TaskSet` of one: its dynamics and views.

        Raises:
            UsageError: If the task was not loaded with `load_benchmark`.
        """
        if self.home is None:
            raise UsageError(
                f"Task '{self.id}' was not loaded with a benchmark, so its house is unknown. Take "
                "it from lcrl_bench.load_benchmark(...).tasks."
            )
        return self.home.single(self)

    def panorama(self, tile: int | None = None, object_state: int = 0) -> Panorama:
        """What is seen from a tile: the views N, E, S, W, uint8 [4, height, width] class ids.

        Args:
            tile: Tile of the house's grid; None is the one that the agent starts in.
            object_state: Where PICK's object is: 0 at its old place, 1 held, 2 at its new place.

        Raises:
            UsageError: If there is no such tile or object state.
        """
        one = self.single()
        tile = self.start_tile if tile is None else tile
        if not (0 <= tile < one.tiles and 0 <= object_state < one.object_states):
            raise UsageError(
                f"Task '{self.id}' has no tile {tile} with object state {object_state}: its tiles "
                f"are 0 to {one.tiles - 1}, its object states 0 to {one.object_states - 1}."
            )
        return Panorama(
            one.views.pixels(int(one.panoramas[0, object_state * one.tiles + tile])), self
        )

    def to_json(self) -> dict[str, Any]:
        """The task as plain values, as `tasks.json` has it."""
        values = {key: value for key, value in vars(self).items() if key != "home"}
        placed = self.placement
        return {
            **values,
            "proof": asdict(self.proof),
            "placement": None if placed is None else asdict(placed),
        }


class Tasks(tuple[Task, ...]):
    """Tasks in order; `tasks["test-house"]` are those of a split."""

    __slots__ = ()

    @overload
    def __getitem__(self, key: SupportsIndex) -> Task: ...
    @overload
    def __getitem__(self, key: slice | str) -> tuple[Task, ...]: ...
    def __getitem__(self, key: SupportsIndex | slice | str) -> Task | tuple[Task, ...]:
        """A task by its number, some by a slice, or all of a split by its name.

        Raises:
            UnknownNameError: If there is no such split.
        """
        if isinstance(key, str):
            if key not in set(Split):
                raise UnknownNameError("split", key, [split.value for split in Split])
            return tuple(task for task in self if task.split == key)
        return super().__getitem__(key)
