"""`lcrl-bench view`: what it says before the viewer takes over."""

from __future__ import annotations

from pathlib import Path

import pytest

from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode

VIEWER = "lcrl_bench.recording.rerun.viewer"


@pytest.fixture
def opened(monkeypatch) -> list[str]:
    """How recordings would have been opened."""
    ways: list[str] = []
    monkeypatch.setattr(f"{VIEWER}.open_window", lambda path: ways.append("window"))
    monkeypatch.setattr(f"{VIEWER}.serve_page", lambda path, say: ways.append("page"))
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    return ways


@pytest.fixture
def file(tmp_path) -> Path:
    """What begins as a recording does."""
    path = tmp_path / "ask.rrd"
    path.write_bytes(b"RRF2")
    return path


def test_without_a_display_it_is_a_page_and_with_one_a_window(opened, file, monkeypatch, capsys):
    assert main(["view", str(file)]) == ExitCode.DONE
    monkeypatch.setenv("DISPLAY", ":0")
    assert main(["view", str(file)]) == ExitCode.DONE
    assert main(["view", str(file), "--web"]) == ExitCode.DONE
    assert opened == ["page", "window", "page"]
    assert f"recording: {file}" in capsys.readouterr().err


def test_the_episodes_of_a_file_are_an_empty_list_and_nothing_is_opened(opened, file, capsys):
    assert main(["view", str(file), "--list"]) == ExitCode.DONE
    assert "episode" in capsys.readouterr().out
    assert opened == []


def test_mistakes_are_named(opened, tmp_path, capsys):
    assert main(["view", str(tmp_path)]) == ExitCode.EMPTY
    assert main(["view", str(tmp_path / "gone")]) == ExitCode.USAGE
    assert main(["view", str(tmp_path / "gone.rrd")]) == ExitCode.RED
    said = capsys.readouterr().err
    assert "Train one" in said
    assert "no such file" in said
    assert opened == []
