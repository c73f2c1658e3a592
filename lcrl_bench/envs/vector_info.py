"""`VectorInfo`: the infos of many sub-environments, laid out as Gymnasium's vector environments do.

Each key has an array, and a mask under the key with an underscore before it: whether a
sub-environment has that entry. Entries that are not there are 0 or None.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.envs.setup import facts_of


class VectorInfo:
    """What `info` says of the episodes being played."""

    def __init__(self, environments: int) -> None:
        """Start with no episodes; `environments` is the number of sub-environments."""
        texts = dict.fromkeys(("task", "split", "kind"), np.dtype(object))
        types = {**texts, "optimal_length": np.dtype(int), "optimal_value": np.dtype(float)}
        self._facts = {key: np.zeros(environments, dtype) for key, dtype in types.items()}
        self._columns = tuple((key, f"_{key}", facts) for key, facts in self._facts.items())
        self._all = np.ones(environments, np.bool_)
        self._known: dict[str, tuple[Any, ...]] = {}

    def begin(self, number: int, task: Task) -> None:
        """Start an episode.

        Args:
            number: Index of the sub-environment.
            task: The task it plays.
        """
        facts = self._known.get(task.id)
        if facts is None:
            facts = self._known[task.id] = tuple(facts_of(task).values())
        for (_, _, column), fact in zip(self._columns, facts, strict=True):
            column[number] = fact

    def whole(self, success: NDArray[np.bool_]) -> dict[str, Any]:
        """The infos of all sub-environments.

        Args:
            success: bool [sub-environment]: whether the goal holds.
        """
        every = self._all
        infos: dict[str, Any] = {"success": success, "_success": every.copy()}
        for key, mask, facts in self._columns:
            infos[key] = facts.copy()
            infos[mask] = every.copy()
        return infos

    def some(self, success: NDArray[np.bool_], chosen: NDArray[np.bool_]) -> dict[str, Any]:
        """The infos of some sub-environments.

        Args:
            success: bool [sub-environment]: whether the goal holds.
            chosen: bool [sub-environment]: those that have an entry.
        """
        infos: dict[str, Any] = {"success": success & chosen, "_success": chosen.copy()}
        for key, mask, facts in self._columns:
            blank = np.full(len(facts), None) if facts.dtype == object else np.zeros_like(facts)
            blank[chosen] = facts[chosen]
            infos[key], infos[mask] = blank, chosen.copy()
        return infos
