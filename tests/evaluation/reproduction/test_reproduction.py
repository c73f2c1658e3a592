"""From runs to a published table, on a tiny benchmark."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.fan_out import FanOut
from lcrl_bench.cli.main import main
from lcrl_bench.cli.reproduce import ReproduceFlags, reproduce, reproduce_part
from lcrl_bench.errors import ExitCode, NothingSelectedError
from lcrl_bench.evaluation.finished_runs import is_done
from lcrl_bench.evaluation.reproduction.experiments import (
    CONTROLS,
    EVERY_COLUMN,
    Claim,
    Experiment,
    Row,
)
from lcrl_bench.evaluation.reproduction.publication import read_table
from lcrl_bench.evaluation.run import RunSpec

NOISE = f"{noise_method.__file__}:NoiseMethod"
LITTLE = {"passes": "1", "least_steps": "1"}
SEEDS = (0, 1)
RUNS = 2 * len(SEEDS) + len(CONTROLS)


def experiment(**noise: str) -> Experiment:
    return Experiment(
        name="table-1",
        title="A table",
        rows=(
            Row("LC-RL", RunSpec.of("lcrl", LITTLE), "LC-RL (ours)"),
            Row("noise", RunSpec.of(NOISE, noise), "AGILE"),
            *CONTROLS,
        ),
        columns=EVERY_COLUMN,
        claims=(
            Claim("anything is worse", "optimal policy", "noise", "train.total"),
            Claim("noise is best", "noise", "optimal policy", "train.total"),
            Claim("learning beats noise", "LC-RL", "noise", "test-house.total"),
        ),
        language=True,
    )


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


def flags(benchmark: Path, folder: Path, *, jobs: int = 1) -> ReproduceFlags:
    return ReproduceFlags(
        table="table-1",
        benchmark=str(benchmark),
        fan_out=FanOut(workers=jobs),
        out=folder / "runs",
        results=folder / "results",
        device="cpu",
        renderer="rays",
    )


@pytest.fixture(scope="module")
def finished(benchmark, tmp_path_factory):
    """Two methods and the controls, two seeds, one process after all: (folder, answer)."""
    folder = tmp_path_factory.mktemp("finished")
    answer, _ = reproduce(flags(benchmark, folder), [experiment()], seeds=SEEDS, budget=None)
    return folder, answer


def timeless(page: Path) -> dict:
    table = json.loads(page.with_suffix(".json").read_text())
    for row in table["rows"]:
        del row["wall_s"]
    return table


def test_every_run_is_made_once_and_the_table_is_complete(finished):
    _, answer = finished
    assert answer["failed"] == {}
    assert answer["done"] == RUNS
    assert not list((finished[0] / "runs").rglob("checkpoint")), "a finished run needs none"
    table = read_table(Path(answer["tables"]["table-1"]["json"]))
    assert table.complete
    assert table.fingerprint == tiny_benchmark().fingerprint
    assert [row.seeds for row in table.rows] == [(0, 1), (0, 1), *[(0,)] * len(CONTROLS)]
    optimal = table.rows[-1].figures["train.total"]
    assert (optimal.mean, optimal.low, optimal.high) == (100, 100, 100)
    assert table.rows[0].figures["train.total"].paper == 66.9
    assert set(table.rows[1].language["train"]) >= {"own", "blank", "shuffled"}
    noise = table.rows[1].language["train"]
    assert noise["blank"] == pytest.approx(noise["own"], abs=0.01), "noise does not listen"


def test_a_figure_is_the_mean_of_the_summaries(finished):
    folder, answer = finished
    table = read_table(Path(answer["tables"]["table-1"]["json"]))
    for column in EVERY_COLUMN:
        split, kind = column.split(".")
        found = [
            json.loads(path.read_text())["splits"][split][kind]
            for path in (folder / "runs" / "tiny").glob("lcrl-*/seed*/summary.json")
        ]
        assert len(found) == len(SEEDS)
        figure = table.rows[0].figures[column]
        assert (figure is None) == (None in found)
        if figure is not None:
            assert figure.mean == pytest.approx(sum(found) / len(found), abs=0.01)
            assert figure.low <= figure.mean <= figure.high


def test_claims_are_judged_by_the_interval_of_the_difference(finished):
    table = read_table(Path(finished[1]["tables"]["table-1"]["json"]))
    first, second, third = table.claims
    assert first.verdict == "holds"
    assert second.verdict == "does not hold"
    assert second.mean == -first.mean
    assert third.paper == pytest.approx(36.4 - 15.1)


def test_the_page_has_ours_beside_the_paper_s(finished):
    page = Path(finished[1]["tables"]["table-1"]["page"]).read_text()
    assert "| PICK | NAV | total |" in page
    for split in ("train", "test-task", "test-house"):
        assert f"## {split}\n" in page
    lines = page.split("## test-house")[1].splitlines()
    line = next(line for line in lines if line.startswith("| LC-RL |"))
    assert "\\| 36.4" in line
    assert "Reproduce it with `lcrl-bench reproduce table-1 --benchmark tiny" in page
    assert str(finished[0]) not in page


def test_less_than_the_full_table_is_written_beside_it(finished):
    names = {path.name for path in (finished[0] / "results").iterdir()}
    assert names == {
        "README.md",
        "notes.md",
        "table-1-tiny-seeds-0-1.md",
        "table-1-tiny-seeds-0-1.json",
        "table-1-tiny-seeds-0-1.svg",
    }


def test_a_table_is_written_again_from_finished_runs_to_the_same_bytes(finished, benchmark):
    folder, _ = finished
    results = folder / "results"
    (results / "notes.md").write_text("by hand")
    before = {path.name: path.read_bytes() for path in results.iterdir()}
    again = replace(flags(benchmark, folder), no_train=True)
    answer, _ = reproduce(again, [experiment()], seeds=SEEDS, budget=None)
    assert answer["done"] == 0
    assert {path.name: path.read_bytes() for path in results.iterdir()} == before


def test_two_processes_give_what_one_gives_even_after_a_kill(finished, benchmark, tmp_path):
    fatal = tmp_path / "fatal"
    fatal.touch()
    table = experiment(dies_once=str(fatal))
    words = flags(benchmark, tmp_path, jobs=2)
    answer, documents = reproduce(words, [table], seeds=SEEDS, budget=None)
    assert not fatal.exists(), "a worker was killed"
    assert (answer["done"], answer["failed"]) == (RUNS, {})
    assert documents["table-1"].complete
    for metrics in (tmp_path / "runs" / "tiny").glob("noise*/*/metrics.jsonl"):
        assert [json.loads(x)["step"] for x in metrics.read_text().splitlines()] == [1, 2, 3, 4]

    ours, theirs = (
        timeless(Path(found["tables"]["table-1"]["page"])) for found in (answer, finished[1])
    )
    for document in (ours, theirs):
        del document["rows"][1]["settings"]
    assert ours == theirs


def test_shards_give_what_one_command_gives(finished, benchmark, tmp_path):
    table = replace(experiment(), rows=(experiment().rows[1], *CONTROLS), claims=())
    parts = [
        replace(flags(benchmark, tmp_path), fan_out=FanOut(workers=1, shard=text))
        for text in ("0/2", "1/2", "collect")
    ]
    first = reproduce_part(parts[0], [table], seeds=SEEDS, budget=None)
    assert {each.key for each in first.ended} >= {"noise_method/seed0"}
    early, _ = reproduce(parts[2], [table], seeds=SEEDS, budget=None)
    assert set(early["failed"].values()) == {"not done yet"}
    second = reproduce_part(parts[1], [table], seeds=SEEDS, budget=None)
    assert len(first.ended) + len(second.ended) == len(SEEDS) + len(CONTROLS)
    answer, documents = reproduce(parts[2], [table], seeds=SEEDS, budget=None)
    assert (answer["done"], answer["failed"]) == (0, {})
    assert documents["table-1"].complete
    for kept in ("config.json", "summary.json", "episodes.parquet"):
        for file in (tmp_path / "runs" / "tiny").glob(f"noise*/seed*/{kept}"):
            of_one = finished[0] / "runs" / "tiny" / file.parent.relative_to(tmp_path / "runs/tiny")
            assert timed(file) == timed(of_one / kept)


def timed(file: Path) -> object:
    """The content of a file, without the time that it took."""
    if file.suffix != ".json":
        return file.read_bytes()
    return {key: value for key, value in json.loads(file.read_text()).items() if key != "wall_s"}


def test_a_method_that_fails_spoils_no_other_row(finished, benchmark, tmp_path):
    words = replace(flags(benchmark, tmp_path), out=finished[0] / "runs")
    table = experiment(fails="true")
    answer, documents = reproduce(words, [table], seeds=(0,), budget=None)
    ((key, reason),) = answer["failed"].items()
    assert "ZeroDivisionError: noise over nothing" in reason
    log = finished[0] / "runs" / "tiny" / key / "failure.log"
    assert "noise_method.py" in log.read_text()
    noise = documents["table-1"].rows[1]
    assert (noise.seeds, noise.missing) == ((), (0,))
    assert documents["table-1"].rows[0].seeds == (0,)
    assert documents["table-1"].claims[0].mean is None


def test_without_any_finished_run_there_is_no_table(benchmark, tmp_path):
    words = replace(flags(benchmark, tmp_path), no_train=True)
    with pytest.raises(NothingSelectedError, match="--no-train"):
        reproduce(words, [experiment()], seeds=SEEDS, budget=None)
    assert not (tmp_path / "results").exists()


def test_a_run_of_other_settings_does_not_pass_for_this_one(finished):
    first, third = RunSpec.of("lcrl", LITTLE), RunSpec.of("lcrl", LITTLE, seed=2)
    runs = finished[0] / "runs"
    assert is_done(first, runs, tiny_benchmark())
    assert not is_done(third, runs, tiny_benchmark())
    other = RunSpec.of("lcrl", {**LITTLE, "passes": "2"})
    assert not is_done(other, runs, tiny_benchmark())
    config = runs / "tiny" / first.key / "config.json"
    assert json.loads(config.read_text())["resolved"]["learning_rate"] > 0, "defaults count too"
    changed = replace(tiny_benchmark(), tasks=tiny_benchmark().tasks[1:])
    assert not is_done(first, runs, changed)


def test_the_language_table_has_the_tasks_own_command_first_and_others_by_name(finished):
    page = Path(finished[1]["tables"]["table-1"]["page"]).read_text()
    commands = "own | blank | paraphrase | shuffled | wrong-target"
    for split in ("train", "test-task", "test-house"):
        assert f"| {split} | {commands} |" in page


def test_a_run_s_folder_is_the_one_of_the_verb_run(finished, benchmark, capsys):
    row = experiment().rows[0]
    out = finished[0] / "runs"
    words = ["run", "--method", "lcrl", "--benchmark", str(benchmark), "--out", str(out)]
    words += ["--set", *(f"{key}={value}" for key, value in LITTLE.items())]
    assert main([*words, "--renderer", "rays", "--no-record"]) == ExitCode.DONE
    folder = row.specs((0,), None)[0].folder(out, tiny_benchmark())
    assert f"seed 0: read back from {folder.path} (" in capsys.readouterr().err
