"""`lcrl-bench house import`: good files in, bad files named, nothing half-written."""

from __future__ import annotations

import json
import os
from pathlib import Path

import mujoco
import pytest
from house_samples import two_rooms

from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import house_to_json, read_house, write_house

KEYS = {
    *("id", "source", "rooms", "objects", "tiles", "reachable", "classes", "unmapped"),
    *("label_coverage", "house", "mjcf", "errors"),
}


@pytest.fixture
def good(tmp_path) -> Path:
    path = tmp_path / "good.json"
    write_house(path, two_rooms())
    return path


def report(capsys, *words: object) -> tuple[int, list[dict]]:
    code = main(["house", "import", *map(str, words), "--json"])
    return code, json.loads(capsys.readouterr().out)["houses"]


def test_a_house_becomes_house_json_a_scene_and_a_plan(good, tmp_path, capsys, monkeypatch):
    code, (row,) = report(capsys, good, "--out", tmp_path / "out")
    assert code == ExitCode.DONE
    assert set(row) >= KEYS
    assert row["errors"] == []
    assert row["reachable"] <= row["tiles"]
    assert row["label_coverage"] == 1.0
    assert read_house(Path(row["house"])) == two_rooms()
    monkeypatch.chdir("/")
    model = mujoco.MjModel.from_xml_path(str(Path(row["mjcf"])))
    assert model.nbody > len(two_rooms().objects)
    assert (tmp_path / "out" / row["id"] / "plan.png").read_bytes().startswith(b"\x89PNG")


def damaged(change) -> bytes:
    value = house_to_json(two_rooms())
    change(value)
    return json.dumps(value).encode()


WHOLE = json.dumps(house_to_json(two_rooms())).encode()
BAD = {
    "truncated.json": (WHOLE[: len(WHOLE) // 2], "not valid JSON"),
    "nan.json": (
        damaged(lambda h: h["rooms"][0]["polygon"][0].__setitem__(0, float("nan"))),
        "holds nan",
    ),
    "endless.json": (WHOLE.replace(b'"height": 2.6', b'"height": 1e999', 1), "height"),
    "two-points.json": (
        damaged(lambda h: h["rooms"][0].update(polygon=[[0, 0], [1, 1]])),
        "polygon",
    ),
    "outside.json": (
        damaged(lambda h: h["objects"][0].update(position=[500.0, 0.0, 0.3])),
        "outside its room",
    ),
    "dots.json": (damaged(lambda h: h.update(id="../../escape")), "id"),
    "list.json": (b"[]", "not a house in a known format"),
    "binary.json": (b"\xff\xfe\x00" * 100, "not UTF-8"),
    "deep.json": (b"[" * 100_000, "nested"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_is_named_with_the_reason_and_leaves_nothing(name, tmp_path, capsys):
    content, reason = BAD[name]
    path = tmp_path / name
    path.write_bytes(content)
    code, (row,) = report(capsys, path, "--out", tmp_path / "out")
    assert code == ExitCode.RED
    (error,) = row["errors"]
    assert str(path) in error
    assert reason in error
    assert row["house"] is None
    assert not (tmp_path / "out").exists()


def test_a_file_of_200_megabytes_is_refused_unread(tmp_path, capsys):
    path = tmp_path / "huge.json"
    with path.open("wb") as file:
        os.truncate(file.fileno(), 200 << 20)
    code, (row,) = report(capsys, path, "--out", tmp_path / "out")
    assert code == ExitCode.RED
    assert "200.0 MB is over the limit" in row["errors"][0]


def test_the_good_ones_are_imported_beside_the_bad(good, tmp_path, capsys):
    bad = tmp_path / "bad.json"
    bad.write_bytes(b"{")
    code, rows = report(capsys, bad, good, tmp_path / "absent.json", "--out", tmp_path / "out")
    assert code == ExitCode.RED
    assert [bool(row["errors"]) for row in rows] == [True, False, True]
    assert [entry.name for entry in (tmp_path / "out").iterdir()] == [rows[1]["id"]]


def test_two_houses_of_one_name_do_not_overwrite_each_other(good, tmp_path, capsys):
    other = tmp_path / "elsewhere" / "other.json"
    write_house(other, two_rooms())
    code, rows = report(capsys, good, other, "--out", tmp_path / "out")
    assert code == ExitCode.RED
    assert rows[0]["errors"] == []
    assert "is also called" in rows[1]["errors"][0]


def test_without_json_errors_go_to_stderr(tmp_path, capsys):
    bad = tmp_path / "bad.json"
    bad.write_bytes(b"{")
    assert main(["house", "import", str(bad), "--out", str(tmp_path / "out")]) == ExitCode.RED
    shown = capsys.readouterr()
    assert "bad.json" in shown.err
    assert "bad.json" not in shown.out


def test_generated_houses_are_written_alike(tmp_path, capsys):
    words = ["--seeds", "5", "--count", "2", "--rooms", "4", "--out", str(tmp_path), "--json"]
    assert main(["house", "generate", *words]) == ExitCode.DONE
    row, other = json.loads(capsys.readouterr().out)["houses"]
    assert (row["id"], other["id"]) == ("procedural-5", "procedural-6")
    assert row["rooms"] == other["rooms"] == 4
    assert Path(row["mjcf"]).is_file()


def test_a_house_is_drawn(good, tmp_path, capsys):
    picture = tmp_path / "plan.svg"
    assert main(["house", "show", str(good), "--out", str(picture)]) == ExitCode.DONE
    assert "<svg" in picture.read_text("utf-8")
    assert "kitchen" in capsys.readouterr().out
