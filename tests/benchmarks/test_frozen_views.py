"""Views that ship with a benchmark: what rendering gives, and never trusted when damaged."""

from __future__ import annotations

import json
import logging
from dataclasses import replace

import numpy as np
import pytest
from benchmark_samples import tiny_benchmark
from numpy.typing import NDArray
from scenes.panoramas.panorama_samples import need_gl

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.document import read_benchmark, view_file, write_benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.rerender import join_agreements, rerender
from lcrl_bench.benchmarks.task_sets import house_task_sets
from lcrl_bench.benchmarks.view_jobs import agreements_of, freeze_jobs, rerender_jobs
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.processes import InThisProcess

HOUSE = min(tiny_benchmark().houses)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    need_gl()
    path = tmp_path_factory.mktemp("frozen") / "tiny"
    write_benchmark(path, tiny_benchmark())
    arrangements = arrangements_of(tiny_benchmark().select(house=HOUSE))
    tiny_benchmark().scene(HOUSE).freeze(arrangements, view_file(path, HOUSE))
    return path


def seen(benchmark: Benchmark, house: str, **how) -> NDArray[np.uint8]:
    """What is seen in the task sets of a house: [panorama, 4, row, column]."""
    views = house_task_sets(benchmark, house, **how)[0].views
    return np.stack([views.pixels(number) for number in range(len(views))])


def test_frozen_views_are_used_and_are_what_rendering_gives(folder, monkeypatch):
    rendered = seen(tiny_benchmark(), HOUSE, renderer="gl")
    with monkeypatch.context() as patch:
        patch.setattr("lcrl_bench.scenes.scene.open_renderer", None)
        patch.setattr("lcrl_bench.scenes.scene.cached_panoramas", None)
        frozen = seen(read_benchmark(folder), HOUSE)
    np.testing.assert_array_equal(frozen, rendered)


def test_frozen_views_change_no_fingerprint(folder):
    assert read_benchmark(folder).fingerprint == tiny_benchmark().fingerprint


def test_damaged_views_are_rendered_instead_with_a_notice(folder, tmp_path, caplog):
    whole = view_file(folder, HOUSE).read_bytes()
    broken = tmp_path / "broken.npz"
    broken.write_bytes(whole[: len(whole) // 2])
    benchmark = replace(read_benchmark(folder), views={HOUSE: broken})
    with caplog.at_level(logging.WARNING):
        found = seen(benchmark, HOUSE)
    assert "instead of using frozen views" in caplog.text
    expected = seen(tiny_benchmark(), HOUSE)
    np.testing.assert_array_equal(found, expected)


def test_views_of_another_arrangement_are_not_used(folder, caplog):
    benchmark = read_benchmark(folder)
    fewer = replace(benchmark, tasks=benchmark.tasks[:-1])
    other = next(task.house for task in benchmark.tasks[-1:])
    stale = replace(fewer, views={other: view_file(folder, HOUSE)})
    with caplog.at_level(logging.WARNING):
        seen(stale, other)
    assert "instead of using frozen views" in caplog.text


def test_rendering_again_shows_the_same_with_both_renderers(folder):
    found = rerender(read_benchmark(folder), ("gl", "rays"), houses=(HOUSE,))
    assert found["gl"].equal == found["gl"].worst == 1.0
    assert found["rays"].equal >= 0.999
    assert found["rays"].worst >= 0.99


def test_the_freeze_verb_ships_every_house(folder, capsys):
    assert main(["benchmark", "freeze", str(folder)]) == ExitCode.DONE
    assert set(read_benchmark(folder).views) == set(tiny_benchmark().houses)
    assert main(["benchmark", "freeze", str(folder.parent)]) == ExitCode.USAGE
    capsys.readouterr()


def test_counts_are_parsed_and_a_mistake_is_named(folder, tmp_path, capsys):
    words = ["--houses", str(folder / "houses"), "--out", str(tmp_path / "b"), "--name", "b"]
    assert main(["benchmark", "build", *words, "--counts", "train.fly=3"]) == ExitCode.USAGE
    assert "train.fly=3" in capsys.readouterr().err


def test_views_frozen_as_jobs_are_those_frozen_house_by_house(folder, tmp_path):
    benchmark, copy = tiny_benchmark(), tmp_path / "tiny"
    write_benchmark(copy, benchmark)
    jobs = freeze_jobs(copy, benchmark)
    sizes = [each.answer.value for each in run_jobs(jobs, InThisProcess())]
    files = [view_file(copy, name) for name in benchmark.houses]
    assert sizes == [file.stat().st_size for file in files]
    assert view_file(copy, HOUSE).read_bytes() == view_file(folder, HOUSE).read_bytes()


def test_houses_rendered_again_as_jobs_agree_as_all_at_once(folder):
    benchmark = read_benchmark(folder)
    names, backends = tuple(benchmark.houses), ("gl", "rays")
    jobs = rerender_jobs(folder, benchmark, names, backends)
    values = [each.answer.value for each in run_jobs(jobs, InThisProcess())]
    joined = join_agreements([agreements_of(value) for value in values])
    assert joined == rerender(benchmark, backends)


def test_a_check_renders_again_on_request(folder, capsys):
    assert main(["benchmark", "check", str(folder), "--render", "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer["render"]["gl"]["equal"] == 1.0
    assert answer["checked"] == len(tiny_benchmark().tasks)


def test_generated_houses_become_a_benchmark_with_its_views(tmp_path, capsys):
    need_gl()
    few = ("--nav", "3", "--pick", "2", "--workers", "1", "--json")
    out = tmp_path / "two"
    assert main(["benchmark", "build", "--procedural", "2", "--out", str(out), *few]) == 0
    built = json.loads(capsys.readouterr().out)
    assert (built["name"], built["houses"]) == ("two", 2)
    benchmark = read_benchmark(out)
    assert set(benchmark.views) == set(benchmark.houses)
    assert main(["benchmark", "build", *few]) == ExitCode.USAGE
    assert "--procedural" in capsys.readouterr().err
