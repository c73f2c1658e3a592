"""The house sources, and files recognised by what they hold."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import house_samples
import procthor_samples
import pytest

from lcrl_bench.errors import DuplicateNameError, InvalidFileError, UnknownNameError, UsageError
from lcrl_bench.houses import sources
from lcrl_bench.houses.document import import_lcrl, write_house
from lcrl_bench.houses.procthor import import_procthor
from lcrl_bench.houses.sources import detect_source, house_sources, import_house


@pytest.fixture
def lcrl_file(tmp_path: Path) -> Path:
    write_house(tmp_path / "ours.json", house_samples.two_rooms())
    return tmp_path / "ours.json"


@pytest.fixture
def procthor_file(tmp_path: Path) -> Path:
    return procthor_samples.write(procthor_samples.two_rooms(), tmp_path, "theirs.json")


def test_the_sources_are_known_by_name():
    assert [entry.name for entry in house_sources()] == ["lcrl", "procedural", "procthor"]
    assert house_sources().get("procthor") is import_procthor
    assert house_sources().get("lcrl") is import_lcrl


def test_every_importer_has_a_format_that_messages_list():
    assert {entry.name for entry in house_sources()} - {sources.PROCEDURAL} == set(sources.FORMATS)


def test_listing_the_sources_imports_no_schema():
    code = (
        "import sys; from lcrl_bench.houses.sources import house_sources; list(house_sources());"
        "print([m for m in ('pydantic', 'numpy', 'shapely', 'torch') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_a_file_is_recognised_by_its_content_and_not_its_name(
    tmp_path: Path, lcrl_file: Path, procthor_file: Path
):
    lcrl_file.rename(tmp_path / "procthor.json")
    procthor_file.rename(tmp_path / "lcrl.txt")
    assert detect_source(tmp_path / "procthor.json") == "lcrl"
    assert detect_source(tmp_path / "lcrl.txt") == "procthor"


def test_a_file_is_imported_by_the_source_that_knows_it(lcrl_file: Path, procthor_file: Path):
    assert import_house(lcrl_file).house == house_samples.two_rooms()
    assert import_house(procthor_file) == import_procthor(procthor_file)
    assert import_house(procthor_file, source="procthor") == import_procthor(procthor_file)


def test_what_was_imported_imports_again_as_our_own_losslessly(tmp_path: Path, procthor_file: Path):
    house = import_house(procthor_file).house
    write_house(tmp_path / "copy.json", house)
    assert import_house(tmp_path / "copy.json").house == house


@pytest.mark.parametrize(
    ("value", "found"),
    [
        ({"scene": 1, "furniture": []}, r"keys \['furniture', 'scene'\]"),
        ({"format": "glTF"}, r"keys \['format'\]"),
        ({"format": ["lcrl-house"]}, r"keys \['format'\]"),
        ({"rooms": [], "walls": []}, r"keys \['rooms', 'walls'\]"),
        ({}, "empty object"),
        ([], "a list"),
        (None, "a null"),
        (3, "a number or truth value"),
        ("house", "a string"),
    ],
)
def test_an_unknown_file_is_refused_with_the_formats_there_are(
    tmp_path: Path, value: object, found: str
):
    path = tmp_path / "house.json"
    path.write_text(json.dumps(value))
    with pytest.raises(InvalidFileError, match=f"not a house in a known format.*{found}") as caught:
        import_house(path)
    assert all(line in str(caught.value) for line in sources.FORMATS.values())


def test_a_file_read_as_the_wrong_source_is_refused(lcrl_file: Path, procthor_file: Path):
    with pytest.raises(InvalidFileError, match="not a House JSON"):
        import_house(procthor_file, source="lcrl")
    with pytest.raises(InvalidFileError, match="not a ProcTHOR house"):
        import_house(lcrl_file, source="procthor")


def test_a_source_that_reads_no_files_and_one_there_is_not(lcrl_file: Path):
    with pytest.raises(UsageError, match="generates houses"):
        import_house(lcrl_file, source="procedural")
    with pytest.raises(UnknownNameError, match="Did you mean 'procthor'"):
        import_house(lcrl_file, source="prochtor")


def test_another_package_adds_a_source_by_an_entry_point(
    monkeypatch: pytest.MonkeyPatch, lcrl_file: Path
):
    target = "lcrl_bench.houses.document:import_lcrl"

    def entry_points(*, group: str) -> list[EntryPoint]:
        return [EntryPoint("outside", target, group)]

    monkeypatch.setattr(sources, "entry_points", entry_points)
    assert "outside" in house_sources()
    assert import_house(lcrl_file, source="outside").house == house_samples.two_rooms()
    monkeypatch.setattr(
        sources, "entry_points", lambda *, group: [EntryPoint("lcrl", target, group)]
    )
    with pytest.raises(DuplicateNameError):
        house_sources()
