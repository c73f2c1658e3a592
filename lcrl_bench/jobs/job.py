"""`Job`: a function of JSON arguments and input files, named by a digest of both and of the code.

A job crosses processes and machines as JSON: the function's name, its arguments, and where its
value is kept. Files are named by path, so all machines must see the same ones (a shared file
system). The value is written atomically under the job's digest and stays there until the command
that wanted it has it (`forget`), so a command that was killed finds what its jobs had finished.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, Protocol

from lcrl_bench.errors import ExitCode, InvalidFileError
from lcrl_bench.jobs.code import code_digest
from lcrl_bench.storage import cache_dir, canonical_json, read_json, sha256_of


class Tell(Protocol):
    """Takes how far a job has got."""

    def __call__(self, share: float, note: str = "") -> None:
        """Take the fraction done, in [0, 1], and what else is worth showing: the loss."""


def untold(share: float, note: str = "") -> None:
    """A `Tell` for nobody."""


PASSED_ON: Final = "LCRL_BENCH_"
"""Prefix of the environment variables that jobs on other machines get."""


@dataclass(frozen=True)
class Job:
    """A piece of work that needs nothing but its arguments and files.

    Equal digests mean equal values, so a job is done once, whoever asks for it.
    """

    name: str
    """Unique among the jobs of a command, and shown: `"lcrl/seed0"`."""
    function: str
    """`"package.module:function"`. It is called with `arguments` and with a `Tell`, and returns a
    JSON value."""
    arguments: Mapping[str, Any]
    """A JSON object."""
    inputs: tuple[Path, ...] = ()
    """Files that the value depends on, besides the arguments."""
    outputs: tuple[Path, ...] = ()
    """Files that the function writes besides; where one is missing, a kept value counts as none."""
    after: tuple[str, ...] = ()
    """Names of jobs that must succeed first."""
    kept: bool = True
    """Whether the value is kept in `file`. False if the function itself keeps what it has
    finished, as a run does in its folder; it is then called again, and reads that back."""

    @cached_property
    def digest(self) -> str:
        """SHA-256 of function, code, arguments and input files; 64 hexadecimal digits."""
        content = {
            "function": self.function,
            "code": code_digest(),
            "arguments": dict(self.arguments),
            "inputs": [sha256_of(path.read_bytes()) for path in self.inputs],
        }
        return sha256_of(canonical_json(content))

    @property
    def file(self) -> Path:
        """Where the value is kept: `jobs/` of the cache, `$LCRL_BENCH_HOME`."""
        return cache_dir() / "jobs" / self.digest[:2] / f"{self.digest}.json"

    def finished(self) -> Answer | None:
        """The kept answer; None if the job is not done, or keeps none."""
        return kept_answer(self.file, self.outputs) if self.kept else None

    def order(self, *, command: str, attempt: int, must_keep: bool = False) -> str:
        """The job as JSON text, for another process or machine.

        Args:
            command: Names the call that gives the job out; without spaces.
            attempt: How often it was given out, this time included.
            must_keep: Whether the job fails if its value can't be kept.
        """
        home = str(cache_dir().resolve())
        passed = {key: text for key, text in os.environ.items() if key.startswith(PASSED_ON)}
        order = {
            "name": self.name,
            "function": self.function,
            "arguments": dict(self.arguments),
            "file": str(self.file.resolve()) if self.kept else None,
            "outputs": [str(path) for path in self.outputs],
            "folder": str(Path.cwd()),
            "command": command,
            "attempt": attempt,
            "must_keep": must_keep,
            "environment": {**passed, "LCRL_BENCH_HOME": home},
        }
        return json.dumps(order, allow_nan=False)


@dataclass(frozen=True)
class Answer:
    """What came of a job."""

    value: Any = None
    """The function's JSON value."""
    error: str | None = None
    """None if the job succeeded."""
    exit_code: int = ExitCode.DONE
    """The `ExitCode` that the error stands for."""

    def text(self) -> str:
        """The answer as JSON text."""
        return json.dumps(asdict(self), allow_nan=False)

    @classmethod
    def read(cls, text: str) -> Answer:
        """The answer of a JSON text."""
        return cls(**json.loads(text))


def kept_answer(file: Path, outputs: Iterable[Path] = ()) -> Answer | None:
    """The answer in a file; None if there is none, or one of its job's outputs is missing.

    A damaged file counts as none.
    """
    # Not Path.exists, which raises where a parent folder can't be searched.
    if not all(os.path.exists(path) for path in (file, *outputs)):
        return None
    try:
        return Answer(value=read_json(file)["value"])
    except (InvalidFileError, KeyError, TypeError):
        return None


def forget(jobs: Iterable[Job]) -> None:
    """Remove kept values, once what they were wanted for is written."""
    for job in jobs:
        if job.kept:
            # What can't be removed from a cache does no harm there.
            with suppress(OSError):
                job.file.unlink(missing_ok=True)
