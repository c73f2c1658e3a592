"""`--shard i/n`: the jobs of one of n commands that share the work, for any batch queue."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from lcrl_bench.errors import UsageError
from lcrl_bench.jobs.job import Job

COLLECT: Final = "collect"
"""Instead of `i/n`: do nothing, and read what all shards have finished."""


@dataclass(frozen=True)
class Shard:
    """Part `index` of `count` of some jobs."""

    index: int
    """0 .. count - 1."""
    count: int

    @classmethod
    def parse(cls, text: str) -> Shard:
        """Read `"0/4"`.

        Raises:
            UsageError: If it is no such text.
        """
        found = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
        shard = None if found is None else cls(int(found[1]), int(found[2]))
        if shard is None or shard.index >= shard.count:
            raise UsageError(
                f"--shard {text}: write i/n, with i from 0 to n - 1 (0/4, 1/4, 2/4 and 3/4 are all "
                f"of the work), or {COLLECT} to read what they have finished."
            )
        return shard

    def of(self, jobs: Sequence[Job]) -> list[Job]:
        """The jobs of this shard: those whose number is `index` modulo `count`.

        All commands must list the same jobs, the finished ones included. Jobs that come after
        each other have one number, so that no shard waits for another.
        """
        group = {job.name: number for number, job in enumerate(jobs)}
        for job in jobs:
            joined = {group[name] for name in (job.name, *job.after)}
            group.update({name: min(joined) for name, of in group.items() if of in joined})
        number = {of: rank for rank, of in enumerate(sorted(set(group.values())))}
        return [job for job in jobs if number[group[job.name]] % self.count == self.index]
