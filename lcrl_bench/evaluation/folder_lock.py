"""A lock on a folder being written, so that two processes never write the same run.

The lock is the operating system's (`flock`), on a file next to the folder: it ends with the process
that holds it, whether by an error, SIGKILL or a power cut. The file names its holder, and is
removed on release; one left behind by a dead process of this machine is taken over, and one of a
lost worker of a cluster by the worker that does its job again.
"""

from __future__ import annotations

import errno
import fcntl
import json
import os
import platform
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from lcrl_bench.attempt import attempt, follows
from lcrl_bench.errors import EnvironmentMissingError, FolderInUseError

_LARGEST: Final = 4096
"""Maximum number of bytes read from a lock file."""


def lock_file(folder: Path) -> Path:
    """The lock file of a folder: `seed0.lock` next to `seed0`."""
    return folder.with_name(f"{folder.name}.lock")


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which need not exist, without waiting for it.

    Raises:
        FolderInUseError: If another process holds it: says which, where and since when. Also if a
            process of another machine left it behind, which can't be checked here.
        EnvironmentMissingError: If the lock file can't be written.
    """
    file = lock_file(folder)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        descriptor = _acquire(file, folder)
    except OSError as error:
        advice = "Free space, or choose another folder."
        raise EnvironmentMissingError(
            f"{file}: can't be written: {error.strerror}. {advice}"
        ) from error
    try:
        yield
    finally:
        # Removed while held, so that anyone opening it later gets a new file.
        file.unlink(missing_ok=True)
        os.close(descriptor)


def _acquire(file: Path, folder: Path) -> int:
    while True:
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _lock(descriptor, file, folder)
            if _is_still(descriptor, file):
                _sign(descriptor, file, folder)
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        # Its holder removed it after we opened it and before we locked it.
        os.close(descriptor)


def _lock(descriptor: int, file: Path, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        fix = "Wait for it to end, or choose another folder."
        raise FolderInUseError(folder, _holder(_read(descriptor)), fix=fix) from error
    except OSError as error:
        if error.errno not in (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP):
            raise
        warnings.warn(
            f"{file}: this file system doesn't support locks ({error.strerror}): make sure that "
            "no other process writes this run.",
            stacklevel=2,
        )


def _sign(descriptor: int, file: Path, folder: Path) -> None:
    """Write our name into a lock we hold."""
    before, host = _read(descriptor), platform.node()
    if before and before.get("host") != host and not follows(attempt(), before.get("attempt")):
        # On some file systems locks are local to a machine: another one may still hold it.
        fix = f"{host} can't check whether it is still running: if it isn't, delete {file}."
        raise FolderInUseError(folder, _holder(before), fix=fix)
    since = time.strftime("%Y-%m-%d %H:%M:%S")
    said = {"pid": os.getpid(), "host": host, "since": since, "attempt": attempt()}
    os.ftruncate(descriptor, 0)
    os.pwrite(descriptor, json.dumps(said).encode(), 0)


def _is_still(descriptor: int, file: Path) -> bool:
    with suppress(FileNotFoundError):
        return os.path.samestat(os.fstat(descriptor), file.stat())
    return False


def _read(descriptor: int) -> dict[str, Any]:
    """What a lock says about its holder; empty while it is being written."""
    try:
        found = json.loads(os.pread(descriptor, _LARGEST, 0))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def _holder(said: dict[str, Any]) -> str:
    if not said:
        return "another process"
    pid, host, since = (said.get(key) for key in ("pid", "host", "since"))
    return f"process {pid} on {host}, since {since}"
