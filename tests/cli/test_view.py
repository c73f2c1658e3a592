"""`lcrl-bench view`: what it says before the viewer takes over."""

from __future__ import annotations

import pytest

from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode


@pytest.fixture
def handed_over(monkeypatch) -> list[tuple[str, ...]]:
    """The words of the viewers that would have been started."""
    started: list[tuple[str, ...]] = []
    name = "lcrl_bench.recording.rerun_viewer.hand_over"
    monkeypatch.setattr(name, lambda call: started.append(call.words))
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    return started


def test_without_a_display_a_browser_is_told_where_to_look(handed_over, tmp_path, capsys):
    file = tmp_path / "ask.rrd"
    file.write_bytes(b"RRF2")
    assert main(["view", str(file)]) == ExitCode.DONE
    assert "--serve-web" in handed_over[0]
    assert "open http://127.0.0.1:" in capsys.readouterr().err


def test_with_a_display_a_window_is_opened(handed_over, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("DISPLAY", ":0")
    file = tmp_path / "ask.rrd"
    file.write_bytes(b"RRF2")
    assert main(["view", str(file)]) == ExitCode.DONE
    assert "--serve-web" not in handed_over[0]
    assert "http" not in capsys.readouterr().err
    assert main(["view", str(file), "--web"]) == ExitCode.DONE
    assert "--web-viewer" in handed_over[1]


def test_the_episodes_of_a_file_are_an_empty_list_and_nothing_is_opened(
    handed_over, tmp_path, capsys
):
    file = tmp_path / "ask.rrd"
    file.write_bytes(b"RRF2")
    assert main(["view", str(file), "--list"]) == ExitCode.DONE
    assert "episode" in capsys.readouterr().out
    assert handed_over == []


def test_mistakes_are_named(handed_over, tmp_path, capsys):
    assert main(["view", str(tmp_path)]) == ExitCode.EMPTY
    assert main(["view", str(tmp_path / "gone")]) == ExitCode.USAGE
    assert main(["view", str(tmp_path / "gone.rrd")]) == ExitCode.RED
    said = capsys.readouterr().err
    assert "Train one" in said
    assert "no such file" in said
    assert handed_over == []
