"""Files: bounded reading, atomic writing, hashing, and where caches live.

A file from outside is hostile until proven otherwise, so reading is bounded in size; a writer
writes to a temporary name in the same folder and renames, so a reader never sees half a file.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from lcrl_bench.errors import InvalidFileError

MAX_JSON_BYTES: Final = 64 * 1024 * 1024
"""Largest JSON document read, in bytes; the largest real house known is under 2 MB."""


def cache_dir() -> Path:
    """The folder of caches: `$LCRL_BENCH_HOME`, else `$XDG_CACHE_HOME/lcrl_bench`."""
    home = os.environ.get("LCRL_BENCH_HOME")
    if home:
        return Path(home)
    return Path(os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))) / "lcrl_bench"


def sha256_of(data: bytes) -> str:
    """Hexadecimal SHA-256 of `data`."""
    return hashlib.sha256(data).hexdigest()


def canonical_json(value: Any) -> bytes:  # noqa: ANN401 - any JSON value
    """The one byte string of a JSON value: sorted keys, no spaces, ASCII, no NaN.

    Raises:
        ValueError: If `value` holds a NaN or an infinity.
    """
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return text.encode("ascii")


def read_json(path: Path, *, max_bytes: int = MAX_JSON_BYTES) -> Any:  # noqa: ANN401
    """Parse a JSON file that may be hostile.

    Args:
        path: The file.
        max_bytes: Files larger than this are refused unread.

    Raises:
        InvalidFileError: If the file is missing, too large, not UTF-8, not JSON, or holds a NaN.
    """
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise InvalidFileError(path, "not a regular file", fix="Name a JSON file.")
        if size > max_bytes:
            limit = f"over the limit of {max_bytes >> 20} MB"
            raise InvalidFileError(path, f"{size >> 20} MB is {limit}", fix="Split or simplify it.")
        return json.loads(path.read_bytes(), parse_constant=_refuse_constant)
    except FileNotFoundError as error:
        raise InvalidFileError(path, "no such file", fix="Check the path.") from error
    except OSError as error:
        raise InvalidFileError(path, f"can't be read: {error.strerror}") from error
    except RecursionError as error:
        raise InvalidFileError(path, "nested too deeply to be a house or a benchmark") from error
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        reason = "not valid JSON" if isinstance(error, json.JSONDecodeError) else "not UTF-8 text"
        where = f"line {error.lineno}" if isinstance(error, json.JSONDecodeError) else ""
        fix = "It may be truncated: fetch or export it again."
        raise InvalidFileError(path, reason, where=where, fix=fix) from error
    except ValueError as error:
        raise InvalidFileError(path, str(error), fix="Replace it by a finite number.") from error


def _refuse_constant(name: str) -> float:
    raise ValueError(f"holds the number {name}")


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`, renamed onto it if the block ends without error.

    The temporary file keeps the suffix of `path` (some writers add one of their own otherwise).
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp makes private files; a cache or a result is as readable as any other file.
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_bytes(path: Path, data: bytes) -> None:
    """Write `data` to `path` atomically."""
    with atomic_path(path) as temporary:
        temporary.write_bytes(data)


def write_json(path: Path, value: Any, *, indent: int | None = 1) -> None:  # noqa: ANN401
    """Write `value` as JSON to `path` atomically (sorted keys, no NaN, newline at the end)."""
    text = json.dumps(value, sort_keys=True, indent=indent, allow_nan=False)
    write_bytes(path, (text + "\n").encode())
