"""Every end of a command has its exit code, and says what happened on stderr."""

from __future__ import annotations

import errno
import importlib.util
import json
import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from lcrl_bench import __version__
from lcrl_bench.cli import main as door
from lcrl_bench.errors import (
    DuplicateNameError,
    EnvironmentMissingError,
    ExitCode,
    IntegrityError,
    InvalidFileError,
    InvalidHouseError,
    InvalidNameError,
    LcrlError,
    NothingSelectedError,
    UnknownNameError,
    UsageError,
)
from lcrl_bench.interruption import Terminated, resumable
from lcrl_bench.registry import Entry, import_target

Verb = Callable[[Sequence[str]], int]


@pytest.fixture
def run_verb(monkeypatch: pytest.MonkeyPatch) -> Callable[[Verb], int]:
    """Run a verb through the door, in the place of the first one of the table."""

    def run(verb: Verb) -> int:
        monkeypatch.setattr(door, "VERBS", (Entry("probe", f"{__name__}:probe", "a probe"),))
        monkeypatch.setattr(door, "import_target", lambda target: verb)
        return door.main(["probe", "--flag"])

    return run


def raising(error: BaseException) -> Verb:
    def verb(argv: Sequence[str]) -> int:
        raise error

    return verb


@pytest.mark.parametrize("entry", door.VERBS, ids=lambda entry: entry.name)
def test_every_verb_of_the_table_exists(entry: Entry):
    assert callable(import_target(entry.target))


@pytest.mark.parametrize("entry", door.VERBS, ids=lambda entry: entry.name)
def test_every_verb_has_help_on_stdout(entry: Entry, capsys: pytest.CaptureFixture[str]):
    assert door.main([entry.name, "--help"]) == ExitCode.DONE
    shown = capsys.readouterr()
    assert f"lcrl-bench {entry.name}" in shown.out
    assert shown.err == ""


@pytest.mark.parametrize("entry", door.VERBS, ids=lambda entry: entry.name)
def test_an_unknown_flag_is_a_usage_error(entry: Entry, capsys: pytest.CaptureFixture[str]):
    assert door.main([entry.name, "--no-such-flag-anywhere"]) == ExitCode.USAGE
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err != ""


def test_help_lists_every_verb_and_examples(capsys: pytest.CaptureFixture[str]):
    assert door.main(["--help"]) == ExitCode.DONE
    text = capsys.readouterr().out
    assert all(f"  {verb.name} " in text and verb.summary in text for verb in door.VERBS)
    assert "lcrl-bench run --method lcrl" in text


def test_no_verb_is_a_usage_error_that_shows_the_help(capsys: pytest.CaptureFixture[str]):
    assert door.main([]) == ExitCode.USAGE
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "usage: lcrl-bench VERB" in shown.err


def test_version_is_the_packages(capsys: pytest.CaptureFixture[str]):
    assert door.main(["--version"]) == ExitCode.DONE
    assert capsys.readouterr().out == f"lcrl-bench {__version__}\n"


def test_a_mistyped_verb_suggests_the_nearest(capsys: pytest.CaptureFixture[str]):
    assert door.main(["docter"]) == ExitCode.USAGE
    shown = capsys.readouterr()
    assert shown.out == ""
    assert (
        "Unknown verb 'docter'. Did you mean 'doctor'? Valid: ask, bench, benchmark," in shown.err
    )


@pytest.mark.parametrize(
    ("words", "module"),
    [
        (("house", "statistics"), "tools.house_statistics"),
        (("benchmark", "optics", "--help"), "tools.optics"),
    ],
)
def test_a_former_verb_names_the_command_it_has_become(words, module, capsys):
    assert door.main(words) == ExitCode.USAGE
    shown = capsys.readouterr()
    assert shown.out == ""
    assert f"run `python -m {module}` in a checkout" in shown.err
    assert importlib.util.find_spec(f"{module}.__main__") is not None


def test_a_verb_gets_the_words_after_it(run_verb: Callable[[Verb], int]):
    seen: list[str] = []

    def verb(argv: Sequence[str]) -> int:
        seen.extend(argv)
        return 0

    assert run_verb(verb) == ExitCode.DONE
    assert seen == ["--flag"]


def test_a_verbs_own_status_is_passed_on(run_verb: Callable[[Verb], int]):
    assert run_verb(lambda argv: ExitCode.RED) == 1


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (LcrlError("a check is red"), 1),
        (InvalidFileError("house.json", "not valid JSON"), 1),
        (InvalidHouseError("villa", "has no room"), 1),
        (UsageError("--seeds and --seed can't be combined"), 2),
        (UnknownNameError("method", "lcl", ["lcrl"]), 2),
        (DuplicateNameError("method", "lcrl"), 2),
        (InvalidNameError("house", "A B", "no spaces"), 2),
        (EnvironmentMissingError("no renderer"), 4),
        (IntegrityError("model.safetensors", "aa", "bb", fix="Train again."), 4),
        (NothingSelectedError("no task matches"), 5),
    ],
    ids=lambda value: type(value).__name__,
)
def test_an_error_raised_on_purpose_has_its_own_code_and_message(
    error: LcrlError,
    code: int,
    run_verb: Callable[[Verb], int],
    capsys: pytest.CaptureFixture[str],
):
    assert run_verb(raising(error)) == code
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err == f"error: {error}\n"


def test_every_error_class_has_a_code_of_the_table():
    def classes(base: type[LcrlError]) -> list[type[LcrlError]]:
        return [base, *(c for child in base.__subclasses__() for c in classes(child))]

    assert all(isinstance(cls.exit_code, ExitCode) for cls in classes(LcrlError))


def test_a_bug_is_one_line_on_stderr_and_a_traceback_in_a_log(
    run_verb: Callable[[Verb], int], capsys: pytest.CaptureFixture[str], isolated_cache: Path
):
    before = set((isolated_cache / "logs").glob("*.log"))
    assert run_verb(raising(ZeroDivisionError("first line\nsecond line"))) == ExitCode.BUG
    lines = capsys.readouterr().err.splitlines()
    (log,) = set((isolated_cache / "logs").glob("*.log")) - before
    assert len(lines) == 1
    assert "ZeroDivisionError: first line" in lines[0]
    assert str(log) in lines[0]
    text = log.read_text()
    assert "command: lcrl-bench probe --flag" in text
    assert "Traceback (most recent call last)" in text
    assert "second line" in text


def test_a_bug_is_logged_where_the_cache_cant_be_written(
    run_verb: Callable[[Verb], int],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "file" / "cache"))
    assert run_verb(raising(ZeroDivisionError("boom"))) == ExitCode.BUG
    path = capsys.readouterr().err.split("report it with ")[1].rstrip(")\n")
    assert "ZeroDivisionError: boom" in Path(path).read_text()


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_a_disk_that_cant_be_written_is_no_bug(
    number: int, run_verb: Callable[[Verb], int], capsys: pytest.CaptureFixture[str]
):
    error = OSError(number, os.strerror(number), "runs/mini")
    assert run_verb(raising(error)) == ExitCode.ENVIRONMENT
    assert capsys.readouterr().err == f"error: {os.strerror(number)}: runs/mini.\n"


def test_a_missing_package_is_named(
    run_verb: Callable[[Verb], int], capsys: pytest.CaptureFixture[str]
):
    error = ModuleNotFoundError("No module named 'ray'", name="ray")
    assert run_verb(raising(error)) == ExitCode.ENVIRONMENT
    assert "pip install ray" in capsys.readouterr().err


def test_a_missing_module_of_the_suite_itself_is_a_bug(run_verb: Callable[[Verb], int]):
    error = ModuleNotFoundError("No module named 'lcrl_bench.x'", name="lcrl_bench.x")
    assert run_verb(raising(error)) == ExitCode.BUG


def test_another_programs_broken_pipe_is_a_bug(run_verb: Callable[[Verb], int]):
    assert run_verb(raising(BrokenPipeError(errno.EPIPE, "Broken pipe"))) == ExitCode.BUG


@pytest.mark.parametrize(
    ("stop", "code", "word"),
    [(KeyboardInterrupt(), 130, "Interrupted."), (Terminated(), 143, "Terminated.")],
)
def test_a_stop_prints_the_resume_command_of_the_verb(
    stop: BaseException,
    code: int,
    word: str,
    run_verb: Callable[[Verb], int],
    capsys: pytest.CaptureFixture[str],
):
    def verb(argv: Sequence[str]) -> int:
        with resumable("lcrl-bench run --method lcrl"):
            raise stop

    assert run_verb(verb) == code
    saved = "State is saved. Resume with: lcrl-bench run --method lcrl"
    assert capsys.readouterr().err == f"{word} {saved}\n"


def test_a_stop_of_a_verb_without_state_promises_nothing(
    run_verb: Callable[[Verb], int], capsys: pytest.CaptureFixture[str]
):
    assert run_verb(raising(KeyboardInterrupt())) == ExitCode.INTERRUPTED
    assert capsys.readouterr().err == "Interrupted.\n"


def test_the_signal_handler_of_the_caller_is_put_back(run_verb: Callable[[Verb], int]):
    before = signal.getsignal(signal.SIGTERM)
    assert run_verb(lambda argv: 0) == 0
    assert signal.getsignal(signal.SIGTERM) is before


PROGRAM = """
import sys, time
from lcrl_bench.cli import main as door
from lcrl_bench.interruption import resumable

def verb(argv):
    with resumable("lcrl-bench run"):
        print("working", flush=True)
        # In slices: a signal just before a sleep is seen after it.
        while True:
            time.sleep(0.1)

door.import_target = lambda target: verb
sys.exit(door.main(["run"]))
"""


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_from_outside_ends_a_running_command(number: signal.Signals, code: int):
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "working\n"
    process.send_signal(number)
    _, err = process.communicate(timeout=600)
    assert process.returncode == code
    assert err.endswith("State is saved. Resume with: lcrl-bench run\n")


def test_a_reader_that_leaves_gets_no_traceback():
    program = textwrap.dedent("""
        import sys
        from lcrl_bench.cli import main as door

        def verb(argv):
            for _ in range(100_000):
                print("a line of an answer that nobody reads to the end")
            return 0

        door.import_target = lambda target: verb
        sys.exit(door.main(["list"]))
    """)
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.readline()
    process.stdout.close()
    err = process.stderr.read()
    process.stderr.close()
    assert process.wait(timeout=600) == ExitCode.RED
    assert err == ""


@pytest.mark.parametrize("words", [["-m", "lcrl_bench"], ["-m", "lcrl_bench.cli.main"]])
def test_the_command_is_also_a_python_module(words: list[str]):
    done = subprocess.run(
        [sys.executable, *words, "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"lcrl-bench {__version__}\n"


def test_the_run_module_is_the_verb_run():
    done = subprocess.run(
        [sys.executable, "-m", "lcrl_bench.run", "--help"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "lcrl-bench run" in done.stdout


def test_finding_a_verb_imports_nothing_heavy():
    program = "import lcrl_bench.cli.main, sys, json; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    loaded = set(json.loads(done.stdout))
    assert not loaded & {"torch", "mujoco", "dm_control", "rerun", "numpy", "tyro", "matplotlib"}
