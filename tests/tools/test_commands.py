"""What the commands of `tools` have in common: help, exit codes, and a fast answer to a typo."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from lcrl_bench.errors import ExitCode

REPOSITORY = Path(__file__).parents[2]
TOOLS = ("speed", "house_statistics", "optics")

MISTYPED = """
import sys
from lcrl_bench.cli.main import run_command
from tools.speed.command import main
status = run_command(main, sys.argv[1:], program="speed")
print(*[name for name in ("mujoco", "numba", "pyarrow", "rerun", "torch") if name in sys.modules])
sys.exit(status)
"""

STOPPED = """
import os, signal, sys
from lcrl_bench.cli.main import run_command
from tools.speed.command import main

seen = 0

def hook(event, _):
    global seen
    if event == "import":
        seen += 1
        if seen == 100:
            os.kill(os.getpid(), signal.SIGTERM)

def command(argv):
    sys.addaudithook(hook)
    return main(argv)

sys.exit(run_command(command, sys.argv[1:], program="speed"))
"""
"""The command is sent SIGTERM at its 100th import: a moment that does not depend on speed."""


def run_python(*words: str) -> subprocess.CompletedProcess[str]:
    """Run Python in the checkout, as a developer does."""
    command = [sys.executable, *words]
    return subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("tool", TOOLS)
def test_a_tool_has_help_on_stdout(tool: str):
    done = run_python("-m", f"tools.{tool}", "--help")
    assert done.returncode == ExitCode.DONE
    assert f"python -m tools.{tool}" in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize("tool", TOOLS)
def test_an_unknown_flag_of_a_tool_is_a_usage_error(tool: str):
    done = run_python("-m", f"tools.{tool}", "--no-such-flag-anywhere")
    assert (done.returncode, done.stdout) == (ExitCode.USAGE, "")
    assert "--no-such-flag-anywhere" in done.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--benchmark", "minni"), "Did you mean 'mini'?"),
        (("--threads",), "--threads: give at least one value"),
        (("--threads", "-1"), "--threads -1"),
    ],
)
def test_a_mistyped_value_is_answered_before_anything_heavy_is_imported(words, message):
    done = run_python("-c", MISTYPED, *words)
    assert done.returncode == ExitCode.USAGE, done.stderr
    assert message in done.stderr
    assert done.stdout.strip() == ""


def test_a_tool_that_is_terminated_ends_with_the_exit_code_for_it():
    done = run_python("-c", STOPPED, "--benchmark", "mini", "--houses", "1", "--repeats", "1")
    assert done.returncode == ExitCode.TERMINATED, done.stderr
    assert done.stderr.endswith("Terminated.\n")
