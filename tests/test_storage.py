"""Files: what is refused unread or half-read, and what a reader of a written file can see."""

from __future__ import annotations

import json
import math
import os
import stat
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.errors import EnvironmentMissingError, InvalidFileError
from lcrl_bench.storage import (
    MAX_DEPTH,
    atomic_path,
    cache_dir,
    canonical_json,
    json_place,
    read_json,
    sha256_of,
    write_bytes,
    write_json,
)

FINITE = st.floats(allow_nan=False, allow_infinity=False)
SCALARS = st.one_of(st.none(), st.booleans(), st.integers(-(2**63), 2**64 - 1), FINITE, st.text())
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20
)


def written(folder: Path, content: bytes | str) -> Path:
    path = folder / "file.json"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@given(VALUES)
def test_what_is_written_is_what_is_read(tmp_path_factory: pytest.TempPathFactory, value: object):
    path = tmp_path_factory.getbasetemp() / "round-trip.json"
    write_json(path, value)
    assert repr(read_json(path)) == repr(json.loads(json.dumps(value, sort_keys=True)))


@given(VALUES)
def test_equal_values_have_one_canonical_form(value: object):
    shuffled = json.loads(json.dumps(value), object_pairs_hook=lambda pairs: dict(pairs[::-1]))
    if shuffled == value:
        assert canonical_json(value) == canonical_json(shuffled)


def test_a_canonical_form_has_no_nan():
    with pytest.raises(ValueError, match="Out of range float"):
        canonical_json([math.nan])


def test_the_hash_is_sha256():
    assert sha256_of(b"abc").startswith("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61")


def test_a_missing_file_is_named(tmp_path: Path):
    with pytest.raises(InvalidFileError, match=r"absent\.json: no such file\. Check the path"):
        read_json(tmp_path / "absent.json")


def test_a_folder_or_a_pipe_is_no_file(tmp_path: Path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe", Path("/dev/zero")):
        with pytest.raises(InvalidFileError, match="not a regular file"):
            read_json(path)


def test_an_unreadable_path_is_an_error_of_the_file(tmp_path: Path):
    for name in ("a" * 5000, "nul\x00", "file.json/below"):
        with pytest.raises(InvalidFileError):
            read_json(written(tmp_path, "1").parent / name)


def test_a_file_over_the_limit_is_refused(tmp_path: Path):
    path = written(tmp_path, "[1, 2, 3]")
    assert read_json(path, max_bytes=9) == [1, 2, 3]
    with pytest.raises(InvalidFileError, match="over the limit"):
        read_json(path, max_bytes=8)


def test_a_file_that_grew_after_its_size_was_asked_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    path = written(tmp_path, "[" + "1," * 1000 + "1]")
    before = path.stat()
    small = os.stat_result((*before[:6], 10, *before[7:]))
    monkeypatch.setattr(Path, "stat", lambda self, **_: small)
    with pytest.raises(InvalidFileError, match="over the limit"):
        read_json(path, max_bytes=100)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", r"not valid JSON \(Expecting value\) at line 1 column 1"),
        (b'{"a": 1,\n "b"', r"not valid JSON .* at line 2 column 5\. It may be truncated"),
        (b"\xff\xfe1", "not UTF-8 text at byte 0"),
        (b'"caf\xe9"', "not UTF-8 text at byte 4"),
        (b'{"a": [1, {"b": NaN}]}', r"holds nan, .* at a\[1\]\.b\. Replace it"),
        (b"[1e999]", r"holds inf, which is not a finite number at \[0\]"),
        (b"-Infinity", "holds -inf, .* at the top level"),
        (b'{"n": 18446744073709551616}', "an integer beyond 64 bits at n"),
        (b"1" * 5000, "not a usable number"),
    ],
)
def test_what_is_no_plain_json_is_refused_with_its_place(
    tmp_path: Path, content: bytes, message: str
):
    with pytest.raises(InvalidFileError, match=message):
        read_json(written(tmp_path, content))


def test_depth_is_bounded(tmp_path: Path):
    assert read_json(written(tmp_path, "[" * MAX_DEPTH + "]" * MAX_DEPTH))
    for depth in (MAX_DEPTH + 2, 900, 200_000):
        with pytest.raises(InvalidFileError, match=f"nested more than {MAX_DEPTH} deep"):
            read_json(written(tmp_path, "[" * depth + "]" * depth))


@given(st.binary(max_size=200))
def test_any_bytes_are_a_value_or_a_clear_error(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
):
    path = tmp_path_factory.getbasetemp() / "any.json"
    path.write_bytes(content)
    outcome = value_or_error(path)
    if isinstance(outcome, InvalidFileError):
        assert str(outcome).startswith(str(path))
    else:
        assert canonical_json(outcome)


def value_or_error(path: Path) -> object:
    try:
        return read_json(path)
    except InvalidFileError as error:
        return error


def test_a_byte_order_mark_is_no_error(tmp_path: Path):
    assert read_json(written(tmp_path, b"\xef\xbb\xbf[1]")) == [1]


def test_a_place_is_written_as_people_write_it_without_control_characters():
    assert json_place(("objects", 3, "position", "x")) == "objects[3].position.x"
    assert json_place(()) == "the top level"
    assert json_place((0, "a\x1b[2J")) == "[0].a\\x1b[2J"


def test_a_reader_never_sees_half_a_file(tmp_path: Path):
    path = tmp_path / "deep" / "folder" / "file.json"
    write_bytes(path, b"first")
    with pytest.raises(RuntimeError, match="stopped"), atomic_path(path) as temporary:  # noqa: PT012
        temporary.write_bytes(b"half of the sec")
        assert path.read_bytes() == b"first"
        raise RuntimeError("stopped")
    assert path.read_bytes() == b"first"
    assert os.listdir(path.parent) == ["file.json"]


def test_a_written_file_is_readable_by_all_and_keeps_its_suffix(tmp_path: Path):
    path = tmp_path / "file.tar.npz"
    with atomic_path(path) as temporary:
        assert temporary.suffix == ".npz"
        assert temporary.parent == path.parent
        temporary.write_bytes(b"x")
    assert stat.S_IMODE(path.stat().st_mode) == 0o644


def test_a_name_as_long_as_a_file_system_allows_can_be_written(tmp_path: Path):
    path = tmp_path / ("a" * 250 + ".json")
    write_bytes(path, b"1")
    assert read_json(path) == 1


def test_a_folder_that_can_not_be_made_is_an_error_of_the_environment(tmp_path: Path):
    (tmp_path / "file").write_bytes(b"")
    path = tmp_path / "file" / "below" / "house.json"
    with pytest.raises(EnvironmentMissingError, match=r"house\.json: can't be written: Not a dir"):
        write_bytes(path, b"1")


def test_a_value_with_nan_is_not_written(tmp_path: Path):
    with pytest.raises(ValueError, match="Out of range float"):
        write_json(tmp_path / "file.json", [math.inf])
    assert os.listdir(tmp_path) == []


def test_caches_lie_where_the_environment_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("LCRL_BENCH_HOME", "/one")
    monkeypatch.setenv("XDG_CACHE_HOME", "/two")
    assert cache_dir() == Path("/one")
    monkeypatch.delenv("LCRL_BENCH_HOME")
    assert cache_dir() == Path("/two/lcrl_bench")
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_dir() == tmp_path / ".cache" / "lcrl_bench"
