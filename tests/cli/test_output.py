"""Answers go to stdout, talk to stderr, and a JSON answer is one object and nothing else."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from lcrl_bench.cli import output

SPOILED = """
import ctypes, json, sys
from lcrl_bench.cli.output import print_json, stdout_kept_clean
with stdout_kept_clean():
    print("a library's greeting")
    ctypes.CDLL(None).puts(b"a C library's warning")
    ctypes.CDLL(None).fflush(None)
print_json({"answer": 42})
"""


def test_what_libraries_print_does_not_spoil_a_json_answer():
    done = subprocess.run([sys.executable, "-c", SPOILED], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == {"answer": 42}
    assert "a library's greeting" in done.stderr
    assert "a C library's warning" in done.stderr


def test_stdout_comes_back_after_an_error():
    program = (
        "from lcrl_bench.cli.output import stdout_kept_clean\n"
        "try:\n    with stdout_kept_clean():\n        raise ValueError\n"
        "except ValueError:\n    print('back')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout == "back\n"


def test_a_json_answer_has_no_nan():
    with pytest.raises(ValueError, match="not JSON compliant"):
        output.print_json({"success": float("nan")})


def test_talk_goes_to_stderr(capsys: pytest.CaptureFixture[str]):
    output.say("building 3 houses")
    output.warn("software renderer")
    output.suggest(["lcrl-bench", "doctor"], "is this machine ready?")
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.splitlines() == [
        "building 3 houses",
        "warning: software renderer",
        "next: lcrl-bench doctor   # is this machine ready?",
    ]


def test_brackets_in_a_message_are_no_markup(capsys: pytest.CaptureFixture[str]):
    output.say("expected [bold]uint8[4, 24, 32][/bold]")
    assert capsys.readouterr().err == "expected [bold]uint8[4, 24, 32][/bold]\n"


def test_a_table_in_a_pipe_is_never_folded(capsys: pytest.CaptureFixture[str]):
    long = "a summary of many words " * 20
    output.print_table(("name", "summary"), [("lcrl", long), ("random", "[red]short[/red]")])
    rows = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert any(line.startswith("lcrl") and line.endswith(long.rstrip()) for line in rows)
    assert any(line.endswith("[red]short[/red]") for line in rows)


def test_numbers_are_aligned_to_the_right(capsys: pytest.CaptureFixture[str]):
    output.print_table(("method", "n"), [("lcrl", 5), ("random", 1000)], right=("n",))
    rows = capsys.readouterr().out.rstrip("\n").splitlines()
    assert [line.rstrip()[-4:] for line in rows if line.startswith(("lcrl", "rand"))] == [
        "   5",
        "1000",
    ]


def test_nothing_is_coloured_outside_a_terminal(capsys: pytest.CaptureFixture[str]):
    output.warn("software renderer")
    output.print_table(("a",), [("b",)], title="t")
    shown = capsys.readouterr()
    assert "\x1b[" not in shown.out + shown.err


def test_no_color_is_respected_on_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    output.warn("software renderer")
    assert "\x1b[1;33m" in capsys.readouterr().err
    monkeypatch.setenv("NO_COLOR", "1")
    output.warn("software renderer")
    assert "33m" not in capsys.readouterr().err


def test_bars_are_drawn_on_a_terminal_only(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert output.bars_wanted()
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False)
    assert not output.bars_wanted()
