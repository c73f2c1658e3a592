"""The observation store: exact, cached under a name that says all, and never trusted blindly."""

from __future__ import annotations

import logging
import multiprocessing
import os
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes import store as store_module
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.store import ViewStore, load_or_build, store_key, store_path
from lcrl_bench.semantics import DEFAULT_SEMANTICS

KEY = "ab" * 32
PANORAMAS = np.random.default_rng(0).integers(0, 61, (20, 4, 24, 32)).astype(np.uint8)
CUP = PlacedObject("cup", "cup", "room", (0, 1, 1), (0.1, 0.1, 0.1), 0.0)
FACTS = {
    "house_digest": "0" * 64,
    "semantics": DEFAULT_SEMANTICS,
    "backend": "gl",
    "points": np.array([[0.0, 1.0], [2.0, 3.0]]),
    "arrangements": [AS_FOUND, Arrangement("cup")],
}


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    return tmp_path


def example() -> ViewStore:
    return ViewStore.build([PANORAMAS])


def assert_equal(one: ViewStore, other: ViewStore) -> None:
    np.testing.assert_array_equal(one.views, other.views)
    np.testing.assert_array_equal(one.panorama_views, other.panorama_views)
    assert (one.views.dtype, one.panorama_views.dtype) == (np.uint8, np.int32)


few_panoramas = arrays.arrays(
    np.uint8,
    st.tuples(st.integers(1, 6), st.just(4), st.just(2), st.just(3)),
    elements=st.integers(0, 1),
)


@given(few_panoramas, st.integers(1, 6))
def test_a_store_gives_every_panorama_back_and_keeps_no_view_twice(
    panoramas: np.ndarray, batch: int
):
    store = ViewStore.build(iter(panoramas))
    np.testing.assert_array_equal(store.panoramas, panoramas)
    assert len({view.tobytes() for view in store.views}) == len(store.views)
    first_seen = np.unique(store.panorama_views.ravel(), return_index=True)[1]
    assert (np.diff(first_seen) > 0).all()
    batches = [panoramas[start : start + batch] for start in range(0, len(panoramas), batch)]
    assert_equal(ViewStore.build(batches), store)


@pytest.mark.parametrize("batch", [PANORAMAS[:, :3], PANORAMAS.astype(np.int64), PANORAMAS[0, 0]])
def test_what_is_no_panorama_is_refused(batch: np.ndarray):
    with pytest.raises(ValueError, match="a panorama is uint8"):
        ViewStore.build([batch])


def test_a_store_of_nothing_is_refused():
    with pytest.raises(ValueError, match="at least one"):
        ViewStore.build([])


def test_views_of_two_sizes_do_not_mix():
    with pytest.raises(ValueError, match="one size"):
        ViewStore.build([PANORAMAS, PANORAMAS[:, :, :12]])


def test_a_saved_store_reads_back_the_same(tmp_path: Path):
    example().save(tmp_path / "views.npz", key=KEY)
    assert_equal(ViewStore.load(tmp_path / "views.npz", key=KEY), example())


def test_saving_twice_writes_the_same_bytes(tmp_path: Path):
    for name in ("a.npz", "b.npz"):
        example().save(tmp_path / name)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_every_fact_that_decides_the_pixels_changes_the_name():
    moved = replace(CUP, position=(1, 1, 1))
    changes = [
        {},
        {"house_digest": "1" * 64},
        {"semantics": replace(DEFAULT_SEMANTICS, pitch=-0.25)},
        {"backend": "rays"},
        {"points": np.array([[0.0, 1.0], [2.0, 3.001]])},
        {"points": np.array([[2.0, 3.0], [0.0, 1.0]])},
        {"arrangements": [AS_FOUND]},
        {"arrangements": [AS_FOUND, Arrangement("cup", CUP)]},
        {"arrangements": [AS_FOUND, Arrangement("cup", moved)]},
    ]
    names = [store_key(**{**FACTS, **change}) for change in changes]
    assert len(set(names)) == len(names)
    assert names[0] == store_key(**FACTS)


def test_a_new_version_of_the_renderer_changes_the_name(monkeypatch: pytest.MonkeyPatch):
    before = store_key(**FACTS)
    monkeypatch.setattr(store_module, "RENDERER_VERSION", store_module.RENDERER_VERSION + 1)
    assert store_key(**FACTS) != before


def test_a_store_is_built_once(own_cache: Path):
    built = load_or_build(KEY, example)

    def never() -> ViewStore:
        raise AssertionError("built again")

    assert_equal(load_or_build(KEY, never), built)
    assert store_path(KEY) == own_cache / "views" / "ab" / f"{KEY}.npz"


def damage_nothing_left(path: Path) -> None:
    path.write_bytes(b"")


def damage_truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def damage_flipped(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)


def damage_text(path: Path) -> None:
    path.write_text("not an archive")


def damage_other_archive(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "hello")


def damage_pickle(path: Path) -> None:
    content = {"views": np.array([{}], object), "panorama_views": np.zeros((1, 4), np.int32)}
    np.savez(path, digest=np.zeros(32, np.uint8), **content)


def damage_changed_view(path: Path) -> None:
    with np.load(path) as archive:
        content = dict(archive)
    content["views"][0, 0, 0] ^= 1
    np.savez_compressed(path, **content)


def damage_wild_index(path: Path) -> None:
    with np.load(path) as archive:
        content = dict(archive)
    content["panorama_views"][0, 0] = 10**6
    np.savez_compressed(path, **content)


def damage_wrong_shape(path: Path) -> None:
    ViewStore(example().views[0], example().panorama_views).save(path, key=KEY)


def damage_another_stores_file(path: Path) -> None:
    ViewStore.build([PANORAMAS[:3]]).save(path, key="cd" * 32)


def damage_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


DAMAGES = [value for name, value in list(globals().items()) if name.startswith("damage_")]


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_a_damaged_or_foreign_file_is_built_again_with_a_notice(
    damage, caplog: pytest.LogCaptureFixture
):
    load_or_build(KEY, example)
    damage(store_path(KEY))
    with pytest.raises((InvalidFileError, IntegrityError)):
        ViewStore.load(store_path(KEY), key=KEY)
    with caplog.at_level(logging.WARNING):
        assert_equal(load_or_build(KEY, example), example())
    assert "building views again" in caplog.messages[0]
    if damage is not damage_folder:
        assert_equal(ViewStore.load(store_path(KEY), key=KEY), example())


def test_an_archive_too_large_is_refused_unread(monkeypatch: pytest.MonkeyPatch):
    load_or_build(KEY, example)
    monkeypatch.setattr(store_module, "MAX_STORE_BYTES", 1000)
    with pytest.raises(InvalidFileError, match="over the limit"):
        ViewStore.load(store_path(KEY), key=KEY)


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(InvalidFileError, match="no such file"):
        ViewStore.load(tmp_path / "none.npz")


def test_a_cache_that_can_not_be_written_costs_a_notice_only(
    own_cache: Path, caplog: pytest.LogCaptureFixture
):
    (own_cache / "views").write_text("a file where the folder should be")
    with caplog.at_level(logging.WARNING):
        assert_equal(load_or_build(KEY, example), example())
    assert "not cached" in caplog.text


def build_in_a_process(home: str, barrier) -> None:
    os.environ["LCRL_BENCH_HOME"] = home

    def build() -> ViewStore:
        barrier.wait(timeout=600)
        return example()

    assert_equal(load_or_build(KEY, build), example())


def test_two_processes_may_build_the_same_store_at_once(own_cache: Path):
    spawn = multiprocessing.get_context("spawn")
    barrier = spawn.Barrier(2)
    workers = [
        spawn.Process(target=build_in_a_process, args=(str(own_cache), barrier)) for _ in range(2)
    ]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(600)
        assert worker.exitcode == 0
    assert_equal(ViewStore.load(store_path(KEY), key=KEY), example())
    assert [path.name for path in store_path(KEY).parent.iterdir()] == [f"{KEY}.npz"]
