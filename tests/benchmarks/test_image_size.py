"""Views of another size than the benchmark's: the same cameras, more pixels."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets
from lcrl_bench.baselines.lcrl.method import LcRl, LcRlConfig

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.observation import resize_views
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import house_task_sets, load_task_sets
from lcrl_bench.errors import UsageError
from lcrl_bench.methods.train_set import train_set
from lcrl_bench.networks.grounding import ImageName
from lcrl_bench.scenes import scene, store
from lcrl_bench.scenes.panoramas.camera import ray_directions
from lcrl_bench.semantics import DEFAULT_SEMANTICS

SQUARE = (64, 64)
TALL = resize_views(DEFAULT_SEMANTICS, SQUARE)


def sets_of(image_size: tuple[int, int] | None) -> tuple[TaskSet, ...]:
    benchmark = tiny_benchmark()
    name = min(benchmark.houses)
    return house_task_sets(benchmark, name, renderer="rays", image_size=image_size)


def test_the_sides_of_a_picture_still_close_the_circle():
    directions = ray_directions(TALL)
    assert directions.shape == (4, 64, 64, 3)
    assert TALL.horizontal_fov == DEFAULT_SEMANTICS.horizontal_fov
    # Square pixels: as far between rows as between columns.
    north = directions[0]
    across = np.linalg.norm(north[0, 1] - north[0, 0])
    upward = np.linalg.norm(north[1, 0] - north[0, 0])
    assert across == pytest.approx(upward) == pytest.approx(2 / 64)


def test_nothing_but_the_picture_changes():
    assert replace(TALL, view_width=32, view_height=24) == DEFAULT_SEMANTICS
    assert resize_views(DEFAULT_SEMANTICS, None) is DEFAULT_SEMANTICS
    assert resize_views(DEFAULT_SEMANTICS, (32, 24)) == DEFAULT_SEMANTICS


def test_a_picture_with_more_pixels_looks_where_the_small_one_does_and_between():
    large = ray_directions(resize_views(DEFAULT_SEMANTICS, (96, 72)))
    np.testing.assert_allclose(large[:, 1::3, 1::3], ray_directions(DEFAULT_SEMANTICS), atol=1e-12)


def test_tasks_and_panoramas_are_the_same_at_any_size():
    small, large = sets_of(None), sets_of(SQUARE)
    assert large[0].views.views.shape[1:] == (64, 64)
    assert len(large[0].views) == len(small[0].views)
    for one, other in zip(small, large, strict=True):
        assert one.tasks == other.tasks
        assert torch.equal(one.panoramas, other.panoramas)
        assert torch.equal(one.next_state, other.next_state)
        assert torch.equal(one.goal, other.goal)


def test_every_house_of_a_benchmark_is_seen_at_that_size():
    benchmark, cpu = tiny_benchmark(), torch.device("cpu")
    sets = load_task_sets(benchmark, device=cpu, renderer="rays", image_size=(16, 12))
    assert [house[0].views.house for house in by_house(sets)] == sorted(benchmark.houses)
    assert all(tasks.views.views.shape[1:] == (12, 16) for tasks in sets)
    assert all(tasks.views.views.shape[1:] == (24, 32) for tasks in tiny_task_sets())


@pytest.mark.parametrize("image", ["pooling", "fc"])
def test_a_reward_is_learned_and_scored_at_that_size(tmp_path: Path, image: ImageName):
    benchmark, cpu = tiny_benchmark(), torch.device("cpu")
    sets = load_task_sets(benchmark, device=cpu, renderer="rays", image_size=(16, 12))
    method = LcRl(LcRlConfig(passes=1, least_steps=0, image=image))
    learned = method.fit(
        train_set(benchmark, sets, oracle=False),
        generator=torch.Generator().manual_seed(0),
        device=cpu,
        log=lambda _: None,
    )
    learned.save(tmp_path)
    seen, tasks = sets[0].views, sets[0]
    commands = [task.command for task in tasks.tasks]
    scores = learned.score(seen, commands)
    assert bool(torch.isfinite(scores).all())
    assert torch.equal(LcRl.learns.load(tmp_path).score(seen, commands), scores)


def test_views_of_a_size_are_rendered_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(store, "cache_dir", lambda: tmp_path)
    first = sets_of((16, 16))
    files = list(tmp_path.rglob("*.npz"))
    assert len(files) == 1
    monkeypatch.setattr(scene.Scene, "render", lambda *_: pytest.fail("rendered again"))
    assert torch.equal(sets_of((16, 16))[0].views.views, first[0].views.views)
    assert list(tmp_path.rglob("*.npz")) == files


def test_frozen_views_serve_their_own_size_alone(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, tmp_path: Path
):
    monkeypatch.setattr(scene, "choose_backend", lambda _: "rays")
    frozen = tmp_path / "frozen.npz"
    frozen.write_bytes(b"damaged")
    benchmark = tiny_benchmark()
    name = min(benchmark.houses)
    benchmark = replace(benchmark, views={name: frozen})
    with caplog.at_level(logging.WARNING):
        house_task_sets(benchmark, name, image_size=(16, 16))
        assert "frozen views" not in caplog.text
        house_task_sets(benchmark, name, image_size=(32, 24))
        assert "rendering instead of using frozen views" in caplog.text


@pytest.mark.parametrize("size", [(31, 24), (32, 4), (512, 64), (0, 0)])
def test_sizes_that_can_not_be_are_refused(size):
    with pytest.raises(UsageError, match=r"must be even and within 8 \.\. 256"):
        resize_views(DEFAULT_SEMANTICS, size)
