"""Panoramas on disk: files that carry their own hash, cached by a hash of all their inputs."""

from __future__ import annotations

import hashlib
import io
import logging
import os
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Final

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
_ARRAYS: Final = ("views", "panorama_views", "digest")

_logger = logging.getLogger(__name__)


def save_panoramas(path: Path, panoramas: Panoramas, *, key: str = "") -> None:
    """Write panoramas atomically: a compressed npz with the SHA-256 of `key` and content.

    Raises:
        EnvironmentMissingError: If it can't be written.
    """
    views, rows = panoramas.views.numpy(), panoramas.panorama_views.numpy().astype(np.int32)
    buffer = io.BytesIO()
    digest = np.frombuffer(bytes.fromhex(_digest(key, views, rows)), np.uint8)
    np.savez_compressed(buffer, views=views, panorama_views=rows, digest=digest)
    write_bytes(path, buffer.getvalue())


def load_panoramas(path: Path, *, key: str = "", house: str = "") -> Panoramas:
    """Read panoramas and check them against the hash the file carries.

    Raises:
        InvalidFileError: If the file is missing, damaged or not a file of panoramas.
        IntegrityError: If the content does not match the hash, or was saved under another key.
    """
    arrays = _read_arrays(path)
    views, rows = arrays["views"], arrays["panorama_views"]
    if reason := _flaw(views, rows):
        raise InvalidFileError(path, reason, fix=_FIX)
    expected, found = arrays["digest"].tobytes().hex(), _digest(key, views, rows)
    if expected != found:
        raise IntegrityError(path, expected, found, fix=_FIX)
    return Panoramas.from_arrays(views, rows, house=house)


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
    arrangements: Sequence[Arrangement],
) -> str:
    """The name of a store: SHA-256, in hexadecimal, of everything its content depends on.

    Args:
        house_digest: SHA-256 of the House JSON.
        semantics: The cameras' and all other constants.
        backend: `PanoramaRenderer.backend`.
        points: [point, 2] standing points in rendering order.
        arrangements: Arrangements in rendering order.
    """
    content = {
        "house": house_digest,
        "semantics": asdict(semantics),
        "backend": backend,
        "renderer_version": RENDERER_VERSION,
        "points": np.asarray(points, np.float64).tolist(),
        "arrangements": [asdict(arrangement) for arrangement in arrangements],
    }
    return sha256_of(canonical_json(content))


def store_path(key: str) -> Path:
    """The path of the cached store named `key`."""
    return cache_dir() / "views" / key[:2] / f"{key}.npz"


def cached_panoramas(key: str, render: Callable[[], Panoramas]) -> Panoramas:
    """The cached panoramas named `key`; if missing, `render` makes them and they are cached.

    Damaged, truncated or foreign files are never trusted: they are rendered again, with a
    notice on stderr. Two processes may render at once; both are right, and the last rename wins.
    """
    path = store_path(key)
    # Not Path.exists, which raises where a parent folder can't be searched.
    if os.path.exists(path):
        try:
            return load_panoramas(path, key=key)
        except (InvalidFileError, IntegrityError) as error:
            _logger.warning("notice: rebuilding views: %s", error)
    panoramas = render()
    try:
        save_panoramas(path, panoramas, key=key)
    except EnvironmentMissingError as error:
        _logger.warning("notice: views are not cached: %s", error)
    return panoramas


def _read_arrays(path: Path) -> dict[str, NDArray]:
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size > MAX_STORE_BYTES:
            limit = f"over the limit of {MAX_STORE_BYTES >> 20} MB"
            raise InvalidFileError(path, f"{size >> 20} MB is {limit}", fix=_FIX)
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in _ARRAYS}
    except FileNotFoundError as error:
        raise InvalidFileError(path, "no such file", fix="Check the path.") from error
    except OSError as error:
        raise InvalidFileError(path, f"can't be read: {error}", fix=_FIX) from error
    except InvalidFileError:
        raise
    except Exception as error:
        # zipfile, zlib and numpy's header parser each raise their own errors on hostile bytes.
        raise InvalidFileError(path, f"not a file of views ({error})", fix=_FIX) from error
