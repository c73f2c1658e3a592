"""Files: bounded reading, atomic writing, hashing, and the location of caches.

External files are untrusted, so reading is bounded in size; writers write to a temporary name in
the same folder and rename it, so a reader never sees a partial file (see `staging`).
"""

from __future__ import annotations

import errno
import hashlib
import json
import math
import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final

from lcrl_bench.errors import EnvironmentMissingError, InvalidFileError
from lcrl_bench.staging import replace_folder, staged

FULL_DISK: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
"""Error numbers of writing to a full or broken disk."""

MAX_JSON_BYTES: Final = 64 * 1024 * 1024
"""Largest JSON document read, in bytes."""

MAX_HOUSE_BYTES: Final = 32 * 1024 * 1024
"""Largest house file read, in bytes; the largest known real house is under 2 MB."""

MAX_DEPTH: Final = 32
"""Deepest nesting accepted in a JSON document; a house needs 8."""


def cache_dir() -> Path:
    """The cache folder: `$LCRL_BENCH_HOME`, else in `$XDG_CACHE_HOME`, else in `~/.cache`.

    If neither is set and there is no writable home, it is a folder of this user in the temporary
    folder.

    Raises:
        EnvironmentMissingError: If that folder belongs to another user.
    """
    named = os.environ.get("LCRL_BENCH_HOME")
    if named:
        return Path(named)
    caches = os.environ.get("XDG_CACHE_HOME")
    if caches:
        return Path(caches) / "lcrl_bench"
    folder = Path(os.path.expanduser("~/.cache")) / "lcrl_bench"
    return folder if _can_be_written(folder) else _temporary_cache()


def _can_be_written(folder: Path) -> bool:
    # Without a home, "~" is not expanded, and the path is not absolute.
    there = next((path for path in (folder, *folder.parents) if path.exists()), folder)
    return folder.is_absolute() and there.is_dir() and os.access(there, os.W_OK | os.X_OK)


def _temporary_cache() -> Path:
    user = os.getuid()
    folder = Path(tempfile.gettempdir()) / f"lcrl_bench-{user}"
    folder.mkdir(mode=0o700, exist_ok=True)
    if folder.is_symlink() or folder.stat().st_uid != user:
        reason = f"No folder for caches: {folder} belongs to another user."
        raise EnvironmentMissingError(f"{reason} Name one: export LCRL_BENCH_HOME=/some/folder")
    return folder


def sha256_of(data: bytes) -> str:
    """Hexadecimal SHA-256 of `data`."""
    return hashlib.sha256(data).hexdigest()


def canonical_json(value: Any) -> bytes:  # noqa: ANN401 - any JSON value
    """The canonical encoding of a JSON value: sorted keys, no spaces, ASCII, no NaN.

    Raises:
        ValueError: If `value` contains a NaN or an infinity.
    """
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return text.encode("ascii")


def read_json(path: Path, *, max_bytes: int = MAX_JSON_BYTES) -> Any:  # noqa: ANN401
    """Parse an untrusted JSON file.

    Args:
        path: The file.
        max_bytes: Larger files are rejected unread.

    Raises:
        InvalidFileError: If the file is missing, too large, not UTF-8, not JSON, nested more than
            `MAX_DEPTH` deep, or contains a NaN, an infinity or an integer beyond 64 bits.
    """
    data = read_bytes(path, max_bytes=max_bytes)
    try:
        value = json.loads(data.decode("utf-8-sig"))
    except RecursionError as error:
        raise _too_deep(path) from error
    except UnicodeDecodeError as error:
        fix = "Save it as UTF-8."
        where = f"byte {error.start}"
        raise InvalidFileError(path, "not UTF-8 text", where=where, fix=fix) from error
    except json.JSONDecodeError as error:
        where = f"line {error.lineno} column {error.colno}"
        fix = "It may be truncated: fetch or export it again."
        reason = f"not valid JSON ({error.msg})"
        raise InvalidFileError(path, reason, where=where, fix=fix) from error
    except ValueError as error:  # an integer of thousands of digits
        raise InvalidFileError(path, f"not a usable number: {error}", fix=_NUMBER_FIX) from error
    _check_values(path, value)
    return value


_NUMBER_FIX = "Replace it by a finite number of ordinary size."


def read_bytes(path: Path, *, max_bytes: int = MAX_JSON_BYTES) -> bytes:
    """Read an untrusted file.

    Args:
        path: The file.
        max_bytes: Larger files are rejected unread.

    Raises:
        InvalidFileError: If the file is missing, too large or can't be read.
    """
    try:
        if not path.exists():
            raise InvalidFileError(path, "no such file", fix="Check the path.")
        if not path.is_file():
            raise InvalidFileError(path, "not a regular file", fix="Name a JSON file.")
        size = path.stat().st_size
        if size <= max_bytes:
            with path.open("rb") as file:
                data = file.read(max_bytes + 1)
            # The file may have grown since its size was read.
            size = max(size, len(data))
        if size > max_bytes:
            reason = f"{size / 2**20:.1f} MB is over the limit of {max_bytes / 2**20:.1f} MB"
            raise InvalidFileError(path, reason, fix="Split or simplify it.")
        return data
    except OSError as error:
        reason = f"can't be read: {error.strerror}"
        raise InvalidFileError(path, reason, fix="Check the path and its permissions.") from error


def _too_deep(path: Path) -> InvalidFileError:
    reason = f"nested more than {MAX_DEPTH} deep"
    return InvalidFileError(path, reason, fix="No house or benchmark needs that; export it again.")


def _check_values(path: Path, value: object) -> None:
    """Reject deep nesting, and numbers that don't fit a finite float or int64."""
    stack: list[tuple[object, tuple[str | int, ...]]] = [(value, ())]
    while stack:
        item, place = stack.pop()
        if isinstance(item, dict):
            stack.extend((child, (*place, key)) for key, child in item.items())
        elif isinstance(item, list):
            stack.extend((child, (*place, index)) for index, child in enumerate(item))
        elif isinstance(item, float) and not math.isfinite(item):
            reason = f"holds {item}, which is not a finite number"
            raise InvalidFileError(path, reason, where=json_place(place), fix=_NUMBER_FIX)
        elif isinstance(item, int) and abs(item) >= 2**64:
            reason = "holds an integer beyond 64 bits"
            raise InvalidFileError(path, reason, where=json_place(place), fix=_NUMBER_FIX)
        if len(place) > MAX_DEPTH:
            raise _too_deep(path)


def json_place(parts: tuple[str | int, ...]) -> str:
    """A path into a JSON value in the usual notation: `objects[3].position.x`."""
    text = ""
    for part in parts:
        # Keys come from the file: kept short, and without control characters.
        key = repr(part)[1:-1][:40] if isinstance(part, str) else ""
        text += f"[{part}]" if isinstance(part, int) else f".{key}" if text else key
    return text or "the top level"


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path next to `path`, renamed to it if the block ends without error.

    The temporary file keeps the suffix of `path` (some writers would add their own otherwise).

    Raises:
        EnvironmentMissingError: If the folder can't be made or written to, or the disk is full.
    """
    with _staged(path) as temporary:
        with _full_disk_named(path):
            yield temporary
        with writing(path):
            # Temporary files are private; caches and results should be as readable as others.
            temporary.chmod(0o644)
            temporary.replace(path)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Name `path` if the operating system refuses to write in the block.

    The error of a full disk doesn't name the file, nor do libraries that write one.

    Raises:
        EnvironmentMissingError: If it can't be written.
    """
    try:
        yield
    except OSError as error:
        advice = "Free space, or choose another folder."
        raise EnvironmentMissingError(
            f"{path}: can't be written: {error.strerror or error}. {advice}"
        ) from error


@contextmanager
def _full_disk_named(path: Path) -> Iterator[None]:
    """Like `writing`, but only for the errors of a full disk, as the block may also read."""
    try:
        yield
    except OSError as error:
        if error.errno not in FULL_DISK:
            raise
        with writing(path):
            raise


@contextmanager
def atomic_folder(folder: Path) -> Iterator[Path]:
    """Yield a temporary folder next to `folder`, which replaces it if the block ends without error.

    An existing folder is replaced entirely or not at all.

    Raises:
        EnvironmentMissingError: If it can't be written.
    """
    with _staged(folder, folder=True) as staging:
        fresh = staging / "new"
        try:
            with writing(folder):
                fresh.mkdir()
            with _full_disk_named(folder):
                yield fresh
            with writing(folder):
                replace_folder(staging, folder)
        except EnvironmentMissingError as error:
            # The error names the temporary file.
            message = str(error).replace(str(fresh), str(folder))
            raise EnvironmentMissingError(message) from error


@contextmanager
def _staged(path: Path, *, folder: bool = False) -> Iterator[Path]:
    """Yield a new temporary next to `path`, whose folder is made if it is missing."""
    with ExitStack() as stack:
        with writing(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            temporary = stack.enter_context(staged(path, folder=folder))
        yield temporary


def append_text(path: Path, text: str) -> None:
    """Append `text` to a file atomically.

    Raises:
        EnvironmentMissingError: If it can't be written.
    """
    with writing(path), path.open("ab", buffering=0) as file:
        data, size = text.encode(), file.tell()
        try:
            while data:
                data = data[file.write(data) :]
        except OSError:
            file.truncate(size)
            raise


def write_bytes(path: Path, data: bytes) -> None:
    """Write `data` to `path` atomically.

    Raises:
        EnvironmentMissingError: If it can't be written.
    """
    with atomic_path(path) as temporary, writing(path):
        temporary.write_bytes(data)


def write_json(path: Path, value: Any, *, indent: int | None = 1) -> None:  # noqa: ANN401
    """Write `value` as JSON to `path` atomically (sorted keys, no NaN, newline at the end)."""
    text = json.dumps(value, sort_keys=True, indent=indent, allow_nan=False)
    write_bytes(path, (text + "\n").encode())
