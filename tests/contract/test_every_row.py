"""The contract, over every row of the leaderboard that is in the repository."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.board.checkpoints import checkpoint_folder, listed_files
from lcrl_bench.board.entries import Entry, read_collection
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.evaluation.reproduction.experiments import TABLE_1

ROOT = Path(__file__).parents[2]
ROWS = ROOT / "leaderboard" / "submissions"


@pytest.fixture(scope="module")
def entries() -> tuple[Entry, ...]:
    """Every row, none of them refused."""
    collection = read_collection(ROWS, lambda name: read_benchmark(benchmark_folder(name)))
    assert collection.refused == ()
    return tuple(entry for board in collection.boards for entry in board.entries)


def test_every_method_of_the_paper_has_a_verified_row_on_lcrl_v1(entries):
    assert {entry.mark for entry in entries} == {"verified"}
    rows = {each.submission.method for each in entries if each.submission.benchmark == "lcrl-v1"}
    assert {row.run.method for row in TABLE_1.rows if not row.control} <= rows


def test_the_checkpoints_of_every_row_are_the_submitted_ones(entries):
    for entry in entries:
        file = ROWS / f"{entry.stem}.json"
        for seed in entry.submission.seeds:
            folder = checkpoint_folder(entry.submission, seed, file=file, runs=None)
            found = [asdict(file) for file in listed_files(folder)]
            assert found == [each.model_dump() for each in seed.files], entry.stem


def test_a_row_and_the_published_table_say_the_same(entries):
    table = json.loads((ROOT / "docs/results/table-1.json").read_text("utf-8"))
    published = {(row["method"], row["preset"]): row for row in table["rows"]}
    compared = 0
    for entry in entries:
        row = published[entry.submission.method, entry.submission.preset]
        for split, by_kind in entry.submission.figures.items():
            for kind, figure in by_kind.items():
                said = row["figures"][f"{split.value}.{kind}"]
                assert figure is not None
                for end in ("mean", "low", "high"):
                    assert getattr(figure, end) == pytest.approx(said[end], abs=0.0002)
                compared += 1
    assert compared == 9 * len(entries)


@pytest.mark.slow
def test_a_row_is_verified_again(tmp_path):
    for file in (ROWS / "lcrl-v1-lcrl-paper.json", ROWS / "lcrl-v1-lcrl-paper.verified.json"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    row, runs = tmp_path / "lcrl-v1-lcrl-paper.json", ROOT / "leaderboard" / "checkpoints"
    words = ("leaderboard", "verify", str(row), "--no-record")
    assert main([*words, "--runs", str(runs / "lcrl-v1-lcrl-paper")]) == ExitCode.DONE
