"""Temporary files and folders of writers, and the removal of those that dead writers left.

A writer holds the operating system's lock (`flock`) on its temporary file until the end. The lock
ends with the process, even by SIGKILL or with its machine on a shared disk that supports locks, so
the next writer to the same folder knows what nobody writes any more, and removes it.
"""

from __future__ import annotations

import errno
import fcntl
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

PREFIX: Final = ".partial-"
"""How names of temporary files and folders begin."""
_NO_LOCKS: Final = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL)


@contextmanager
def staged(path: Path, *, folder: bool = False) -> Iterator[Path]:
    """Yield a new temporary file or folder next to `path`; it is removed if it is still there.

    Temporaries of dead writers in the same folder are removed first.

    Args:
        path: What is to be written. The temporary file keeps its suffix.
        folder: Whether to make a folder instead of a file.
    """
    sweep(path.parent)
    temporary, descriptor = _new(path, folder)
    try:
        yield temporary
    finally:
        _remove(temporary)
        os.close(descriptor)


def sweep(folder: Path) -> None:
    """Remove the temporaries in a folder whose writers are dead."""
    with os.scandir(folder) as entries:
        found = [Path(entry.path) for entry in entries if entry.name.startswith(PREFIX)]
    for path in found:
        # It may be gone by now, or another user's.
        with suppress(OSError):
            descriptor = os.open(path, os.O_RDONLY)
            try:
                # Refused while its writer lives.
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.path.samestat(os.fstat(descriptor), path.stat()):
                    _bring_back(path)
                    _remove(path)
            finally:
                os.close(descriptor)


def replace_folder(staging: Path, folder: Path) -> None:
    """Put the folder `staging / "new"` in the place of `folder`, which need not exist."""
    if folder.exists():
        # Under its own name, so that it is brought back if we die before the next line.
        (staging / "old").mkdir()
        folder.rename(staging / "old" / folder.name)
    (staging / "new").rename(folder)


def _bring_back(staging: Path) -> None:
    """Undo the first half of a `replace_folder` whose process died between the halves."""
    old = staging / "old"
    if not (staging.is_dir() and old.is_dir() and (staging / "new").exists()):
        return
    for before in old.iterdir():
        if not (place := staging.with_name(before.name)).exists():
            before.rename(place)


def _new(path: Path, folder: bool) -> tuple[Path, int]:
    # A short stem: the temporary name must not be too long if `path` itself isn't.
    stem = path.stem[:32].lstrip(".")
    while True:
        temporary = path.with_name(f"{PREFIX}{stem}-{secrets.token_hex(4)}{path.suffix}")
        try:
            if folder:
                temporary.mkdir(mode=0o700)
                descriptor = os.open(temporary, os.O_RDONLY)
            else:
                descriptor = os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        except FileExistsError:
            continue
        if _hold(descriptor, temporary):
            return temporary, descriptor
        os.close(descriptor)


def _hold(descriptor: int, temporary: Path) -> bool:
    """Lock a temporary of ours; False if a sweeper took it before we could."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.path.samestat(os.fstat(descriptor), temporary.stat())
    except OSError as error:
        # Where there are no locks, sweepers get none either, and remove nothing.
        return error.errno in _NO_LOCKS


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
