"""Panoramas on disk: exact, cached under a name that says all, and never trusted blindly."""

from __future__ import annotations

import logging
import multiprocessing
import os
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes import store as store_module
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.store import (
    Render,
    cached_panoramas,
    load_panoramas,
    save_panoramas,
    store_key,
    store_path,
)
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


FOUND, HELD = AS_FOUND, Arrangement("cup")
BOTH = (FOUND, HELD)


def example(arrangements: Sequence[Arrangement] = BOTH) -> Panoramas:
    """The first ten panoramas as found, the others with the cup held."""
    parts = {FOUND: PANORAMAS[:10], HELD: PANORAMAS[10:]}
    return Panoramas.build(parts[each] for each in arrangements)


def cached(arrangements: Sequence[Arrangement] = BOTH, render: Render = example) -> Panoramas:
    return cached_panoramas(KEY, arrangements, render)


def never(arrangements: Sequence[Arrangement]) -> Panoramas:
    raise AssertionError(f"rendered again: {arrangements}")


def assert_equal(one: Panoramas, other: Panoramas) -> None:
    assert torch.equal(one.views, other.views)
    assert torch.equal(one.panorama_views, other.panorama_views)
    assert (one.views.dtype, one.panorama_views.dtype) == (torch.uint8, torch.int64)


def test_a_saved_store_reads_back_the_same(tmp_path: Path):
    save_panoramas(tmp_path / "views.npz", example(), key=KEY)
    assert_equal(load_panoramas(tmp_path / "views.npz", key=KEY), example())


def test_saving_twice_writes_the_same_bytes(tmp_path: Path):
    for name in ("a.npz", "b.npz"):
        save_panoramas(tmp_path / name, example())
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
        {"arrangements": None},
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
    built = cached()
    assert_equal(cached(render=never), built)
    assert store_path(KEY) == own_cache / "views" / "ab" / f"{KEY}.npz"


@pytest.mark.parametrize("first", [(FOUND,), (HELD,), BOTH, (HELD, FOUND)])
@pytest.mark.parametrize("second", [(FOUND,), (HELD,), BOTH, (HELD, FOUND), (HELD, HELD)])
def test_only_missing_arrangements_are_rendered_whatever_the_list(first, second):
    asked = []

    def render(arrangements: Sequence[Arrangement]) -> Panoramas:
        asked.extend(arrangements)
        return example(arrangements)

    assert_equal(cached(first, render), example(first))
    assert_equal(cached(second, render), example(second))
    assert len(asked) == len({*first, *second})
    assert_equal(cached((HELD, FOUND), render), example((HELD, FOUND)))


def test_arrangements_that_look_alike_share_their_views():
    def alike(arrangements: Sequence[Arrangement]) -> Panoramas:
        return Panoramas.build([PANORAMAS[:10]] * len(arrangements))

    cached((FOUND,), alike)
    assert_equal(cached((FOUND, HELD), alike), alike(BOTH))


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


def damage_exchanged_arrangements(path: Path) -> None:
    with np.load(path) as archive:
        content = dict(archive)
    content["arrangements"] = content["arrangements"][::-1]
    np.savez_compressed(path, **content)


def damage_file_of_frozen_views(path: Path) -> None:
    save_panoramas(path, example(), key=KEY)


def damage_wild_index(path: Path) -> None:
    with np.load(path) as archive:
        content = dict(archive)
    content["panorama_views"][0, 0] = 10**6
    np.savez_compressed(path, **content)


def damage_wrong_shape(path: Path) -> None:
    save_panoramas(path, Panoramas(example().views[0], example().panorama_views), key=KEY)


def damage_another_stores_file(path: Path) -> None:
    save_panoramas(path, Panoramas.build([PANORAMAS[:3]]), key="cd" * 32)


def damage_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


DAMAGES = [value for name, value in list(globals().items()) if name.startswith("damage_")]


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_a_damaged_or_foreign_file_is_built_again_with_a_notice(
    damage, caplog: pytest.LogCaptureFixture
):
    cached()
    damage(store_path(KEY))
    with caplog.at_level(logging.WARNING):
        assert_equal(cached(), example())
    assert "rebuilding views" in caplog.messages[0]
    if damage is not damage_folder:
        assert_equal(cached(render=never), example())


@pytest.mark.parametrize(
    "damage",
    # Frozen views have one list of arrangements, as part of their key.
    [damage for damage in DAMAGES if damage is not damage_exchanged_arrangements],
    ids=lambda damage: damage.__name__,
)
def test_a_damaged_or_foreign_file_of_frozen_views_is_refused(damage, tmp_path: Path):
    path = tmp_path / "frozen.npz"
    save_panoramas(path, example(), key="ef" * 32)
    damage(path)
    with pytest.raises((InvalidFileError, IntegrityError)):
        load_panoramas(path, key="ef" * 32)


def test_an_archive_too_large_is_refused_unread(monkeypatch: pytest.MonkeyPatch):
    cached()
    monkeypatch.setattr(store_module, "MAX_STORE_BYTES", 1000)
    with pytest.raises(InvalidFileError, match="over the limit"):
        load_panoramas(store_path(KEY), key=KEY)


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(InvalidFileError, match="no such file"):
        load_panoramas(tmp_path / "none.npz")


def test_a_cache_that_can_not_be_written_costs_a_notice_only(
    own_cache: Path, caplog: pytest.LogCaptureFixture
):
    (own_cache / "views").write_text("a file where the folder should be")
    with caplog.at_level(logging.WARNING):
        assert_equal(cached(), example())
    assert "not cached" in caplog.text


def build_in_a_process(home: str, barrier) -> None:
    os.environ["LCRL_BENCH_HOME"] = home

    def build(arrangements: Sequence[Arrangement]) -> Panoramas:
        barrier.wait(timeout=600)
        return example(arrangements)

    assert_equal(cached(render=build), example())


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
    assert_equal(cached(render=never), example())
    assert [path.name for path in store_path(KEY).parent.iterdir()] == [f"{KEY}.npz"]
