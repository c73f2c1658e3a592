"""The record of an episode: complete, readable with NumPy alone, and refused when damaged."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.recording.episode import Episode, read_episode, write_episode
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.scene import Scene

Sets = tuple[TaskSet, ...]
SAMPLES = ("nav_episode", "pick_episode", "policy_episode")


@pytest.fixture(params=SAMPLES)
def episode(request: pytest.FixtureRequest) -> Episode:
    return request.getfixturevalue(request.param)


def rewrite(path: Path, **changes: object) -> None:
    """Change arrays of a record; None takes one away."""
    with np.load(path) as file:
        arrays = {key: file[key] for key in file.files}
    arrays |= changes
    kept: dict[str, Any] = {key: value for key, value in arrays.items() if value is not None}
    np.savez(path, **kept)


def test_a_record_reads_back_as_the_same_episode(episode: Episode, sets: Sets, tmp_path: Path):
    back = read_episode(write_episode(tmp_path, "one", episode), sets[0])
    for field in fields(Episode):
        wrote, read = getattr(episode, field.name), getattr(back, field.name)
        if isinstance(wrote, np.ndarray):
            assert read.dtype == wrote.dtype
            np.testing.assert_array_equal(read, wrote)
        else:
            assert read == wrote, field.name


def test_a_record_needs_only_numpy_and_holds_what_was_seen(episode: Episode, tmp_path: Path):
    with np.load(write_episode(tmp_path, "one", episode), allow_pickle=False) as file:
        arrays = {key: file[key] for key in file.files}
    header = json.loads(str(arrays["header"]))
    assert header["task"]["command"] == episode.task.command
    assert header["fingerprint"] == episode.fingerprint
    assert header["success"] is episode.success
    seen = [episode.views.pixels(number) for number in episode.panoramas[episode.cells]]
    np.testing.assert_array_equal(arrays["seen"], np.stack(seen))
    np.testing.assert_array_equal(arrays["positions"], episode.scene.grid.points[episode.tiles])


def test_the_same_episode_gives_the_same_bytes(nav_episode: Episode, tmp_path: Path):
    first = write_episode(tmp_path, "first", nav_episode).read_bytes()
    assert write_episode(tmp_path, "second", nav_episode).read_bytes() == first


def test_a_record_of_another_house_is_refused(nav_episode: Episode, sets: Sets, tmp_path: Path):
    path = write_episode(tmp_path, "one", nav_episode)
    house = replace(nav_episode.scene.house, id="other")
    other = replace(sets[0], origin=Scene(house, grid=nav_episode.scene.grid))
    with pytest.raises(InvalidFileError, match=r"house 'two-rooms', not in 'other'"):
        read_episode(path, other)


def test_a_record_of_another_grid_is_refused(nav_episode: Episode, sets: Sets, tmp_path: Path):
    path = write_episode(tmp_path, "one", nav_episode)
    grid = nav_episode.scene.grid
    fewer = Grid(
        grid.tile,
        grid.origin,
        grid.cells[:-1],
        grid.points[:-1],
        grid.neighbours[:-1],
        grid.rooms[:-1],
    )
    with pytest.raises(InvalidFileError, match="shape"):
        read_episode(path, replace(sets[0], origin=Scene(nav_episode.scene.house, grid=fewer)))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"reward": np.zeros(3)}, r"'reward' has shape \(3,\)"),
        ({"states": np.full(31, 10**6)}, "'states' leaves 0.."),
        ({"actions": np.full(30, -1)}, r"'actions' leaves 0\.\.3"),
        ({"goal": None}, "it lacks goal"),
        ({"header": "{}"}, "not an episode's record"),
        ({"header": np.array([{}], object)}, "not an episode's record"),
    ],
)
def test_a_damaged_record_is_refused(
    nav_episode: Episode, sets: Sets, tmp_path: Path, changes: dict[str, object], reason: str
):
    path = write_episode(tmp_path, "one", nav_episode)
    rewrite(path, **changes)
    with pytest.raises(InvalidFileError, match=reason):
        read_episode(path, sets[0])


def test_a_truncated_record_is_refused(nav_episode: Episode, sets: Sets, tmp_path: Path):
    path = write_episode(tmp_path, "one", nav_episode)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InvalidFileError, match="not an episode's record"):
        read_episode(path, sets[0])


def test_a_missing_record_is_named(sets: Sets, tmp_path: Path):
    with pytest.raises(InvalidFileError, match="no such file"):
        read_episode(tmp_path / "none.npz", sets[0])
