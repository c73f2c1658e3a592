"""A real terminal, taken over and given back: the other end of a pseudo-terminal is the person."""

from __future__ import annotations

import fcntl
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from environment_samples import sample_benchmark
from game_samples import NAV, make_game

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.play.colors import Colors
from lcrl_bench.play.session import play_live
from lcrl_bench.play.terminal import ENTER, LEAVE, RESIZED, Terminal

PROGRAM = """
import fcntl, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
from lcrl_bench.cli.main import main
sys.exit(main(sys.argv[1:]))
"""
"""Makes the terminal its own first, so that Ctrl-C typed there arrives as a signal."""


class Person:
    """Who sits at a terminal of 80 x 24, and reads all the time: a page waits to be read."""

    def __init__(self) -> None:
        self.master, self.slave = pty.openpty()
        self.resize(80, 24)
        self._data = b""
        self._gone = threading.Event()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def seen(self) -> str:
        """All that was shown so far."""
        return self._data.decode(errors="replace")

    def resize(self, columns: int, rows: int) -> None:
        fcntl.ioctl(self.slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def type(self, keys: bytes) -> None:
        os.write(self.master, keys)

    def wait_for(self, words: str) -> None:
        until = time.monotonic() + 600
        while words not in self.seen:
            assert time.monotonic() < until, f"{words!r} never came:\n{self.seen[-2000:]}"
            time.sleep(0.02)

    def leave(self) -> None:
        self._gone.set()
        self._reader.join()
        os.close(self.master)
        os.close(self.slave)

    def _read(self) -> None:
        while not self._gone.is_set():
            if select.select([self.master], [], [], 0.02)[0]:
                self._data += os.read(self.master, 65536)


@pytest.fixture
def person() -> Iterator[Person]:
    someone = Person()
    yield someone
    someone.leave()


@pytest.fixture
def terminal(person: Person) -> Iterator[Terminal]:
    with (
        open(person.slave, closefd=False, encoding="utf-8") as source,
        open(person.slave, "w", closefd=False, encoding="utf-8") as target,
    ):
        yield Terminal(source, target)


def test_keys_come_one_by_one_without_echo(person, terminal):
    with terminal:
        person.type(b"w\x1b[A q")
        assert [terminal.key() for _ in range(4)] == ["w", "up", " ", "q"]
        assert terminal.key(0.01) is None
    person.wait_for(LEAVE)
    assert person.seen == ENTER + LEAVE


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError, SystemExit])
def test_the_terminal_is_given_back_whatever_happens(person, terminal, error):
    before = termios.tcgetattr(person.slave)

    def play():
        with terminal:
            assert termios.tcgetattr(person.slave) != before
            raise error

    with pytest.raises(error):
        play()
    assert termios.tcgetattr(person.slave) == before
    person.wait_for(LEAVE)


def test_another_size_comes_as_a_key(person, terminal):
    with terminal:
        assert terminal.size == (80, 24)
        person.resize(100, 30)
        assert terminal.key() == RESIZED
        assert terminal.size == (100, 30)
        assert terminal.key(0.01) is None


def test_a_game_is_played_to_its_goal_with_the_keys_of_its_guide(person, terminal):
    game = make_game(NAV)
    keys = {0: b"\x1b[A", 1: b"\x1b[D", 2: b"\x1b[C", 3: b" "}
    guide = make_game(NAV)
    presses = b""
    while not guide.walk.over:
        advice = guide.guides[0].advice(guide.walk)
        assert advice is not None
        presses += keys[advice]
        guide.step()
    person.type(presses + b"q")
    play_live(game, terminal, Colors.FULL)
    assert game.walk.states == guide.walk.states
    assert game.walk.reached
    person.wait_for("goal reached")


def test_a_walk_that_is_taken_over_goes_on_by_itself_and_a_key_ends_it(person, terminal):
    game = make_game(NAV)
    person.type(b"p")
    end = threading.Thread(target=lambda: (person.wait_for("step 2 of"), person.type(b"aq")))
    end.start()
    play_live(game, terminal, Colors.PLAIN)
    end.join()
    assert game.walk.steps >= 3
    assert not game.autoplay


def test_a_file_is_no_terminal(tmp_path):
    with (
        (tmp_path / "keys").open("w+") as file,
        pytest.raises(EnvironmentMissingError, match="--keys"),
    ):
        Terminal(file, file)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("play") / "rooms"
    write_benchmark(path, sample_benchmark())
    return path


# Each starts a process, which takes some seconds: only a process has signals of its own.
@pytest.mark.parametrize(("stop", "status"), [(b"q", 0), (b"\x03", 130), (signal.SIGTERM, 143)])
def test_the_command_leaves_the_terminal_as_it_was(person, folder, stop, status):
    before = termios.tcgetattr(person.slave)
    words = ["play", "--benchmark", str(folder), "--task", NAV, "--renderer", "rays"]
    environment = {**os.environ, "TERM": "xterm-256color", "COLORTERM": "truecolor"}
    environment.pop("NO_COLOR", None)
    command = [sys.executable, "-c", PROGRAM, *words]
    ends = {"stdin": person.slave, "stdout": person.slave, "stderr": person.slave}
    with subprocess.Popen(command, env=environment, start_new_session=True, **ends) as process:
        person.wait_for("step 0 of 30")
        person.type(b"d")
        person.wait_for("step 1 of 30")
        if isinstance(stop, bytes):
            person.type(stop)
        else:
            process.send_signal(stop)
        assert process.wait(timeout=600) == status
    person.wait_for(LEAVE)
    assert "38;2;" in person.seen
    assert ENTER not in person.seen.split(LEAVE)[1]
    assert termios.tcgetattr(person.slave) == before
