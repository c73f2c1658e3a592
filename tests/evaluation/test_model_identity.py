"""A model is believed where its own training left it, and nowhere else."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.finished_runs import read_run
from lcrl_bench.evaluation.model_identity import check_model, model_digest, save_model
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.storage import write_json


def saving(model: bytes) -> Callable[[Path], None]:
    """What writes a model of one file."""

    def save(folder: Path) -> None:
        folder.mkdir()
        (folder / "w.bin").write_bytes(model)

    return save


def write_run(folder: Path, seed: int, *, model: bytes = b"weights") -> Path:
    """A finished run of three files."""
    config = {"method": "lcrl", "settings": {}, "seed": seed}
    write_json(folder / "config.json", config)
    save_model(folder, saving(model), config)
    RunFolder(folder).finish({"splits": {"train": seed}})
    return folder


def test_a_model_where_it_was_trained_is_believed(tmp_path):
    run = write_run(tmp_path / "seed0", 0)
    assert list(check_model(run).files) == ["w.bin"]
    assert RunFolder(run).summary()["model"] == model_digest(run)
    assert sorted(path.name for path in run.iterdir()) == [
        "DONE",
        "config.json",
        "model",
        "model.json",
        "summary.json",
    ]


@pytest.mark.parametrize(
    ("copied", "reason"),
    [
        (("model",), r"not the model that this run trained \(w\.bin\)"),
        (("model", "model.json"), "the model is from another training than the one"),
        (("model.json",), "the model is from another training than the one"),
    ],
)
def test_a_model_copied_from_another_run_is_refused(copied, reason, tmp_path):
    run, other = write_run(tmp_path / "a", 0), write_run(tmp_path / "b", 1, model=b"others")
    for name in copied:
        if (other / name).is_dir():
            shutil.copytree(other / name, run / name, dirs_exist_ok=True)
        else:
            shutil.copy(other / name, run / name)
    with pytest.raises(InvalidFileError, match=reason):
        check_model(run)
    with pytest.raises(InvalidFileError, match=reason):
        read_run(run)
    with pytest.raises(InvalidFileError, match=reason):
        RunFolder(run).summary()


def test_a_file_more_or_less_is_noticed(tmp_path):
    run = write_run(tmp_path / "seed0", 0)
    (run / "model" / "more.bin").write_bytes(b"")
    with pytest.raises(InvalidFileError, match=r"trained \(more\.bin\).*--fresh"):
        check_model(run)
    shutil.rmtree(run / "model")
    with pytest.raises(InvalidFileError, match=r"trained \(w\.bin\)"):
        check_model(run)


def test_a_model_that_does_not_say_whose_it_is_is_refused(tmp_path):
    run = write_run(tmp_path / "seed0", 0)
    (run / "model.json").write_text("{}")
    with pytest.raises(InvalidFileError, match="not the identity of a model"):
        read_run(run)
    (run / "model.json").unlink()
    with pytest.raises(InvalidFileError, match=r"nothing says which training made .*--fresh"):
        read_run(run)


def test_a_summary_is_of_the_model_and_the_episodes_beside_it(tmp_path):
    run = write_run(tmp_path / "seed0", 0)
    config = json.loads((run / "config.json").read_text())
    shutil.rmtree(run / "model")
    save_model(run, saving(b"trained again"), config)
    with pytest.raises(InvalidFileError, match="does not match the model next to it"):
        RunFolder(run).summary()
    run = write_run(tmp_path / "seed1", 1)
    (run / "episodes.parquet").write_bytes(b"of another run")
    with pytest.raises(InvalidFileError, match="does not match the episodes next to it"):
        RunFolder(run).summary()


def test_a_model_is_there_whole_or_not_at_all(tmp_path):
    def killed(place: Path) -> None:
        saving(b"half")(place)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        save_model(tmp_path, killed, {})
    assert not (tmp_path / "model").exists()
    save_model(tmp_path, saving(b"whole"), {})
    assert (tmp_path / "model" / "w.bin").read_bytes() == b"whole"
    assert not (tmp_path / "model.part").exists()
