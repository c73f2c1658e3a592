"""Indices of distinct patches on disk, so that the same views are indexed once.

All seeds of a method, and every evaluation, look at the same views. An index is a file of its own
in the cache folder, named by a digest of the views and written atomically. It is memory-mapped:
reading one is over ten times as fast as finding the patches again, and the memory of houses that
are not in use can be reclaimed.

A file is used only if the digest in its header is that of its content; a damaged one is written
again. Where the folder can't be written, indices are kept in memory alone.
"""

from __future__ import annotations

import hashlib
import logging
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.networks.grounding import HouseIndex, NetworkConfig, build_index
from lcrl_bench.networks.patches import PatchIndex
from lcrl_bench.storage import cache_dir, canonical_json, sha256_of, write_bytes

INDEX_VERSION: Final = 1
"""Raise it when `build_patch_index` changes what it finds: files of other versions are not read."""
LEAST_VIEWS: Final = 64
"""Fewer views are indexed about as fast as a file is read."""
_DIGEST: Final = "sha256"
_FIELDS: Final = (
    *("row_classes", "cell_rows", "windows", "members", "starts"),
    *("viewers", "viewer_starts"),
)
_logger = logging.getLogger(__name__)


def cached_index(
    views: torch.Tensor, panorama_views: torch.Tensor, config: NetworkConfig
) -> HouseIndex:
    """What `build_index` returns, read from the cache folder if it is there, else written to it.

    Only a `PatchIndex` is stored. Two processes may build the same one at once: both are right, and
    the last rename wins.

    Args:
        views: uint8 [view, height, width]: class ids.
        panorama_views: int64 [panorama, 4], indices into `views`.
        config: The network's architecture.

    Raises:
        ValueError: As `build_index`.
    """
    if config.image == "fc" or len(views) < LEAST_VIEWS:
        return build_index(views, panorama_views, config)
    path = index_path(views, classes=config.classes)
    tensors = None if path is None else _read(path)
    if tensors is not None:
        return PatchIndex(
            classes=config.classes,
            panorama_views=panorama_views.cpu(),
            device=views.device,
            **tensors,
        )
    index = build_index(views, panorama_views, config)
    if path is not None and isinstance(index, PatchIndex):
        _write(path, {name: getattr(index, name) for name in _FIELDS})
    return index


def index_path(views: torch.Tensor, *, classes: int) -> Path | None:
    """The file of the index of some views; None if there is no cache folder."""
    content = [INDEX_VERSION, classes, list(views.shape), sha256_of(_bytes(views))]
    name = sha256_of(canonical_json(content))
    try:
        return cache_dir() / "indices" / name[:2] / f"{name}.safetensors"
    except EnvironmentMissingError:
        return None


def _read(path: Path) -> dict[str, torch.Tensor] | None:
    """The tensors of a file, memory-mapped; None if it is missing or damaged."""
    # Not Path.exists, which raises where a parent folder can't be searched.
    if not os.path.exists(path):
        return None
    try:
        with safe_open(path, framework="pt") as file:
            found = (file.metadata() or {}).get(_DIGEST)
            tensors = {name: file.get_tensor(name) for name in _FIELDS}
        if found == _digest(tensors):
            return tensors
        reason = "its content is not what was written"
    except (OSError, SafetensorError) as error:
        reason = str(error)
    _logger.warning("notice: rebuilding an index: %s: %s", path, reason)
    return None


def _write(path: Path, tensors: Mapping[str, torch.Tensor]) -> None:
    try:
        write_bytes(path, save(dict(tensors), {_DIGEST: _digest(tensors)}))
    except EnvironmentMissingError as error:
        # No notice: it would be one per house, and nothing but time is lost.
        _logger.info("an index is not cached: %s", error)


def _digest(tensors: Mapping[str, torch.Tensor]) -> str:
    """SHA-256 of names, types, shapes and content."""
    digest = hashlib.sha256()
    for name in _FIELDS:
        tensor = tensors[name]
        digest.update(canonical_json([name, str(tensor.dtype), list(tensor.shape)]))
        digest.update(tensor.numpy().tobytes())
    return digest.hexdigest()


def _bytes(tensor: torch.Tensor) -> bytes:
    return tensor.cpu().contiguous().numpy().tobytes()
