"""Panoramas on disk: files that carry their own hash, named by a hash of all their inputs.

Frozen views hold one list of arrangements. The cache has one file per house, which grows by every
arrangement that is asked for, in whatever list: what building a benchmark rendered is what its
first run reads.
"""

from __future__ import annotations

import hashlib
import io
import logging
import os
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import EnvironmentMissingError, IntegrityError, InvalidFileError
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.panoramas.renderer import RENDERER_VERSION
from lcrl_bench.semantics import Semantics
from lcrl_bench.storage import cache_dir, canonical_json, sha256_of, write_bytes

MAX_STORE_BYTES: Final = 4 << 30
"""Largest content read back, in bytes; a large house takes a few tens of megabytes."""
_FIX: Final = "Delete the file; it is rebuilt when needed."
_ARRAYS: Final = ("views", "panorama_views")
_NAMES: Final = "arrangements"
"""In the cache: the SHA-256 of each arrangement, uint8 [arrangement, 32]. Panoramas are numbered
`arrangement * tiles + tile`."""

_logger = logging.getLogger(__name__)


def save_panoramas(path: Path, panoramas: Panoramas, *, key: str = "") -> None:
    """Write panoramas atomically: a compressed npz with the SHA-256 of `key` and content.

    Raises:
        EnvironmentMissingError: If it can't be written.
    """
    _save(path, key, dict(zip(_ARRAYS, _arrays_of(panoramas), strict=True)))


def load_panoramas(path: Path, *, key: str = "", house: str = "") -> Panoramas:
    """Read panoramas and check them against the hash the file carries.

    Raises:
        InvalidFileError: If the file is missing, damaged or not a file of panoramas.
        IntegrityError: If the content does not match the hash, or was saved under another key.
    """
    views, rows = _load(path, key, _ARRAYS)
    return Panoramas.from_arrays(views, rows, house=house)


def _arrays_of(panoramas: Panoramas) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
    return panoramas.views.numpy(), panoramas.panorama_views.numpy().astype(np.int32)


def _save(path: Path, key: str, arrays: dict[str, Any]) -> None:
    buffer = io.BytesIO()
    digest = np.frombuffer(bytes.fromhex(_digest(key, *arrays.values())), np.uint8)
    np.savez_compressed(buffer, **arrays, digest=digest)
    write_bytes(path, buffer.getvalue())


def _load(path: Path, key: str, names: tuple[str, ...]) -> list[NDArray]:
    """The arrays of these names; views and panoramas come first."""
    *arrays, digest = _read_arrays(path, (*names, "digest"))
    if reason := _flaw(arrays[0], arrays[1]):
        raise InvalidFileError(path, reason, fix=_FIX)
    expected, found = digest.tobytes().hex(), _digest(key, *arrays)
    if expected != found:
        raise IntegrityError(path, expected, found, fix=_FIX)
    return arrays


def _digest(key: str, *arrays: NDArray) -> str:
    """SHA-256 of the key, the shapes and the content."""
    digest = hashlib.sha256(key.encode())
    for array in arrays:
        digest.update(canonical_json([str(array.dtype), list(array.shape)]))
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _flaw(views: NDArray, rows: NDArray) -> str:
    """What is wrong with the arrays; empty if nothing is."""
    if views.dtype != np.uint8 or views.ndim != 3 or not views.size:
        return f"its views are {views.dtype}{list(views.shape)}, not uint8[view, row, column]"
    if rows.dtype != np.int32 or rows.ndim != 2 or rows.shape[1:] != (4,) or not rows.size:
        return f"its panoramas are {rows.dtype}{list(rows.shape)}, not int32[panorama, 4]"
    if rows.min() < 0 or rows.max() >= len(views):
        return "a panorama names a view that does not exist"
    return ""


def store_key(
    *,
    house_digest: str,
    semantics: Semantics,
    backend: str,
    points: NDArray[np.float64],
    arrangements: Sequence[Arrangement] | None = None,
) -> str:
    """The name of a store: SHA-256, in hexadecimal, of everything its content depends on.

    Args:
        house_digest: SHA-256 of the House JSON.
        semantics: The cameras' and all other constants.
        backend: `PanoramaRenderer.backend`.
        points: [point, 2] standing points in rendering order.
        arrangements: Arrangements in rendering order; None for the cache, which has any.
    """
    content: dict[str, Any] = {
        "house": house_digest,
        "semantics": asdict(semantics),
        "backend": backend,
        "renderer_version": RENDERER_VERSION,
        "points": np.asarray(points, np.float64).tolist(),
    }
    if arrangements is not None:
        content["arrangements"] = [asdict(arrangement) for arrangement in arrangements]
    return sha256_of(canonical_json(content))


def store_path(key: str) -> Path:
    """The path of the cached store named `key`."""
    return cache_dir() / "views" / key[:2] / f"{key}.npz"


Render = Callable[[Sequence[Arrangement]], Panoramas]
"""Renders every tile of a house in each of some arrangements."""


def cached_panoramas(key: str, arrangements: Sequence[Arrangement], render: Render) -> Panoramas:
    """The panoramas of a house in some arrangements; those missing in the cache are rendered.

    Damaged, truncated or foreign files are never trusted: everything is rendered again, with a
    notice on stderr. Two processes may render at once; both are right, and the last rename wins.

    Args:
        key: From `store_key`, without arrangements.
        arrangements: Arrangements in order.
        render: Called with the missing ones, if any; the result is added to the cache.

    Returns:
        What `render(arrangements)` would.
    """
    path = store_path(key)
    names = [_name(arrangement) for arrangement in arrangements]
    wanted = dict(zip(names, arrangements, strict=True))
    known, store = _read_store(path, key)
    missing = [name for name in wanted if name not in known]
    if missing or store is None:
        rendered = render([wanted[name] for name in missing])
        store = rendered if store is None else Panoramas.joined([store, rendered])
        known += missing
        _write_store(path, key, known, store)
    tiles = len(store) // len(known)
    first = tiles * np.array([known.index(name) for name in names])
    return store.chosen((first[:, None] + np.arange(tiles)).reshape(-1))


def _name(arrangement: Arrangement) -> bytes:
    return hashlib.sha256(canonical_json(asdict(arrangement))).digest()


def _read_store(path: Path, key: str) -> tuple[list[bytes], Panoramas | None]:
    """The names of the arrangements in a cached file, and their panoramas; nothing if unusable."""
    # Not Path.exists, which raises where a parent folder can't be searched.
    if not os.path.exists(path):
        return [], None
    try:
        views, rows, names = _load(path, key, (*_ARRAYS, _NAMES))
    except (InvalidFileError, IntegrityError) as error:
        _logger.warning("notice: rebuilding views: %s", error)
        return [], None
    return [name.tobytes() for name in names], Panoramas.from_arrays(views, rows)


def _write_store(path: Path, key: str, names: Sequence[bytes], panoramas: Panoramas) -> None:
    names_array = np.frombuffer(b"".join(names), np.uint8).reshape(len(names), -1)
    arrays = dict(zip(_ARRAYS, _arrays_of(panoramas), strict=True))
    try:
        _save(path, key, {**arrays, _NAMES: names_array})
    except EnvironmentMissingError as error:
        _logger.warning("notice: views are not cached: %s", error)


def _read_arrays(path: Path, names: tuple[str, ...]) -> list[NDArray]:
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size > MAX_STORE_BYTES:
            limit = f"over the limit of {MAX_STORE_BYTES >> 20} MB"
            raise InvalidFileError(path, f"{size >> 20} MB is {limit}", fix=_FIX)
        with np.load(path, allow_pickle=False) as archive:
            return [archive[name] for name in names]
    except FileNotFoundError as error:
        raise InvalidFileError(path, "no such file", fix="Check the path.") from error
    except OSError as error:
        raise InvalidFileError(path, f"can't be read: {error}", fix=_FIX) from error
    except InvalidFileError:
        raise
    except Exception as error:
        # zipfile, zlib and numpy's header parser each raise their own errors on hostile bytes.
        raise InvalidFileError(path, f"not a file of views ({error})", fix=_FIX) from error
