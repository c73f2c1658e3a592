"""Entry point of the command line: dispatches to a verb and maps every ending to an exit code.

A verb is a function `argv -> int` in a module that is imported on use. It raises `LcrlError` for
what the user can fix; any other exception is a bug, and is logged as one.
"""

from __future__ import annotations

import contextlib
import errno
import os
import platform
import select
import shlex
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

from lcrl_bench.cli.arguments import Verb, run_verb
from lcrl_bench.cli.output import print_text, say
from lcrl_bench.errors import EnvironmentMissingError, ExitCode, LcrlError
from lcrl_bench.interruption import Terminated, stop_code, stop_message, terminable
from lcrl_bench.registry import Entry, import_target
from lcrl_bench.storage import FULL_DISK, cache_dir, write_bytes
from lcrl_bench.version import __version__

VERBS: Final = tuple(
    Entry(name, f"lcrl_bench.cli.{place}", summary)
    for name, place, summary in (
        ("run", "run:main", "train a method, evaluate it on every split, record, print the table"),
        ("reproduce", "reproduce:main", "the paper's tables from real runs, ours beside theirs"),
        ("search", "search:main", "tune a method's settings on validation houses"),
        ("new-method", "new_method:main", "start a method: code that runs and learns, and a test"),
        ("submit", "submit:main", "pack finished runs of a method into a leaderboard row"),
        (
            "leaderboard",
            "leaderboard:main",
            "re-run submissions to verify them, build the page",
        ),
        ("list", "inventory:run_list", "list methods, benchmarks and house sources"),
        ("show", "inventory:run_show", "everything known about a method, benchmark or source"),
        ("ask", "ask:main", "give a run's model any sentence: its reward map, path and outcome"),
        ("view", "view:main", "open a recording in the installed viewer, offline"),
        ("play", "play:main", "walk the agent by keyboard, in the terminal"),
        ("house", "house:main", "import, generate and draw houses"),
        (
            "benchmark",
            "benchmark:main",
            "freeze houses and tasks into a benchmark, prove them",
        ),
        ("bench", "bench:main", "measure the suite's speed beside its alternatives"),
        ("doctor", "doctor:main", "check this machine: renderer, devices, versions, speed"),
    )
)
"""Every verb, in the order of `--help`."""

EXAMPLES: Final = (
    ("lcrl-bench run --method lcrl", "the whole benchmark, no other flag needed"),
    ("lcrl-bench run --method lcrl --benchmark mini", "a small benchmark, in minutes"),
    ("lcrl-bench list methods", "what can be run"),
    ("lcrl-bench doctor", "is this machine ready?"),
)

UNUSABLE_DISK: Final = (errno.EACCES, errno.EPERM, errno.EROFS, *FULL_DISK)
"""Errors of a disk that can't be written: for the user to fix."""


def entry_point() -> None:
    """The `lcrl-bench` console script."""
    sys.exit(main(sys.argv[1:]))


def main(argv: Sequence[str]) -> int:
    """Run one verb, however it ends.

    Args:
        argv: The verb and its flags.

    Returns:
        The exit status, an `ExitCode`.
    """
    return run_command(_dispatch, argv, program="lcrl-bench")


def run_command(command: Verb, argv: Sequence[str], *, program: str) -> int:
    """Run a command to its end, and turn every error into a message and an exit code.

    Args:
        command: What to run.
        argv: Its words.
        program: How it is called, for the log of a bug.

    Returns:
        The exit status, an `ExitCode`.
    """
    try:
        with terminable():
            status = command(list(argv))
        sys.stdout.flush()
    except LcrlError as error:
        say(f"error: {error}", style="bold red")
        return int(error.exit_code)
    except (KeyboardInterrupt, Terminated) as stop:
        say(stop_message(stop))
        return int(stop_code(stop))
    except SystemExit as leave:
        return _status_of(leave)
    except Exception as error:
        return _end_of(error, f"{program} {shlex.join(argv)}")
    return int(status)


def _dispatch(argv: Sequence[str]) -> int:
    if argv and argv[0] in ("-V", "--version"):
        print_text(f"lcrl-bench {__version__}")
        return ExitCode.DONE
    verbs = {verb.name: partial(_run_target, verb.target) for verb in VERBS}
    return run_verb(argv, verbs, kind="verb", help_text=help_text())


def _run_target(target: str, argv: Sequence[str]) -> int:
    return import_target(target)(argv)


def help_text() -> str:
    """The text of `lcrl-bench --help`: usage, examples, verbs."""
    width = max(len(command) for command, _ in EXAMPLES)
    examples = [f"  {command:{width}}  {purpose}" for command, purpose in EXAMPLES]
    longest = max(len(verb.name) for verb in VERBS)
    verbs = [f"  {verb.name:{longest}}  {verb.summary}" for verb in VERBS]
    return "\n".join(
        [
            "usage: lcrl-bench VERB [FLAGS]",
            "",
            "The open benchmark suite for language-conditioned reward learning in MuJoCo houses.",
            "",
            "examples:",
            *examples,
            "",
            "verbs:",
            *verbs,
            "",
            "`lcrl-bench VERB --help` shows a verb's flags; `--version` the version.",
            "Answers go to stdout, with `--json` as one JSON object; everything else to stderr.",
            "Caches and logs are in $LCRL_BENCH_HOME (default: ~/.cache/lcrl_bench).",
        ]
    )


def _status_of(leave: SystemExit) -> int:
    if leave.code is None or isinstance(leave.code, int):
        return int(leave.code or 0)
    say(str(leave.code))
    return int(ExitCode.RED)


def _end_of(error: Exception, command: str) -> int:
    if isinstance(error, BrokenPipeError) and _reader_left():
        return int(ExitCode.RED)
    if isinstance(error, ModuleNotFoundError) and not (error.name or "").startswith("lcrl_bench"):
        advice = "Install it into this environment: pip install"
        error = EnvironmentMissingError(f"No Python package '{error.name}'. {advice} {error.name}.")
    elif isinstance(error, OSError) and error.errno in UNUSABLE_DISK:
        if error.filename is None:
            # Errors of other files carry a name.
            _silence_stdout()
        error = EnvironmentMissingError(f"{error.strerror}: {error.filename or 'standard output'}.")
    if isinstance(error, LcrlError):
        say(f"error: {error}", style="bold red")
        return int(error.exit_code)
    path = write_bug_log(error, command)
    summary = f"{type(error).__name__}: {error}".splitlines()[0]
    say(f"internal error: {summary} (please report it with {path})", style="bold red")
    return int(ExitCode.BUG)


def _reader_left() -> bool:
    # Only stdout's own broken pipe means that the reader left.
    try:
        descriptor = sys.stdout.fileno()
    except (OSError, ValueError):
        return False
    poll = select.poll()
    poll.register(descriptor, select.POLLOUT)
    left = any(event & (select.POLLERR | select.POLLHUP) for _, event in poll.poll(0))
    if left:
        _silence_stdout()
    return left


def _silence_stdout() -> None:
    """Keep the interpreter's flush at exit from failing again."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def write_bug_log(error: BaseException, command: str) -> Path:
    """Write the traceback of a bug, with what is needed to repeat it, and return the file.

    The file is in `logs/` of the cache, or in a temporary folder if that can't be written.
    """
    lines = [
        f"command: {command}",
        f"lcrl_bench {__version__}, Python {platform.python_version()}, {platform.platform()}",
        "",
        *traceback.format_exception(error),
    ]
    text = "\n".join(line.rstrip("\n") for line in lines) + "\n"
    name = f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.log"
    try:
        path = cache_dir() / "logs" / name
        write_bytes(path, text.encode("utf-8", "replace"))
    except (OSError, LcrlError):
        path = Path(tempfile.mkdtemp(prefix="lcrl_bench-")) / name
        write_bytes(path, text.encode("utf-8", "replace"))
    return path


if __name__ == "__main__":
    entry_point()
