"""The flags that spread jobs: the same results from any number of workers and any parts."""

from __future__ import annotations

import json
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import SEEDS, tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.storage import cache_dir


@pytest.fixture(scope="module")
def houses(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("houses")
    for seed in SEEDS:
        write_house(folder / f"{seed}.json", generate_house(seed, rooms=4))
    return folder


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


def build(houses: Path, out: Path, *words: str) -> int:
    few = ("--name", "tiny", "--nav", "3", "--pick", "2", "--test-houses", "0.34")
    where = ("--houses", str(houses), "--out", str(out), "--renderer", "rays")
    return main(["benchmark", "build", *few, *where, *words])


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def kept() -> set[Path]:
    return {path for path in (cache_dir() / "jobs").rglob("*") if path.is_file()}


def test_parts_build_the_benchmark_that_one_command_builds(houses, tmp_path, capsys):
    before = kept()
    assert build(houses, tmp_path / "whole", "--workers", "2") == ExitCode.DONE
    assert kept() == before, "what the benchmark is made of is not needed any more"
    out = tmp_path / "parts"
    assert build(houses, out, "--workers", "1", "--shard", "1/2") == ExitCode.DONE
    said = capsys.readouterr().err
    assert "part 1 of 2: 1 of 1 jobs are done" in said
    assert "--workers 1 --shard collect   # once all parts are done" in said
    assert build(houses, out, "--shard", "collect") == ExitCode.RED
    assert "failed: procedural-11: not done yet" in capsys.readouterr().err
    assert not out.exists()
    assert build(houses, out, "--workers", "1", "--shard=0/2") == ExitCode.DONE
    assert build(houses, out, "--shard", "collect") == ExitCode.DONE
    assert contents(out) == contents(tmp_path / "whole")
    assert kept() == before


def test_a_check_is_the_same_with_any_number_of_workers(benchmark, capsys):
    answers = []
    for workers in ("1", "2"):
        words = ["--renderer", "rays", "--workers", workers, "--json"]
        assert main(["benchmark", "check", str(benchmark), *words]) == ExitCode.DONE
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0] == answers[1]
    assert answers[0]["checked"] == len(tiny_benchmark().tasks)


def test_houses_imported_in_parts_are_those_imported_at_once(houses, tmp_path, capsys):
    def imported(out: Path, *words: str) -> list[dict]:
        files = [str(houses), str(tmp_path / "absent.json")]
        code = main(["house", "import", *files, "--out", str(out), "--json", *words])
        said = capsys.readouterr().out
        assert code == (ExitCode.RED if said else ExitCode.DONE)
        return json.loads(said.replace(str(out), "OUT"))["houses"] if said else []

    whole = imported(tmp_path / "whole", "--workers", "2")
    for part in ("0/2", "1/2"):
        assert imported(tmp_path / "parts", "--workers", "1", "--shard", part) == []
    assert imported(tmp_path / "parts", "--shard", "collect") == whole
    assert [bool(row["errors"]) for row in whole] == [False, False, False, True]
    assert contents(tmp_path / "parts") == contents(tmp_path / "whole")


def test_seeds_run_apart_give_what_they_give_one_after_the_other(benchmark, tmp_path, capsys):
    def run(out: str, *words: str) -> int:
        where = ("--benchmark", str(benchmark), "--out", str(tmp_path / out), "--no-record")
        method = f"{noise_method.__file__}:NoiseMethod"
        base = ("run", "--method", method, *where, "--renderer", "rays", "--json")
        return main([*base, "--seeds", "0", "1", *words])

    answers = []
    for out, *words in (("one",), ("apart", "--workers", "2")):
        assert run(out, *words) == ExitCode.DONE
        answers.append(json.loads(capsys.readouterr().out))
    for answer in answers:
        for key in ("wall_s", "read_back"):
            del answer[key]
    assert answers[0] == answers[1]
    assert run("parts", "--shard", "0/2") == ExitCode.DONE
    assert run("parts", "--shard", "collect") == ExitCode.RED
    assert "noise_method/seed1: not done yet" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--shard", "2/2"), "--shard 2/2: write i/n"),
        (("--workers", "-1"), "--workers -1"),
        (("--cluster", "cloud"), "--cluster cloud: name one of local, ray, slurm"),
        (("--cluster", "ray", "--cluster-options", "gpus"), "takes key=value, found 'gpus'"),
    ],
)
def test_a_flag_that_makes_no_sense_is_named(words, said, houses, tmp_path, capsys):
    assert build(houses, tmp_path / "out", *words) == ExitCode.USAGE
    assert said in capsys.readouterr().err
