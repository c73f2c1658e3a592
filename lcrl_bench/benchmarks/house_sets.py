"""Task sets house by house: `by_house`, and `HouseSets`, the sets of very many houses.

Whatever takes task sets takes any sequence of them. What goes through them house by house, with
`by_house`, has only a few houses in memory at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, overload

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.streamed import Streamed

HOUSES_KEPT: Final = 96
"""Most houses of a benchmark that is kept in memory, a few megabytes each; others are streamed."""
LATEST_KEPT: Final = 16
"""Houses in memory of a benchmark that is streamed. More would be no faster, as every pass comes to
all others before it comes back to one."""

House = tuple[TaskSet, ...]
"""The task sets of a house; they share `views`."""


class HouseSets(Sequence[TaskSet]):
    """The task sets of many houses, of which the latest are in memory; see `Streamed`."""

    def __init__(
        self, houses: Streamed[House], named: Sequence[Sequence[tuple[Task, ...]]]
    ) -> None:
        """Take the houses.

        Args:
            houses: At least one set each.
            named: The tasks of each set of each house; empty ones if they are not told.
        """
        self.houses = houses
        self._named = named
        self._places = [(k, row) for k, house in enumerate(named) for row in range(len(house))]

    def __len__(self) -> int:
        """Number of sets."""
        return len(self._places)

    @overload
    def __getitem__(self, number: int) -> TaskSet: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[TaskSet]: ...
    def __getitem__(self, number: int | slice) -> TaskSet | Sequence[TaskSet]:
        """A set, or a list of some."""
        if isinstance(number, slice):
            return [self[k] for k in range(len(self))[number]]
        house, row = self._places[number]
        return self.houses[house][row]

    def named(self) -> Sequence[Sequence[tuple[Task, ...]]]:
        """The tasks of each set of each house."""
        return self._named


def by_house(sets: Sequence[TaskSet]) -> Sequence[House]:
    """Task sets grouped by house (sets that share views), in order of appearance."""
    if isinstance(sets, HouseSets):
        return sets.houses
    groups: dict[int, list[TaskSet]] = {}
    for tasks in sets:
        groups.setdefault(id(tasks.views), []).append(tasks)
    return tuple(map(tuple, groups.values()))


def tasks_of(sets: Sequence[TaskSet]) -> tuple[Task, ...]:
    """All tasks of some sets, in order; loads no house."""
    return tuple(task for tasks in tasks_by_set(sets) for task in tasks)


def tasks_by_set(sets: Sequence[TaskSet]) -> Sequence[tuple[Task, ...]]:
    """The tasks of each set, in order; loads no house."""
    if isinstance(sets, HouseSets):
        return [tasks for house in sets.named() for tasks in house]
    return [tasks.tasks for tasks in sets]


def change_houses(
    sets: Sequence[TaskSet],
    change: Callable[[House], House],
    *,
    keep: Callable[[Task], bool],
    name: Callable[[Task], Task] | None,
) -> Sequence[TaskSet]:
    """What `change` makes of every house, streamed if the sets are.

    Args:
        sets: The sets.
        change: Takes the sets of a house. It leaves out the tasks that `keep` is not true for, and
            sets without any; called for houses with a task left.
        keep: Whether a task is left.
        name: The task in the result; None if the result does not tell.
    """
    if not isinstance(sets, HouseSets):
        houses = [house for house in by_house(sets) if any(map(keep, tasks_of(house)))]
        return tuple(tasks for house in houses for tasks in change(house))
    numbers, named = [], []
    for number, house in enumerate(sets.named()):
        left = [tuple(filter(keep, tasks)) for tasks in house]
        if any(left):
            numbers.append(number)
            named.append([tuple(map(name, tasks)) if name else () for tasks in left if tasks])
    every = sets.houses
    streamed = Streamed(len(numbers), lambda k: change(every[numbers[k]]), kept=every.kept)
    return HouseSets(streamed, named)
