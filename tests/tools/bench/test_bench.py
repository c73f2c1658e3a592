"""`lcrl-bench bench`: what is compared does the same work; figures, goals and what is left out."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.cli.bench import Figure
from lcrl_bench.cli.main import main
from lcrl_bench.errors import EnvironmentMissingError, ExitCode
from tools.bench import measures
from tools.bench.memory import measure_memory
from tools.bench.planning import measure_planning
from tools.bench.training import PlainLoop
from tools.bench.whole_runs import EnoughError, Moments, measure_running, measure_table
from tools.speed.comparisons import TrainingStep, embed_distinct
from tools.speed.peers import IMITATION
from tools.speed.timing import difference
from tools.speed.workload import workloads


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tiny benchmark's."""
    path = tmp_path_factory.mktemp("bench") / "tiny"
    write_benchmark(path, tiny_benchmark())
    return path


def test_the_plain_loop_takes_the_step_that_the_suite_takes():
    benchmark = tiny_benchmark()
    (house, *_) = benchmark.houses_of(Split.TRAIN)
    (load,) = workloads(benchmark, [house], device=torch.device("cpu"), renderer="rays")
    first = 0
    for kind, tasks in enumerate(load.prepared.tasks):
        alone = replace(
            load.prepared,
            tasks=(tasks.rows([0]),),
            tokens=load.prepared.tokens[[first]],
            lengths=load.prepared.lengths[[first]],
        )
        single = replace(load, prepared=alone)
        _, gradient = TrainingStep(single, embed_distinct(single))()
        plain = PlainLoop(load).step(kind)
        assert gradient.norm() > 0
        assert difference([gradient], [plain]) < 1e-3
        first += len(tasks)


@pytest.mark.slow
def test_the_planner_agrees_with_imitation():
    try:
        IMITATION.make()
    except EnvironmentMissingError as error:
        pytest.skip(str(error))
    figure = measure_planning(measures.Setting("mini", 1).sets, sample=1)
    assert figure.agrees
    assert figure.value > 0


def test_a_goal_is_a_bound_from_above_or_below():
    speed = Figure("a", "work", "other", 5.0, "x", goal=4.0)
    assert speed.met
    assert not replace(speed, value=3.0).met
    assert replace(speed, value=3.0, at_least=False).met
    assert not replace(speed, at_least=False).met


def test_results_that_are_not_the_same_but_for_rounding_are_an_error(monkeypatch, capsys):
    figure = Figure("planning", "work", "other", 5.0, "x", goal=4.0, difference=0.5)
    monkeypatch.setattr(measures, "MEASURES", {"planning": lambda _: (figure,)})
    assert main(["bench", "--only", "planning"]) == ExitCode.RED
    assert "the results differ by 5.0e-01" in capsys.readouterr().err


def test_a_figure_that_can_not_be_measured_is_left_out_with_the_reason(
    folder, tmp_path, monkeypatch, capsys
):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    words = ["bench", "--benchmark", str(folder), "--houses", "1", "--json"]
    assert main([*words, "--only", "planning", "opening"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    (opening,) = answer["figures"]
    assert (opening["name"], opening["unit"], opening["goal"]) == ("opening", "s", 0.1)
    assert opening["value"] > 0
    assert opening["met"] == (opening["value"] <= 0.1)
    (left_out,) = answer["skipped"]
    assert left_out["name"] == "planning"
    assert "lcrl-bench bench --peers" in left_out["reason"]


def test_memory_is_the_peak_of_a_process_of_its_own(folder):
    figure = measure_memory(str(folder))
    assert (figure.name, figure.unit, figure.at_least) == ("memory", "MB", False)
    assert figure.value > 50
    assert figure.met == (figure.value <= figure.goal)


def test_an_unknown_figure_lists_those_that_there_are(capsys):
    assert main(["bench", "--only", "plannning"]) == ExitCode.USAGE
    assert "Did you mean 'planning'?" in capsys.readouterr().err


def test_what_takes_minutes_is_measured_if_it_is_named(monkeypatch, capsys):
    figure = Figure("running", "work", "", 5.0, "s", goal=12.0, at_least=False)
    monkeypatch.setattr(measures, "MEASURES", {"opening": lambda _: ()})
    monkeypatch.setattr(measures, "LONG", {"running": lambda _: (figure,)})
    assert main(["bench"]) == ExitCode.DONE
    assert "running: not measured: it takes minutes: --only running" in capsys.readouterr().err
    assert main(["bench", "--only", "running"]) == ExitCode.DONE
    assert "≤ 12 s" in capsys.readouterr().out


def test_a_run_beside_its_training_is_measured_in_a_process_of_its_own(
    folder, tmp_path, monkeypatch
):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    assert measure_running(str(folder)).value > 0
    with pytest.raises(EnvironmentMissingError, match="Unknown benchmark 'nowhere'"):
        measure_running("nowhere")


def test_a_training_is_measured_by_its_steps_and_stopped():
    clock = iter(float(second) for second in (5, 6, 8, 20, 20))
    moments = Moments(10.0, lambda: next(clock))
    for step in (1, 2, 4):
        moments.take({"step": step, "steps": 100})
    with pytest.raises(EnoughError):
        moments.take({"step": 5, "steps": 100})
    assert (moments.steps, moments.first, moments.step_s()) == (100, 5.0, 1.0)


def test_a_table_takes_the_time_of_its_runs():
    figure = measure_table(tiny_benchmark(), longest_s=0.1)
    methods = {name: each for name, each in figure.detail.items() if isinstance(each, dict)}
    assert set(methods) == {"lcrl", "gail_exact", "agile", "cloning", "reward_regression"}
    spent = sum(
        each["seeds"] * (each["preparing_s"] + each["training_s"] + figure.detail["evaluating_s"])
        for each in methods.values()
    )
    assert figure.value == pytest.approx(spent / 120)


def test_peers_that_can_not_be_installed_leave_no_environment_behind(tmp_path, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    for variable in ("PIP_INDEX_URL", "PIP_EXTRA_INDEX_URL", "PIP_FIND_LINKS"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    with pytest.raises(EnvironmentMissingError, match=r"imitation==1\.0\.1 can't be installed"):
        IMITATION.make()
    assert not IMITATION.is_ready
    assert not IMITATION.folder.exists()


def test_outside_a_checkout_the_verb_says_what_it_needs(tmp_path):
    script = (
        "import sys\n"
        "from pathlib import Path\n"
        "from lcrl_bench.cli import bench\n"
        "bench.__file__ = sys.argv[1]\n"
        "from lcrl_bench.errors import UsageError\n"
        "try:\n"
        "    bench.main(['--only', 'opening'])\n"
        "except UsageError as error:\n"
        "    print(error)\n"
    )
    place = tmp_path / "lcrl_bench" / "cli" / "bench.py"
    done = subprocess.run(
        [sys.executable, "-c", script, str(place)], capture_output=True, text=True, check=True
    )
    assert "needs a checkout" in done.stdout
