"""Values that are refused at once: by every verb alike, and with nothing heavy imported."""

from __future__ import annotations

import subprocess
import sys

import pytest

from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode

HEAVY = ("mujoco", "numba", "pyarrow", "rerun", "torch")

MISTYPED = [
    (("runn",), "Did you mean 'run'?"),
    (("leaderboard", "biuld"), "Did you mean 'build'?"),
    (("run", "--method", "lcrll"), "Did you mean 'lcrl'?"),
    (("run", "--method", "nowhere.py:Class"), "No file "),
    (("run", "--method", "lcrl", "--benchmark", "minni"), "Did you mean 'mini'?"),
    (("search", "--method", "clonning"), "Did you mean 'cloning'?"),
    (("reproduce", "table-1", "--benchmark", "minni"), "Did you mean 'mini'?"),
    (("reproduce", "table-9"), "table-9"),
    (("benchmark", "check", "minni"), "Did you mean 'mini'?"),
    (("benchmark", "gallery", "minni"), "Did you mean 'mini'?"),
    (("play", "--benchmark", "minni"), "Did you mean 'mini'?"),
    (("ask", "go", "--benchmark", "minni"), "Did you mean 'mini'?"),
    (("leaderboard", "verify", "--method", "lcrll"), "Did you mean 'lcrl'?"),
    (("show", "lcrll"), "Did you mean 'lcrl'?"),
    (("house", "import", "a.json", "--out", "o", "--source", "prokthor"), "'procthor'?"),
]

PROGRAM = """
import sys
from lcrl_bench.cli.main import main
status = main(sys.argv[1:])
print(*[name for name in {heavy} if name in sys.modules])
sys.exit(status)
"""


@pytest.mark.parametrize(("words", "message"), MISTYPED, ids=lambda each: " ".join(each))
def test_a_mistyped_name_is_answered_before_anything_heavy_is_imported(words, message, tmp_path):
    program = PROGRAM.format(heavy=HEAVY)
    done = subprocess.run(
        [sys.executable, "-c", program, *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == ExitCode.USAGE, done.stderr
    assert message in done.stderr
    assert done.stdout.strip() == ""


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("search", "--method", "lcrl", "--seeds"), "--seeds: give at least one value"),
        (("search", "--method", "lcrl", "--seeds", "3", "3"), "3 is repeated"),
        (("search", "--method", "lcrl", "--jobs", "-1"), "--workers -1"),
        (("reproduce", "table-1", "--seeds", "-1"), "--seeds -1"),
        (("reproduce", "table-1", "--seeds", "0", "0"), "0 is repeated"),
        (("house", "generate", "--out", "o", "--seeds"), "--seeds: give at least one value"),
        (("house", "generate", "--out", "o", "--seeds", "-3"), "--seeds -3"),
        (("house", "import", "--out", "o"), "files: give at least one value"),
        (("play", "--seed", "-1"), "--seed -1"),
        (("submit",), "runs: give at least one value"),
    ],
    ids=lambda each: " ".join(each),
)
def test_lists_need_values_and_seeds_are_numbers_that_stand_once(words, message, capsys):
    assert main(words) == ExitCode.USAGE
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [("reproduce",), ("leaderboard", "verify"), ("leaderboard", "build"), ("run",)]
)
def test_a_flag_that_says_no_is_off_unless_it_is_given(words, capsys):
    assert main([*words, "--help"]) == ExitCode.DONE
    shown = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "(default: True)" not in shown
