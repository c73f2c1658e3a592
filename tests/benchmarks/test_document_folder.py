"""A benchmark as a folder: lossless, whole or not there, and refused where it is damaged."""

import json
import shutil

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.catalogue import benchmark_folder, list_benchmarks
from lcrl_bench.benchmarks.document import read_benchmark, write_benchmark
from lcrl_bench.errors import IntegrityError, InvalidFileError, LcrlError, UnknownNameError


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


@pytest.fixture
def folder(written, tmp_path):
    return shutil.copytree(written, tmp_path / "tiny")


def edit(path, change):
    value = json.loads(path.read_text())
    change(value)
    path.write_text(json.dumps(value))


def test_writing_and_reading_keeps_every_bit(written):
    found = read_benchmark(written)
    assert found.fingerprint == tiny_benchmark().fingerprint
    assert found.tasks == tiny_benchmark().tasks
    assert found.semantics == tiny_benchmark().semantics


def test_the_same_benchmark_is_the_same_bytes(written, tmp_path):
    write_benchmark(tmp_path / "again", tiny_benchmark())
    for path in sorted(written.rglob("*.json")):
        assert (tmp_path / "again" / path.relative_to(written)).read_bytes() == path.read_bytes()


def test_a_changed_task_does_not_match_the_fingerprint(folder):
    edit(folder / "tasks.json", lambda rows: rows["tasks"][0].update(start_heading=3))
    edit(folder / "tasks.json", lambda rows: rows["tasks"][1].update(start_heading=2))
    with pytest.raises(IntegrityError, match="expected SHA-256"):
        read_benchmark(folder)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda rows: rows["tasks"][0].update(house="nowhere"), "no house 'nowhere'"),
        (lambda rows: rows["tasks"][0].update(start_tile=10**6), "no tile 1000000"),
        (lambda rows: rows["tasks"][0].update(kind="fly"), "tasks.0.kind"),
        (lambda rows: rows["tasks"][-1].update(moved="ghost", kind="pick"), "'ghost'"),
        (lambda rows: rows.update(tasks="all"), "tasks"),
    ],
)
def test_a_task_that_can_not_be_is_named(folder, change, reason):
    edit(folder / "tasks.json", change)
    with pytest.raises(InvalidFileError, match=reason):
        read_benchmark(folder)


def test_a_grid_that_names_a_tile_that_is_not_there_is_refused(folder):
    path = next((folder / "grids").iterdir())
    edit(path, lambda grid: grid["neighbours"][0].__setitem__(0, 10**6))
    with pytest.raises(InvalidFileError, match="a tile or a room that is not there"):
        read_benchmark(folder)


def test_a_house_path_can_not_leave_the_folder(folder):
    edit(folder / "benchmark.json", lambda head: head["houses"].append("../../etc/passwd"))
    with pytest.raises(InvalidFileError, match="houses"):
        read_benchmark(folder)


@pytest.mark.parametrize("name", ["benchmark.json", "tasks.json"])
def test_a_truncated_file_is_named(folder, name):
    path = folder / name
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InvalidFileError, match=name):
        read_benchmark(folder)


def test_a_missing_file_is_named(folder):
    (folder / "tasks.json").unlink()
    with pytest.raises(LcrlError, match=r"tasks\.json"):
        read_benchmark(folder)


def test_a_folder_is_found_by_path_and_a_shipped_one_by_name(folder):
    assert benchmark_folder(str(folder)) == folder
    assert "mini" in list_benchmarks()
    with pytest.raises(UnknownNameError, match=r"'minni'. Did you mean 'mini'\?"):
        benchmark_folder("minni")
