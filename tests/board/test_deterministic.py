"""A method that draws nothing: one seed stands for all, and only training shows that it is one."""

from __future__ import annotations

from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark, tiny_session
from board_samples import benchmark_of

from lcrl_bench.board.admission import read_submission
from lcrl_bench.board.collection import Statement, collect, seed_folders
from lcrl_bench.board.document import Submission
from lcrl_bench.board.entries import read_collection
from lcrl_bench.board.table_rows import table_rows
from lcrl_bench.board.verdict import Verification, verification_file
from lcrl_bench.board.verification import Claim, verify
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.run import RunSpec, run
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.storage import write_json

METHODS = Path(__file__).parents[1] / "still_method.py"


def runs(home: Path, name: str, seeds: int = 3) -> tuple[Path, ...]:
    """Finished runs of a method of `still_method.py`."""
    session = tiny_session(home / "runs")
    for seed in range(seeds):
        run(RunSpec(f"{METHODS}:{name}", seed), session)
    return seed_folders([home / "runs" / "tiny" / "still_method"])


def submitted(home: Path, folders: tuple[Path, ...], **said: bool) -> tuple[Path, Submission]:
    file = home / "leaderboard" / "submissions" / "tiny-still.json"
    submission = collect(folders, tiny_benchmark(), Statement(**said), out=file)
    write_json(file, submission.model_dump(mode="json"))
    return file, submission


def verified(file: Path, name: str, *, training: Path | None = None) -> Verification:
    method = resolve_method(f"{METHODS}:{name}")
    claim = Claim(read_submission(file), file, method, retrain=training is not None)
    found = verify(claim, tiny_session(training or file.parent / "nowhere"))
    write_json(verification_file(file), found.model_dump(mode="json"))
    return found


def test_one_seed_stands_for_all_in_seeds_figures_and_intervals(tmp_path):
    folders = runs(tmp_path, "StillMethod")
    _, submission = submitted(tmp_path, folders)
    assert submission.deterministic
    assert [row.seed for row in submission.seeds] == [0]
    _, alone = submitted(tmp_path, folders[:1])
    assert alone == submission


def test_its_copies_are_refused_if_they_are_written_as_seeds(tmp_path):
    file, submission = submitted(tmp_path, runs(tmp_path, "StillMethod"))
    document = submission.model_dump(mode="json")
    document["seeds"] = [{**document["seeds"][0], "seed": seed} for seed in range(3)]
    write_json(file, document)
    with pytest.raises(InvalidFileError, match="one counts for all"):
        read_submission(file)


def test_it_is_verified_once_a_training_showed_it(tmp_path):
    file, _ = submitted(tmp_path, runs(tmp_path, "StillMethod"))

    def line():
        (board,) = read_collection(file.parent, benchmark_of).boards
        return next(line for line in table_rows(board) if line.entry is not None)

    assert verified(file, "StillMethod").verdict == "verified"
    assert "deterministic" in line().tags
    assert line().mark == "unverified"
    assert verified(file, "StillMethod", training=tmp_path / "again").verdict == "verified"
    assert line().mark == "verified"


def test_a_method_that_looks_at_its_seed_is_not_one(tmp_path):
    folders = runs(tmp_path, "SecretMethod")
    _, submission = submitted(tmp_path, folders)
    assert not submission.deterministic
    # Its best seed alone, as if it stood for all.
    file, _ = submitted(tmp_path, folders[1:2])
    found = verified(file, "SecretMethod", training=tmp_path / "again")
    assert found.verdict == "disputed"
    assert found.differences[0].where.startswith("deterministic")


def test_a_method_that_draws_needs_its_seeds(tmp_path, repository):
    method = f"{repository}/tests/noise_method.py:NoiseMethod"
    folder = run(RunSpec(method), tiny_session(tmp_path / "runs")).folder
    assert folder.summary()["deterministic"] is False
    with pytest.raises(UsageError, match="1 of 3 seeds"):
        submitted(tmp_path, (folder.path,))
