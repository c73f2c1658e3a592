"""Indices on disk: the same bits, and no file that is damaged is believed."""

from __future__ import annotations

import logging
import os
from pathlib import Path

import pytest
import torch
from view_samples import sample_panoramas, sample_views

from lcrl_bench.networks import index_store
from lcrl_bench.networks.grounding import NetworkConfig
from lcrl_bench.networks.index_store import LEAST_VIEWS, cached_index, index_path
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import PatchIndex, build_patch_index

CONFIG = NetworkConfig()
VIEWS, PANORAMAS = sample_views(0, count=LEAST_VIEWS), sample_panoramas(0, views=LEAST_VIEWS)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def refuse_to_build(*_: object, **__: object) -> None:
    raise AssertionError("the index is on disk: it must not be built again")


def assert_same(found: object, expected: PatchIndex) -> None:
    assert isinstance(found, PatchIndex)
    assert found.classes == expected.classes
    assert torch.equal(found.panorama_views, expected.panorama_views)
    for name in index_store._FIELDS:
        ours, theirs = getattr(found, name), getattr(expected, name)
        assert ours.dtype == theirs.dtype
        assert torch.equal(ours, theirs), name


def stored() -> Path:
    path = index_path(VIEWS, classes=CONFIG.classes)
    assert path is not None
    return path


def test_an_index_is_built_once_and_read_back_to_the_bit(monkeypatch):
    expected = build_patch_index(VIEWS, PANORAMAS, classes=61)
    assert_same(cached_index(VIEWS, PANORAMAS, CONFIG), expected)
    monkeypatch.setattr(index_store, "build_index", refuse_to_build)
    again = cached_index(VIEWS, PANORAMAS, CONFIG)
    assert_same(again, expected)
    other = sample_panoramas(1, views=LEAST_VIEWS)
    assert torch.equal(cached_index(VIEWS, other, CONFIG).panorama_views, other)
    encoder = PanoramaEncoder(61, generator=torch.Generator().manual_seed(0))
    assert torch.equal(encoder(again), encoder(expected))


def test_other_views_classes_and_versions_have_files_of_their_own(monkeypatch):
    paths = {index_path(VIEWS, classes=61), index_path(VIEWS, classes=60)}
    changed = VIEWS.clone()
    changed[-1, -1, -1] ^= 1
    paths |= {index_path(changed, classes=61), index_path(VIEWS.mT, classes=61)}
    monkeypatch.setattr(index_store, "INDEX_VERSION", index_store.INDEX_VERSION + 1)
    paths |= {index_path(VIEWS, classes=61)}
    assert len(paths) == 5


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "other"])
def test_a_damaged_file_is_built_again(damage, caplog):
    expected = build_patch_index(VIEWS, PANORAMAS, classes=61)
    cached_index(VIEWS, PANORAMAS, CONFIG)
    whole = stored().read_bytes()
    flipped = bytearray(whole)
    flipped[-1] ^= 1
    contents = {"cut": whole[:-9], "flipped": flipped, "empty": b"", "other": b"{}" * 90}
    stored().write_bytes(contents[damage])
    with caplog.at_level(logging.WARNING):
        assert_same(cached_index(VIEWS, PANORAMAS, CONFIG), expected)
    assert "rebuilding an index" in caplog.text
    assert stored().read_bytes() == whole


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_in_a_folder_that_can_not_be_written_indices_stay_in_memory(cache, caplog):
    cache.mkdir()
    cache.chmod(0o500)
    with caplog.at_level(logging.INFO):
        found = cached_index(VIEWS, PANORAMAS, CONFIG)
    assert_same(found, build_patch_index(VIEWS, PANORAMAS, classes=61))
    assert "not cached" in caplog.text


def test_where_the_cache_folder_is_a_file_indices_stay_in_memory(cache, caplog):
    cache.write_text("in the way")
    with caplog.at_level(logging.INFO):
        found = cached_index(VIEWS, PANORAMAS, CONFIG)
    assert_same(found, build_patch_index(VIEWS, PANORAMAS, classes=61))
    assert "not cached" in caplog.text


def test_a_few_views_and_other_encoders_leave_no_file(cache):
    cached_index(VIEWS[:-1], torch.zeros(1, 4, dtype=torch.int64), CONFIG)
    cached_index(VIEWS, PANORAMAS, NetworkConfig(image="fc"))
    assert not cache.exists()
