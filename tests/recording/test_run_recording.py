"""What is recorded of a run: files, index, sizes; what is there is kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from episode_samples import ForwardPolicy, NoiseReward, SeenReward, make_episode

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.harness import evaluate
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run import Run, RunSpec
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.session import Session, Workplace
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.recording.episode import Episode, read_episode
from lcrl_bench.recording.index import INDEX_FILE, is_recorded, read_index
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.run_recording import Selection, record_run
from lcrl_bench.recording.storyboard import storyboard_of

MAX_BYTES = 1_500_000


def record(
    folder: Path,
    learned: Reward | Policy,
    benchmark: Benchmark,
    selection: Selection,
    progress: Callable[[str], None] = lambda _: None,
) -> Path:
    """Record a run of seed 3 that learned something; `Session` renders what is seen."""
    session = Session(benchmark, Workplace(folder, renderer="rays"))
    results = Results.of("seen", 3, evaluate(learned, session.task_sets()))
    run = Run(RunSpec("seen", seed=3), RunFolder(folder), learned, results)
    return record_run(run, session, selection, progress=progress)


def test_an_episode_has_a_small_recording_and_a_record_that_reads_back(
    tmp_path: Path,
    sets: tuple[TaskSet, ...],
    benchmark_sample: Benchmark,
    nav_episode: Episode,
    pick_episode: Episode,
):
    rows = ['{"step": 1, "steps": 2, "loss": 2.0}\n', '{"step": 2, "steps": 2, "loss": 1.0}\n']
    (tmp_path / "metrics.jsonl").write_text("".join(rows))
    assert not is_recorded(tmp_path, "showcase")
    path = record(tmp_path, SeenReward(), benchmark_sample, "all")
    assert path == tmp_path / "recording.rrd"
    for name in ("recording.rrd", "showcase.png", "curves.png"):
        assert (tmp_path / name).stat().st_size > 1000, name
    assert is_recorded(tmp_path, "showcase")
    assert is_recorded(tmp_path, "all")
    assert not is_recorded(tmp_path, "failures")
    index = read_index(tmp_path / "episodes")
    assert index.selections == ("showcase", "all")
    assert {entry.task for entry in index.episodes} == {task.id for task in benchmark_sample.tasks}
    for entry in index.episodes:
        assert set(entry.files) == {"record", "recording", "map", "strip"}
        for file in entry.files.values():
            assert (tmp_path / "episodes" / file.path).stat().st_size == file.bytes
        assert entry.files["recording"].bytes < MAX_BYTES
        back = read_episode(tmp_path / "episodes" / entry.files["record"].path, sets[0])
        assert (back.task.id, back.success) == (entry.task, entry.reached)
        (followed,) = [e for e in (nav_episode, pick_episode) if e.task.id == entry.task]
        np.testing.assert_array_equal(back.states, followed.states)
        assert (back.method, back.seed, back.benchmark) == ("seen", 3, benchmark_sample.name)

    # Interrupted: one recording is missing, and what is there is kept.
    first, second = (tmp_path / "episodes" / e.files["recording"].path for e in index.episodes)
    time_before = second.stat().st_mtime_ns
    first.unlink()
    (tmp_path / "episodes" / INDEX_FILE).write_text(
        replace_selections(index.model_dump_json(), '["showcase","all"]', '["showcase"]')
    )
    record(tmp_path, SeenReward(), benchmark_sample, "all")
    assert first.stat().st_size > 1000
    assert second.stat().st_mtime_ns == time_before
    again = read_index(tmp_path / "episodes")
    assert again.selections == index.selections
    assert [e.task for e in again.episodes] == [e.task for e in index.episodes]


def replace_selections(text: str, before: str, after: str) -> str:
    assert before in text
    return text.replace(before, after)


class StoppedError(Exception):
    """Raised in the middle of a recording."""


def test_an_interrupted_recording_goes_on_where_it_stopped(
    tmp_path: Path, benchmark_sample: Benchmark
):
    recorded: list[str] = []

    def stop(task: str) -> None:
        recorded.append(task)
        raise StoppedError

    with pytest.raises(StoppedError):
        record(tmp_path, SeenReward(), benchmark_sample, "all", stop)
    (first,) = recorded
    assert not is_recorded(tmp_path, "all")
    files = {each.task: each.files for each in read_index(tmp_path / "episodes").episodes}[first]
    paths = [tmp_path / "episodes" / file.path for file in files.values()]
    before = [path.stat().st_mtime_ns for path in paths]
    record(tmp_path, SeenReward(), benchmark_sample, "all", recorded.append)
    assert is_recorded(tmp_path, "all")
    assert sorted(recorded) == sorted(task.id for task in benchmark_sample.tasks)
    assert [path.stat().st_mtime_ns for path in paths] == before


def test_failures_of_a_policy_are_recorded_with_the_way_they_fail(
    tmp_path: Path, benchmark_sample: Benchmark
):
    record(tmp_path, ForwardPolicy(), benchmark_sample, "failures")
    index = read_index(tmp_path / "episodes")
    failed = {entry.kind: entry for entry in index.episodes if "recording" in entry.files}
    assert failed["pick"].failure in set(Failure)
    assert not failed["pick"].reached
    assert failed["pick"].success < 0.5
    assert not (tmp_path / "curves.png").exists()


def test_a_damaged_index_is_named(tmp_path: Path):
    (tmp_path / INDEX_FILE).write_text('{"format": "lcrl-episodes", "episodes": [{"task": 3}]}')
    with pytest.raises(InvalidFileError, match=r"index\.json.*Delete it"):
        read_index(tmp_path)


def test_the_most_crowded_house_of_the_benchmark_has_a_small_recording_too(tmp_path: Path):
    whole = read_benchmark(benchmark_folder("lcrl-v1"))
    crowded = max(whole.houses, key=lambda house: len(whole.houses[house].objects))
    picks = [task for task in whole.tasks if (task.house, task.kind) == (crowded, Kind.PICK)]
    benchmark = replace(
        whole,
        houses={crowded: whole.houses[crowded]},
        grids={crowded: whole.grids[crowded]},
        tasks=tuple(picks[:1]),
    )
    sets = load_task_sets(benchmark, device=torch.device("cpu"), renderer="rays")
    episode = make_episode(NoiseReward(), sets, benchmark, Kind.PICK)
    record_episodes(tmp_path / "one.rrd", [storyboard_of(episode)])
    assert episode.horizon == 30
    assert 100_000 < (tmp_path / "one.rrd").stat().st_size < MAX_BYTES
