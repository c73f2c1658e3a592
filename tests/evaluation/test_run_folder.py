"""A run's folder: one run, whole files, rows replaced on resuming."""

import json

import pytest
import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.run_folder import RunFolder

CPU = torch.device("cpu")


def rows(folder: RunFolder) -> list[int]:
    lines = (folder.path / "metrics.jsonl").read_text().splitlines()
    return [json.loads(line)["step"] for line in lines]


def test_a_folder_takes_one_run_only(tmp_path):
    assert not RunFolder(tmp_path).begin({"seed": 0}, device=CPU)
    with pytest.raises(UsageError, match="holds another run"):
        RunFolder(tmp_path).begin({"seed": 1}, device=CPU)


def test_a_finished_run_is_recognised(tmp_path):
    folder = RunFolder(tmp_path)
    folder.begin({"seed": 0}, device=CPU)
    folder.finish({"splits": {}})
    again = RunFolder(tmp_path)
    assert again.begin({"seed": 0}, device=CPU)
    assert again.summary() == {"splits": {}}


def test_steps_done_again_after_a_kill_are_logged_once(tmp_path):
    first = RunFolder(tmp_path)
    for step in range(5):
        first.log({"step": step, "loss": 0.5})
    resumed = RunFolder(tmp_path)
    for step in (3, 4, 5):
        resumed.log({"step": step, "loss": 0.4})
    assert rows(resumed) == [0, 1, 2, 3, 4, 5]


def test_half_a_line_left_by_a_kill_is_dropped(tmp_path):
    folder = RunFolder(tmp_path)
    folder.log({"step": 0})
    with (tmp_path / "metrics.jsonl").open("a") as file:
        file.write('{"step": 1, "lo')
    resumed = RunFolder(tmp_path)
    resumed.log({"step": 1})
    assert rows(resumed) == [0, 1]


def test_the_environment_names_the_versions_the_kernel_and_the_threads(tmp_path, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
    RunFolder(tmp_path).begin({"seed": 0}, device=CPU)
    found = json.loads((tmp_path / "environment.json").read_text())
    assert found["device"] == "cpu"
    assert found["kernel"] == "torch"
    assert found["threads"] == torch.get_num_threads()
    assert found["versions"]["mujoco"].startswith("3.")
