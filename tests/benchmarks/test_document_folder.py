"""A benchmark as a folder: lossless, whole or not there, and refused where it is damaged."""

import json
import pickle
import shutil
from dataclasses import replace

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.catalogue import benchmark_folder, list_benchmarks
from lcrl_bench.benchmarks.document import read_benchmark, write_benchmark
from lcrl_bench.benchmarks.folder import read_content
from lcrl_bench.errors import IntegrityError, InvalidFileError, LcrlError, UnknownNameError
from lcrl_bench.houses.document import read_house
from lcrl_bench.semantics import DEFAULT_SEMANTICS


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


@pytest.fixture
def folder(written, tmp_path):
    return shutil.copytree(written, tmp_path / "tiny")


def a_house(folder):
    return min((folder / "houses").iterdir())


def read_benchmark_head(folder):
    return json.loads((folder / "benchmark.json").read_text())


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


def test_a_changed_house_does_not_match_the_fingerprint(folder):
    edit(a_house(folder), lambda house: house["objects"][0].update(yaw=0.125))
    with pytest.raises(IntegrityError, match="expected SHA-256"):
        read_benchmark(folder)


def test_a_changed_grid_does_not_match_the_fingerprint(folder):
    edit(next((folder / "grids").iterdir()), lambda grid: grid["points"][0].__setitem__(0, 0.125))
    with pytest.raises(IntegrityError, match="expected SHA-256"):
        read_benchmark(folder)


def test_files_written_another_way_are_the_same_benchmark(folder):
    for path in folder.rglob("*.json"):
        edit(path, lambda value: None)
    found = read_benchmark(folder)
    assert (found.houses, found.tasks) == (tiny_benchmark().houses, tiny_benchmark().tasks)
    assert found.fingerprint == tiny_benchmark().fingerprint


def test_a_house_is_parsed_on_first_use_and_once(folder, monkeypatch):
    parsed = []

    def read(path):
        parsed.append(path.stem)
        return read_house(path)

    monkeypatch.setattr("lcrl_bench.benchmarks.document.read_house", read)
    benchmark = read_benchmark(folder)
    name = min(benchmark.houses)
    assert len(benchmark.houses) == len(tiny_benchmark().houses)
    assert name in benchmark.houses
    assert parsed == []
    assert benchmark.houses[name] is benchmark.houses[name]
    assert benchmark.grids[name] is benchmark.grids[name]
    assert parsed == [name]
    with pytest.raises(KeyError):
        benchmark.houses["nowhere"]


@pytest.mark.parametrize("part", ["houses", "grids"])
def test_a_file_that_changes_after_opening_is_refused_when_it_is_used(folder, part):
    benchmark = read_benchmark(folder)
    name = min(benchmark.houses)
    other = max(benchmark.houses)
    shutil.copy(folder / part / f"{other}.json", folder / part / f"{name}.json")
    with pytest.raises((IntegrityError, InvalidFileError), match=rf"{name}\.json"):
        getattr(benchmark, part)[name]
    assert getattr(benchmark, part)[other]


def test_a_bad_house_under_a_fingerprint_of_its_own_is_refused_when_it_is_used(folder):
    path = a_house(folder)
    edit(path, lambda house: house["objects"][0].update(label="gadget"))
    head = read_benchmark_head(folder)
    content = read_content(folder, head["houses"])
    assert content is not None
    forged = content.fingerprint(DEFAULT_SEMANTICS, tiny_benchmark().vocabulary)
    edit(folder / "benchmark.json", lambda head: head.update(fingerprint=forged))
    benchmark = read_benchmark(folder)
    with pytest.raises(InvalidFileError, match="'gadget' is not one of the 61 classes"):
        benchmark.houses[path.stem]


def test_a_benchmark_survives_the_way_to_another_process(folder):
    found = pickle.loads(pickle.dumps(read_benchmark(folder)))
    assert (found.houses, found.tasks) == (tiny_benchmark().houses, tiny_benchmark().tasks)
    assert replace(found).fingerprint == tiny_benchmark().fingerprint


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
