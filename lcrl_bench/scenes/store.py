"""The observation store: a house's unique views and which four each panorama is made of.

Many panoramas share views (a wall seen from two tiles, a room without the object that moved), so
each view is kept once and a network runs over unique views only (paper, appendix "Observation
Caching"). Stores are cached on disk under a name made from all that decides their content.
"""

from __future__ import annotations

import hashlib
import io
import logging
import os
import zipfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import EnvironmentMissingError, IntegrityError, InvalidFileError
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.panoramas.renderer import RENDERER_VERSION
from lcrl_bench.semantics import Semantics
from lcrl_bench.storage import cache_dir, canonical_json, sha256_of, write_bytes

MAX_STORE_BYTES: Final = 4 << 30
"""Largest content read back, in bytes; a large house's store holds some tens of megabytes."""
_FIX: Final = "Delete the file: it is built again when it is needed."
_ARRAYS: Final = ("views", "panorama_views", "digest")

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ViewStore:
    """Unique views, and panoramas as indices of them."""

    views: NDArray[np.uint8]
    """[view, height, width]: class ids 0..60, in order of first appearance."""
    panorama_views: NDArray[np.int32]
    """[panorama, 4]: the indices of its views N, E, S, W."""

    @classmethod
    def build(cls, panoramas: Iterable[NDArray[np.uint8]]) -> Self:
        """Take in panoramas one after another, keeping each view once.

        Args:
            panoramas: Each [4, height, width], or batches [panorama, 4, height, width], all of
                one size.

        Raises:
            ValueError: If there is no panorama, or they are not all of one size.
        """
        index: dict[bytes, int] = {}
        rows: list[NDArray[np.int32]] = []
        shape: tuple[int, ...] = ()
        for batch in panoramas:
            shape = shape or batch.shape[-2:]
            if batch.shape[-2:] != shape:
                raise ValueError(f"panoramas are of one size, not {shape} and {batch.shape[-2:]}")
            found = [index.setdefault(view.tobytes(), len(index)) for view in _views(batch)]
            rows.append(np.array(found, np.int32).reshape(-1, 4))
        if not index:
            raise ValueError("a store needs at least one panorama")
        views = np.frombuffer(b"".join(index), np.uint8).reshape(-1, *shape)
        return cls(views, np.concatenate(rows))

    @property
    def panoramas(self) -> NDArray[np.uint8]:
        """[panorama, 4, height, width]: every panorama in full, for looking at."""
        return self.views[self.panorama_views]

    def save(self, path: Path, *, key: str = "") -> None:
        """Write the store atomically: a compressed npz with the SHA-256 of `key` and content.

        Raises:
            EnvironmentMissingError: If it can't be written.
        """
        buffer = io.BytesIO()
        digest = np.frombuffer(bytes.fromhex(self._digest(key)), np.uint8)
        np.savez_compressed(
            buffer, views=self.views, panorama_views=self.panorama_views, digest=digest
        )
        write_bytes(path, buffer.getvalue())

    @classmethod
    def load(cls, path: Path, *, key: str = "") -> Self:
        """Read a store and check it against the hash it carries.

        Raises:
            InvalidFileError: If the file is missing, damaged or no store.
            IntegrityError: If the content does not match the hash, or was saved under another key.
        """
        arrays = _read_arrays(path)
        store = cls(arrays["views"], arrays["panorama_views"])
        reason = store._flaw()
        if reason:
            raise InvalidFileError(path, reason, fix=_FIX)
        expected, found = arrays["digest"].tobytes().hex(), store._digest(key)
        if expected != found:
            raise IntegrityError(path, expected, found, fix=_FIX)
        return store

    def _digest(self, key: str) -> str:
        """SHA-256 of the key, the shapes and the content."""
        digest = hashlib.sha256(key.encode())
        for array in (self.views, self.panorama_views):
            digest.update(canonical_json([str(array.dtype), list(array.shape)]))
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()

    def _flaw(self) -> str:
        """What is wrong with the arrays themselves; empty if nothing is."""
        views, rows = self.views, self.panorama_views
        if views.dtype != np.uint8 or views.ndim != 3 or not views.size:
            return f"its views are {views.dtype}{list(views.shape)}, not uint8[view, row, column]"
        if rows.dtype != np.int32 or rows.ndim != 2 or rows.shape[1:] != (4,) or not rows.size:
            return f"its panoramas are {rows.dtype}{list(rows.shape)}, not int32[panorama, 4]"
        if rows.min() < 0 or rows.max() >= len(views):
            return "a panorama names a view that is not there"
        return ""


def store_key(
    *,
    house_digest: str,
    semantics: Semantics,
    backend: str,
    points: NDArray[np.float64],
    arrangements: Sequence[Arrangement],
) -> str:
    """The name of a store: SHA-256, in hexadecimal, of all that decides its content.

    Args:
        house_digest: SHA-256 of the House JSON.
        semantics: The cameras' constants and all others.
        backend: `PanoramaRenderer.backend`.
        points: [point, 2] standing points in the order they are rendered in.
        arrangements: In the order they are rendered in.
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
    """Where the store called `key` is cached."""
    return cache_dir() / "views" / key[:2] / f"{key}.npz"


def load_or_build(key: str, build: Callable[[], ViewStore]) -> ViewStore:
    """The cached store called `key`, or the one `build` makes, which is then cached.

    A file that is damaged, truncated or foreign is never trusted: it is built again, with a notice
    on stderr. Two processes may build at once; both are right, and the last rename wins.
    """
    path = store_path(key)
    # Not Path.exists, which raises where a parent folder can't be searched.
    if os.path.exists(path):
        try:
            return ViewStore.load(path, key=key)
        except (InvalidFileError, IntegrityError) as error:
            _logger.warning("notice: building views again: %s", error)
    store = build()
    try:
        store.save(path, key=key)
    except EnvironmentMissingError as error:
        _logger.warning("notice: views are not cached: %s", error)
    return store


def _views(batch: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if batch.dtype != np.uint8 or batch.ndim not in (3, 4) or batch.shape[-3] != 4:
        found = f"{batch.dtype}{list(batch.shape)}"
        raise ValueError(f"a panorama is uint8[4, height, width], not {found}")
    return batch.reshape(-1, *batch.shape[-2:])


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
        # zipfile, zlib and numpy's header parser each raise their own on hostile bytes.
        raise InvalidFileError(path, f"not a store of views ({error})", fix=_FIX) from error
