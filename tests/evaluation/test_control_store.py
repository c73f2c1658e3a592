"""The controls are evaluated once per benchmark, code and device, and read afterwards."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from benchmark_samples import tiny_session, tiny_task_sets

from lcrl_bench.evaluation import session as sessions
from lcrl_bench.evaluation.control_store import controls_path
from lcrl_bench.evaluation.controls import CONTROLS

CPU = torch.device("cpu")


@pytest.fixture(autouse=True)
def _own_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "home"))


def never(sets):
    raise AssertionError("evaluated again")


def files(folder):
    return sorted((folder / "home" / "controls").rglob("*.safetensors"))


def equal(before, after):
    assert list(before) == list(after)
    for name, results in before.items():
        assert after[name].rows == results.rows
        assert after[name].seeds == results.seeds
        assert list(after[name].values) == list(results.values)
        for key, value in results.values.items():
            np.testing.assert_array_equal(after[name].values[key], value)


def test_another_session_reads_the_same_results(tmp_path, monkeypatch):
    before = tiny_session(tmp_path).controls()
    monkeypatch.setattr(sessions, "CONTROLS", dict.fromkeys(CONTROLS, never))
    equal(before, tiny_session(tmp_path).controls())


def test_a_damaged_file_is_written_again(tmp_path):
    before = tiny_session(tmp_path).controls()
    (path,) = files(tmp_path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-4] + b"\xff\xff\xff\xff")
    equal(before, tiny_session(tmp_path).controls())
    assert path.read_bytes() == whole


def test_other_views_tasks_or_threads_are_other_results():
    sets = tiny_task_sets()
    own = controls_path("one", sets, device=CPU, threads=1)
    assert own == controls_path("one", sets, device=CPU, threads=1)
    others = [
        controls_path("two", sets, device=CPU, threads=1),
        controls_path("one", sets[1:], device=CPU, threads=1),
        controls_path("one", sets, device=CPU, threads=2),
    ]
    assert len({own, *others}) == 4
