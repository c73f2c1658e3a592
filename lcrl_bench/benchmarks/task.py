"""`Task`: a command in a house, what fulfils it, and where the agent starts."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from lcrl_bench.houses.house import PlacedObject, RoomType


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


@dataclass(frozen=True)
class Task:
    """One task of a benchmark."""

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
