"""A table is made of runs of the code that is there now, and says what it leaves out."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.reproduce import ReproduceFlags, reproduce
from lcrl_bench.errors import FolderInUseError, InvalidFileError, UsageError
from lcrl_bench.evaluation.finished_runs import changes, is_done
from lcrl_bench.evaluation.folder_lock import locked
from lcrl_bench.evaluation.reproduction.experiments import EVERY_COLUMN, Experiment, Row
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.run_jobs import SessionSpec, make_run
from lcrl_bench.jobs.job import untold


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


@pytest.fixture
def home(tmp_path) -> Path:
    """A folder with a method's file, which is edited in these tests."""
    shutil.copy(noise_method.__file__, tmp_path / "noise.py")
    return tmp_path


def edit(home: Path) -> None:
    with (home / "noise.py").open("a") as file:
        file.write("# edited\n")


def do(home: Path, benchmark: Path, spec: RunSpec, *, fresh: bool = False) -> None:
    """What a worker does of a run."""
    place = {"out": str(home / "runs"), "device": "cpu", "renderer": "rays", "fresh": fresh}
    make_run(spec, SessionSpec(str(benchmark), **place).open(), untold, any_computer=True)


def noise(home: Path) -> RunSpec:
    return RunSpec(f"{home / 'noise.py'}:NoiseMethod")


def test_a_run_of_other_code_is_refused_and_set_aside_by_fresh(home, benchmark, monkeypatch):
    spec, runs = noise(home), home / "runs"
    do(home, benchmark, noise(home))
    assert is_done(spec, runs, tiny_benchmark())
    edit(home)
    assert not is_done(spec, runs, tiny_benchmark())
    assert changes(spec, runs, tiny_benchmark()) == ("the method's noise.py (edited since)",)
    with pytest.raises(UsageError, match=r"differs in the method's noise\.py .*--fresh"):
        do(home, benchmark, noise(home))
    do(home, benchmark, noise(home), fresh=True)
    assert is_done(spec, runs, tiny_benchmark())
    assert (spec.folder(runs, tiny_benchmark()).path.with_name("seed0.old1") / "DONE").exists()


def test_a_control_of_another_version_is_run_again(home, benchmark, monkeypatch):
    control = RunSpec("random", control=True)
    do(home, benchmark, control)
    assert is_done(control, home / "runs", tiny_benchmark())
    monkeypatch.setattr("lcrl_bench.evaluation.identity.__version__", "9.0")
    assert not is_done(control, home / "runs", tiny_benchmark())
    with pytest.raises(UsageError, match=r"9\.0 now"):
        do(home, benchmark, control)


def test_figures_of_another_kernel_stand(home, benchmark, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
    do(home, benchmark, noise(home))
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "auto")
    assert is_done(noise(home), home / "runs", tiny_benchmark())
    do(home, benchmark, noise(home))


def test_a_model_from_elsewhere_is_no_finished_run(home, benchmark):
    do(home, benchmark, noise(home))
    folder = noise(home).folder(home / "runs", tiny_benchmark())
    (folder.model / "config.json").write_text("[]")
    assert not is_done(noise(home), home / "runs", tiny_benchmark())
    with pytest.raises(InvalidFileError, match=r"not the model that this run trained"):
        do(home, benchmark, noise(home))


def test_a_run_that_another_process_writes_is_left_alone(home, benchmark):
    folder = noise(home).folder(home / "runs", tiny_benchmark())
    with locked(folder.path), pytest.raises(FolderInUseError, match="is being written by"):
        do(home, benchmark, noise(home))
    assert not folder.path.exists()


def test_a_table_names_what_it_leaves_out_and_what_it_reads_back(home, benchmark, capsys):
    other = RunSpec(f"{home / 'other.py'}:NoiseMethod")
    shutil.copy(home / "noise.py", home / "other.py")
    for spec in (noise(home), other):
        do(home, benchmark, spec)
    edit(home)
    rows = Row("noise", noise(home)), Row("the same", other)
    table = Experiment("table-1", "A table", rows=rows, columns=EVERY_COLUMN, claims=())
    words = ReproduceFlags("table-1", benchmark=str(benchmark), out=home / "runs")
    words = replace(words, results=home / "results", no_train=True)
    answer, documents = reproduce(words, [table], seeds=(0,), budget=None)
    assert [row.seeds for row in documents["table-1"].rows] == [(), (0,)]
    said = capsys.readouterr().err
    assert f"read back from {home / 'runs'}: 1 runs, finished 2" in said.replace(
        "1 run,", "1 runs,"
    )
    assert "left out: noise/seed0: another run, which differs in the method's noise.py" in said
    assert list(answer["read_back"]) == ["other/seed0"]
    assert answer["changed"] == {"noise/seed0": ["the method's noise.py (edited since)"]}
