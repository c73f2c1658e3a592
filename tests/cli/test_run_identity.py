"""An old result never passes for a new one: what `run` does where a run is already."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.evaluation.folder_lock import lock_file
from lcrl_bench.storage import write_json

METHOD = '''
import json, os, signal
from lcrl_bench.methods.contract import Method, Reward

class Scaled(Reward):
    """Pays the mean class id in sight, times what is saved."""
    def __init__(self, factor):
        self.factor = factor
    def score(self, views, commands):
        means = views.views.flatten(1).double().mean(1)[views.panorama_views].sum(1)
        return self.factor * means.expand(len(commands), -1)
    def save(self, folder):
        folder.mkdir()
        (folder / "config.json").write_text(json.dumps(self.factor))
    @classmethod
    def load(cls, folder):
        return cls(json.loads((folder / "config.json").read_text()))

class Fixed(Method):
    learns = Scaled
    def fit(self, train, *, generator, device, log, checkpoint=None):
        if "KILL_ME" in os.environ:
            os.kill(os.getpid(), signal.SIGKILL)
        return Scaled(1.0)
'''


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


def words(benchmark: Path, home: Path, *flags: str) -> list[str]:
    base = ("run", "--method", f"{home / 'mine.py'}:Fixed", "--benchmark", str(benchmark))
    return [*base, "--out", str(home / "runs"), "--renderer", "rays", "--no-record", *flags]


@pytest.fixture(scope="module")
def finished(benchmark, tmp_path_factory) -> Path:
    """A folder with a method's file and its finished run: not to be changed."""
    home = tmp_path_factory.mktemp("finished")
    (home / "mine.py").write_text(METHOD)
    assert main(words(benchmark, home)) == ExitCode.DONE
    return home


@pytest.fixture
def home(finished, tmp_path) -> Iterator[Path]:
    """The same, to spoil: under its own path, which is part of a run's identity."""
    kept = tmp_path / "kept"
    shutil.copytree(finished, kept)
    yield finished
    shutil.rmtree(finished)
    shutil.copytree(kept, finished)


def seed0(home: Path) -> Path:
    return home / "runs" / "tiny" / "mine" / "seed0"


def files_of(folder: Path) -> dict[Path, tuple[int, bytes]]:
    return {
        path: (path.stat().st_mtime_ns, path.read_bytes())
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_the_figures_of_a_method_that_was_edited_are_not_printed(benchmark, home, capsys):
    before = files_of(seed0(home))
    (home / "mine.py").write_text(METHOD.replace("Scaled(1.0)", "Scaled(-1.0)"))
    assert main(words(benchmark, home)) == ExitCode.USAGE
    shown = capsys.readouterr()
    assert shown.out == ""
    assert re.search(r"another run, finished 2\d\d\d-\d\d-\d\d \d\d:\d\d", shown.err)
    assert "It differs in the method's mine.py (edited since)." in shown.err
    assert "--fresh" in shown.err
    assert files_of(seed0(home)) == before

    assert main(words(benchmark, home, "--fresh", "--json")) == ExitCode.DONE
    shown = capsys.readouterr()
    assert "seed0.old1" in shown.err
    assert json.loads(shown.out)["read_back"] == {}
    assert json.loads((seed0(home) / "model" / "config.json").read_text()) == -1.0
    aside = files_of(seed0(home).with_name("seed0.old1"))
    assert sorted(aside.values()) == sorted(before.values())


def test_a_result_that_is_read_back_says_so_with_its_date(benchmark, home, capsys):
    before = files_of(seed0(home))
    (seed0(home) / "DONE").write_text("2026-11-27T18:02:11+00:00")
    assert main(words(benchmark, home, "--json")) == ExitCode.DONE
    shown = capsys.readouterr()
    assert re.search(
        r"seed 0: read back from \S*seed0 \(finished 2026-11-2\d \d\d:\d2\)", shown.err
    )
    (finished,) = json.loads(shown.out)["read_back"].values()
    assert finished.startswith("2026-11-2")
    after = files_of(seed0(home))
    assert {path.name for path in after if after[path] != before[path]} == {"DONE"}


def test_the_same_run_is_read_back_though_fresh_is_given(benchmark, home, capsys):
    assert main(words(benchmark, home, "--fresh")) == ExitCode.DONE
    assert "read back" in capsys.readouterr().err
    assert not seed0(home).with_name("seed0.old1").exists()


def test_versions_of_packages_are_named_beside_what_is_read_back(benchmark, home, capsys):
    file = seed0(home) / "environment.json"
    made_with = json.loads(file.read_text())
    write_json(file, {**made_with, "versions": {**made_with["versions"], "torch": "1.0"}})
    assert main(words(benchmark, home)) == ExitCode.DONE
    assert ", with torch 1.0 (" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["kernel", "threads", "version", "renderer"])
def test_whatever_else_gives_other_bits_is_named(name, benchmark, home, capsys, monkeypatch):
    flags = {"threads": ("--threads", "2"), "renderer": ("--renderer", "auto")}.get(name, ())
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch" if name == "kernel" else "auto")
    if name == "version":
        monkeypatch.setattr("lcrl_bench.evaluation.identity.__version__", "9.0")
    assert main(words(benchmark, home, *flags)) == ExitCode.USAGE
    differs = {
        "kernel": "differs in kernel (numba then, torch now).",
        "threads": "differs in threads (1 then, 2 now).",
        "version": "then, 9.0 now).",
        "renderer": "differs in renderer (rays then, auto now).",
    }
    shown = capsys.readouterr()
    assert differs[name] in shown.err
    assert shown.out == ""


def test_a_run_of_an_older_version_is_not_trusted(benchmark, home, capsys):
    file = seed0(home) / "config.json"
    config = json.loads(file.read_text())
    del config["made_with"]
    write_json(file, config)
    assert main(words(benchmark, home)) == ExitCode.USAGE
    assert "which an older version did not record. Use --fresh" in capsys.readouterr().err
    assert main(words(benchmark, home, "--fresh")) == ExitCode.DONE


def test_a_model_from_elsewhere_is_not_evaluated(benchmark, home, capsys):
    (seed0(home) / "model" / "config.json").write_text("-1.0")
    assert main(words(benchmark, home)) == ExitCode.RED
    shown = capsys.readouterr()
    assert "not the model that this run trained (config.json)" in shown.err
    assert shown.out == ""
    assert main(words(benchmark, home, "--fresh")) == ExitCode.DONE


def test_a_model_in_an_empty_folder_is_not_evaluated(benchmark, home, capsys):
    shutil.copytree(seed0(home) / "model", seed0(home).with_name("seed1") / "model")
    assert main(words(benchmark, home, "--seeds", "1")) == ExitCode.RED
    assert "the training of the model and results here is unknown" in capsys.readouterr().err


def start(words: list[str], **more: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "lcrl_bench", *words]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=os.environ | more)


def test_of_two_equal_commands_at_once_one_runs(benchmark, tmp_path):
    (tmp_path / "mine.py").write_text(METHOD)
    both = [start(words(benchmark, tmp_path)) for _ in range(2)]
    ends = [(*process.communicate(), process.returncode) for process in both]
    assert {code for *_, code in ends} <= {ExitCode.DONE, ExitCode.ENVIRONMENT}, ends
    ran = [err for _, err, code in ends if code == ExitCode.DONE and "read back" not in err]
    assert len(ran) == 1, ends
    refused = [(out, err) for out, err, code in ends if code == ExitCode.ENVIRONMENT]
    assert all("seed0 is being written by" in err and out == "" for out, err in refused)
    assert not lock_file(seed0(tmp_path)).exists()


def test_a_run_that_was_killed_is_gone_on_with(benchmark, tmp_path, capsys):
    (tmp_path / "mine.py").write_text(METHOD)
    killed = start(words(benchmark, tmp_path), KILL_ME="1")
    killed.communicate()
    assert killed.returncode == -signal.SIGKILL
    assert json.loads(lock_file(seed0(tmp_path)).read_text())["pid"] == killed.pid
    assert main(words(benchmark, tmp_path)) == ExitCode.DONE
    assert "read back" not in capsys.readouterr().err
    assert not lock_file(seed0(tmp_path)).exists()
