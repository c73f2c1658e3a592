"""Doing a job, in whichever process: call the function, keep its value, answer with JSON."""

from __future__ import annotations

import fcntl
import json
import logging
import os
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from lcrl_bench.attempt import set_attempt
from lcrl_bench.errors import EnvironmentMissingError, ExitCode, LcrlError
from lcrl_bench.jobs.job import Answer, Job, Tell, kept_answer, untold
from lcrl_bench.registry import import_target
from lcrl_bench.storage import cache_dir, write_bytes, write_json, writing

_logger = logging.getLogger(__name__)


def perform(order: str, tell: Tell = untold) -> str:
    """Do a job, unless its value is there; errors become part of the answer.

    Two processes with the same job don't do it at once: the second waits for the first.

    Args:
        order: `Job.order(...)`.
        tell: Told how far it has got.

    Returns:
        `Answer.text()`.
    """
    document = json.loads(order)
    try:
        return _answer(document, tell).text()
    except LcrlError as error:
        return Answer(error=str(error), exit_code=int(error.exit_code)).text()
    except Exception as error:
        name = type(error).__name__
        text = f"{name}: {error}".splitlines()[0] if str(error) else name
        where = _log(document["name"], error)
        return Answer(error=f"{text}{where}", exit_code=int(ExitCode.BUG)).text()


def do_here(job: Job, tell: Tell = untold) -> Any:  # noqa: ANN401 - a JSON value
    """Do a job for its value alone, which is not kept; its errors are the caller's."""
    return import_target(job.function)(job.arguments, tell)


def perform_elsewhere(order: str) -> str:
    """`perform` on a machine of a cluster, in the folder and environment of the command."""
    document = json.loads(order)
    os.environ.update(document["environment"])
    os.chdir(document["folder"])
    set_attempt(document["command"], document["attempt"], document["name"])
    return perform(order)


def _answer(document: dict[str, Any], tell: Tell) -> Answer:
    function = import_target(document["function"])
    if document["file"] is None:
        return Answer(function(document["arguments"], tell))
    file, outputs = Path(document["file"]), [Path(text) for text in document["outputs"]]
    with _alone(file, needed=document["must_keep"]):
        if (found := kept_answer(file, outputs)) is not None:
            return found
        value = function(document["arguments"], tell)
        with _kept_if_possible(needed=document["must_keep"]):
            write_json(file, {"job": document["name"], "value": value})
    return Answer(value)


@contextmanager
def _kept_if_possible(*, needed: bool) -> Iterator[None]:
    """Go on if the cache can't be written, unless another command needs what is written."""
    try:
        yield
    except EnvironmentMissingError as error:
        if needed:
            raise
        _logger.warning("notice: not kept for another time: %s", error)


@contextmanager
def _alone(file: Path, *, needed: bool) -> Iterator[None]:
    """Hold a lock next to a file, waiting for it; it ends with the process that holds it."""
    path, descriptor = file.with_suffix(".lock"), None
    with _kept_if_possible(needed=needed), writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = _lock(path)
    if descriptor is None:
        yield
        return
    try:
        yield
    finally:
        # Removed while held, so that anyone opening it later gets a new file.
        path.unlink(missing_ok=True)
        os.close(descriptor)


def _lock(path: Path) -> int:
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            # Without locks two processes may do the same job: both write the same bytes.
            with suppress(OSError):
                fcntl.flock(descriptor, fcntl.LOCK_EX)
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(descriptor), path.stat()):
                    return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _log(name: str, error: Exception) -> str:
    """Write the traceback of a bug to the logs of the cache; returns where, as text."""
    stem = "".join(letter if letter.isalnum() else "-" for letter in name)[:60]
    path = cache_dir() / "logs" / f"{time.strftime('%Y%m%d-%H%M%S')}-{stem}.log"
    text = "".join(traceback.format_exception(error)).encode("utf-8", "replace")
    try:
        write_bytes(path, text)
    except (OSError, LcrlError):
        return ""
    return f" (see {path})"
