"""Which attempt of which job a process of a cluster is at, so that a later one may take over.

The command that gave out a job gives it out again only once the earlier worker is lost. So a lock
that the earlier attempt left on another machine holds nothing any more.
"""

from __future__ import annotations

import os
from typing import Final

ATTEMPT: Final = "LCRL_BENCH_ATTEMPT"
"""Environment variable with the attempt: `"<command> <number> <job>"`."""


def set_attempt(command: str, number: int, job: str) -> None:
    """Say which attempt this process is at.

    Args:
        command: Names the call that gave the job out; without spaces.
        number: 1 for the first attempt.
        job: The job's name.
    """
    os.environ[ATTEMPT] = f"{command} {number} {job}"


def attempt() -> str:
    """The attempt that this process is at; empty outside jobs of a cluster."""
    return os.environ.get(ATTEMPT, "")


def follows(now: str, before: object) -> bool:
    """Whether an attempt is a later one of the same job and command as another."""
    if not (now and isinstance(before, str)) or before.count(" ") < 2:
        return False
    (command, number, job), (earlier, first, same) = now.split(" ", 2), before.split(" ", 2)
    if (command, job) != (earlier, same) or not first.isdecimal():
        return False
    return int(first) < int(number)
