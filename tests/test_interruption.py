"""A stop arrives, whatever loses its exception on the way: in loops, at the end, in every verb."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.interruption import (
    Terminated,
    forget_stop,
    raise_if_stopped,
    resumable,
    stops_postponed,
    terminable,
)

STOPS = [(signal.SIGTERM, Terminated), (signal.SIGINT, KeyboardInterrupt)]


def lost(number: int) -> None:
    """A signal in code that guards against everything, as imports of optional packages do."""
    with contextlib.suppress(BaseException):
        os.kill(os.getpid(), number)


@pytest.mark.parametrize(("number", "stop"), STOPS)
def test_a_stop_that_was_lost_is_raised_by_the_next_loop(number, stop):
    rounds = []

    def command() -> None:
        lost(number)
        while len(rounds) < 10:
            rounds.append(1)
            raise_if_stopped()

    with pytest.raises(stop), terminable():
        command()
    assert len(rounds) == 1


@pytest.mark.parametrize(("number", "stop"), STOPS)
def test_a_stop_that_was_lost_is_raised_at_the_end_with_the_command_that_resumes(number, stop):
    with pytest.raises(stop) as caught, terminable(), resumable("lcrl-bench run"):
        lost(number)
    assert caught.value.__notes__ == ["State is saved. Resume with: lcrl-bench run"]


def test_what_a_stop_broke_on_its_way_is_the_stop():
    def command() -> None:
        lost(signal.SIGTERM)
        raise RecursionError("a module imported by half")

    with pytest.raises(Terminated), terminable():
        command()


def test_a_short_block_comes_to_its_end_before_it_is_stopped():
    done = []

    def block() -> None:
        os.kill(os.getpid(), signal.SIGTERM)
        done.append("whole")

    with pytest.raises(Terminated), terminable(), stops_postponed():
        block()
    assert done == ["whole"]


def test_a_stop_that_is_the_usual_end_is_no_stop():
    def page() -> None:
        with contextlib.suppress(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
        forget_stop()

    with terminable():
        page()


def test_a_stop_of_one_command_is_none_of_the_next():
    with pytest.raises(Terminated), terminable():
        os.kill(os.getpid(), signal.SIGTERM)
    with terminable():
        raise_if_stopped()


def test_a_signal_that_the_caller_ignores_stays_ignored():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with terminable():
            os.kill(os.getpid(), signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)


PROGRAM = """
import os, signal, sys

from lcrl_bench.cli.main import main

when, *words = sys.argv[1:]
seen = 0

def hook(event, _):
    global seen
    if event == "import":
        seen += 1
        if seen == int(when):
            os.kill(os.getpid(), signal.SIGTERM)

def trace(frame, event, _):
    # Once the verb is called, its handlers are in place.
    if frame.f_code.co_name == "_dispatch":
        sys.setprofile(None)
        sys.addaudithook(hook)

sys.setprofile(trace)
sys.exit(main(words))
"""
"""A command that is sent SIGTERM at the import of so many modules: a moment that no speed moves."""


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


@pytest.fixture(scope="module")
def recording(tmp_path_factory) -> Path:
    """Enough of a recording to begin to serve it."""
    file = tmp_path_factory.mktemp("recording") / "any.rrd"
    file.write_bytes(b"RRF2")
    return file


def stopped_at(when: int, *words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {key: value for key, value in os.environ.items() if "DISPLAY" not in key}
    return subprocess.run(
        [sys.executable, "-c", PROGRAM, str(when), *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("when", [1, 300, 700, 1100, 1400])
def test_view_ends_wherever_it_is_when_it_is_terminated(when, recording, tmp_path):
    done = stopped_at(when, "view", "--web", str(recording), folder=tmp_path)
    assert done.returncode == 143, done.stderr
    assert done.stderr.endswith("Terminated.\n")


TRAINING = ("--set", "passes=2", "least_steps=1", "--renderer", "rays")
VERBS = {
    "run": ("run", "--method", "lcrl", "--benchmark", "{}", *TRAINING),
    "search": ("search", "--method", "lcrl", "--benchmark", "{}", "--houses", "1"),
    "reproduce": ("reproduce", "table-1", "--benchmark", "{}", "--budget", "small"),
}


@pytest.mark.parametrize("when", [500, 1100])
@pytest.mark.parametrize("verb", VERBS)
def test_a_verb_with_state_says_how_to_resume_wherever_it_is_terminated(
    verb, when, benchmark, tmp_path
):
    words = [str(benchmark) if word == "{}" else word for word in VERBS[verb]]
    done = stopped_at(when, *words, folder=tmp_path)
    assert done.returncode == 143, done.stderr
    assert f"Terminated. State is saved. Resume with: lcrl-bench {verb} " in done.stderr
    assert not list(tmp_path.rglob(".*")), "something half-written is left"


STATELESS = {
    "play": ("play", "--benchmark", "{}", "--keys", "wwd", "--renderer", "rays"),
    "check": ("benchmark", "check", "{}", "--renderer", "rays"),
    "verify": ("leaderboard", "verify", "nowhere.json"),
    "doctor": ("doctor",),
}


@pytest.mark.parametrize("verb", STATELESS)
def test_every_other_verb_ends_too(verb, benchmark, tmp_path):
    words = [str(benchmark) if word == "{}" else word for word in STATELESS[verb]]
    done = stopped_at(100, *words, folder=tmp_path)
    assert done.returncode == 143, done.stderr
    assert "Terminated." in done.stderr
