"""Jobs on a real Ray cluster of two nodes: a worker is killed, then a node is taken away."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from job_samples import counts, word_job

from lcrl_bench.errors import EnvironmentMissingError, UsageError
from lcrl_bench.jobs.clusters import cluster_executor
from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.processes import InThisProcess

TESTS = Path(__file__).parents[1]
needs_ray = pytest.mark.skipif(
    importlib.util.find_spec("ray") is None, reason="Ray is not installed: the extra [ray]"
)


def on_ray(program: str, folder: Path, *words: str) -> dict:
    """Run a program of this folder, which has the cluster; returns what it prints last."""
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path[:1]]),
        "LCRL_BENCH_HOME": str(folder / "home"),
        "RAY_USAGE_STATS_ENABLED": "0",
    }
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name(program)), str(folder), *words],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@needs_ray
def test_nothing_is_lost_or_done_twice_when_a_worker_and_a_node_die(tmp_path):
    ended = on_ray("ray_program.py", tmp_path)
    assert counts(tmp_path, "done") == dict.fromkeys("abcd", 1)
    tried = counts(tmp_path, "tried")
    assert tried.pop("a") + tried.pop("b") == 3, "one of them waited on the lost node"
    assert tried == {"c": 2, "d": 1, "e": 1}
    here = tmp_path / "here"
    here.mkdir()
    alike = [word_job(here, word) for word in ("a", "b", "c", "d", "e:fail")]
    assert ended == {
        each.key: [each.error, each.answer.value] for each in run_jobs(alike, InThisProcess())
    }


@needs_ray
@pytest.mark.slow
def test_stopping_ends_the_tasks_and_leaves_nothing_half_written(tmp_path):
    found = on_ray("ray_stop_program.py", tmp_path)
    assert found == {"stopped": True, "alive": False, "left": []}


@needs_ray
@pytest.mark.slow
def test_a_benchmark_and_runs_have_the_same_bits_from_ray(tmp_path):
    found = on_ray("ray_bits_program.py", tmp_path)
    assert found["codes"] == {name: 0 for name in found["codes"]}
    assert found["lost"] == {"worker": True, "node": True}
    assert found["local"]["files"] == found["ray"]["files"]
    assert len(found["local"]["files"]) > 10
    assert found["left"] == []


@needs_ray
def test_an_option_that_ray_does_not_know_is_named():
    with pytest.raises(UsageError, match="num_gpu"):
        cluster_executor("ray", ("num_gpu=1",), workers=0)


@pytest.mark.parametrize(
    ("name", "package"), [("ray", "ray"), ("host:6379", "ray"), ("slurm", "submitit")]
)
def test_without_its_package_a_cluster_says_what_to_install(name, package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(EnvironmentMissingError, match=rf"pip install {package}"):
        cluster_executor(name, (), workers=0)


@pytest.mark.parametrize("name", ["rays", "host", "ray://host", "http://host:1"])
def test_what_is_no_cluster_is_refused(name):
    with pytest.raises(UsageError, match=r"local, ray, slurm, host:port, ray://host:port"):
        cluster_executor(name, (), workers=0)
