"""`python -m tools.speed --environments` on a tiny benchmark: what is measured, not how fast."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import run_command
from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.errors import EnvironmentMissingError, ExitCode
from tools.speed import environments, stepping
from tools.speed.command import PROGRAM, main
from tools.speed.environments import Stepping, times_faster
from tools.speed.peers import MINIGRID


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tiny benchmark's."""
    path = tmp_path_factory.mktemp("bench") / "tiny"
    write_benchmark(path, tiny_benchmark())
    return path


def words(folder: Path, *flags: str) -> list[str]:
    """The shortest measurement there is."""
    shortest = ["--environments", "--seconds", "0"]
    return ["--benchmark", str(folder), "--renderer", "rays", *shortest, *flags]


def test_opening_memory_and_steps_are_measured(folder, monkeypatch, capsys):
    monkeypatch.setattr(environments, "COUNTS", (16,))
    assert main(words(folder, "--json")) == ExitCode.DONE
    (found,) = json.loads(capsys.readouterr().out)["environments"]
    assert (found["environment"], found["environments"]) == (HOUSE_ID, 16)
    assert found["opening"] > 0
    assert found["used"] >= found["opened"] >= 0
    assert found["steps"] >= found["median"] > 0
    assert found["times"] == {}


@pytest.mark.parametrize("count", [0, 3])
def test_a_job_steps_through_ends_of_episodes(folder, count):
    outcome = stepping.measure(
        {
            "modules": ["lcrl_bench.envs"],
            "id": HOUSE_ID,
            "environments": count,
            "arguments": {"benchmark": str(folder), "renderer": "rays"},
            "warm_up": 5,
            "seconds": 0,
        }
    )
    assert outcome["steps"] == outcome["median"] > 0


def test_only_as_many_at_once_are_compared():
    ours = Stepping(HOUSE_ID, 16, 0, 0, 0, 600.0, 500.0)
    theirs = [Stepping("other", count, 0, 0, 0, 10.0 + count, 9.0) for count in (0, 16)]
    assert times_faster(ours, (ours, *theirs)) == {"other": 600 / 26}


@pytest.fixture
def without_packages(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Nothing that pip could find, and an empty cache folder."""
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    for variable in ("PIP_INDEX_URL", "PIP_EXTRA_INDEX_URL", "PIP_FIND_LINKS"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PIP_NO_INDEX", "1")


@pytest.mark.usefixtures("without_packages")
def test_where_minigrid_can_not_be_installed_the_error_says_why(folder, capsys):
    command = words(folder, "--minigrid")
    assert run_command(main, command, program=PROGRAM) == ExitCode.ENVIRONMENT
    said = capsys.readouterr().err
    assert "minigrid==3.2.0 can't be installed (ERROR: No matching distribution" in said
    assert "measure without it" in said


def test_minigrid_alone_is_no_measurement(folder, capsys):
    command = ["--benchmark", str(folder), "--minigrid"]
    assert run_command(main, command, program=PROGRAM) == ExitCode.USAGE
    assert "--minigrid needs --environments" in capsys.readouterr().err


@pytest.mark.slow
def test_minigrid_is_measured_beside_it(folder, capsys):
    try:
        MINIGRID.make()
    except EnvironmentMissingError as error:
        pytest.skip(str(error))
    assert main(words(folder, "--minigrid", "--json")) == ExitCode.DONE
    found = json.loads(capsys.readouterr().out)["environments"]
    assert len(found) == 9
    for each in found[:3]:
        assert len(each["times"]) == 2
