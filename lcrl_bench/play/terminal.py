"""A terminal taken over for the game, and restored whatever happens.

Plain ANSI sequences and termios: keys arrive one by one and are not echoed, the page is drawn on
the terminal's second screen, so what was on it before is there again afterwards.
"""

from __future__ import annotations

import codecs
import os
import select
import signal
import sys
from types import TracebackType
from typing import Any, Final, TextIO

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.interruption import raise_if_stopped
from lcrl_bench.play.keys import decode

ENTER: Final = "\x1b[?1049h\x1b[?25l\x1b[2J"
"""The second screen, no cursor, empty."""
LEAVE: Final = "\x1b[0m\x1b[?25h\x1b[?1049l"
HOME: Final = "\x1b[?2026h\x1b[H"
"""Begins a synchronized update: terminals that support it show a page only when it is complete."""
CLEAR_LINE: Final = "\x1b[K"
SHOW: Final = "\x1b[J\x1b[?2026l"
RESIZED: Final = "resized"
"""Returned as a key when the terminal was resized."""
_POLL: Final = 0.25
"""Seconds between checks of the terminal's size."""
_READ: Final = 1024


class Terminal:
    """A context manager; inside it keys are read and pages shown."""

    def __init__(self, source: TextIO | None = None, target: TextIO | None = None) -> None:
        """Check the terminal; it is taken over on entering the context.

        Args:
            source: Where keys come from; None means stdin.
            target: Where pages go; None means stdout.

        Raises:
            EnvironmentMissingError: If that is no terminal.
        """
        self._source, self._target = source or sys.stdin, target or sys.stdout
        if not (_is_terminal(self._source) and _is_terminal(self._target)):
            raise EnvironmentMissingError(
                "There is no terminal here to play in. Give the keys instead:"
                ' lcrl-bench play --keys "wwdw q"'
            )
        try:
            import termios
        except ImportError as error:
            raise EnvironmentMissingError(
                "This system has no termios; play in a terminal of Linux, macOS or WSL, or give the"
                ' keys: lcrl-bench play --keys "wwdw q"'
            ) from error
        self._termios = termios
        self._before: list[Any] = []
        self._keys: list[str] = []
        self._size = self.size

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows."""
        size = os.get_terminal_size(self._target.fileno())
        # A terminal that reports no size is taken to have the default one.
        return size.columns or 80, size.lines or 24

    def __enter__(self) -> Terminal:
        """Take the terminal over."""
        self._before = self._termios.tcgetattr(self._source.fileno())
        self._take()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Restore it."""
        self._restore()

    def show(self, lines: list[str]) -> None:
        """Show a page; lines are no longer than the terminal is wide."""
        page = f"{CLEAR_LINE}\r\n".join(lines)
        self._write(f"{HOME}{page}{CLEAR_LINE}{SHOW}")

    def key(self, timeout: float | None = None) -> str | None:
        """The next key.

        Args:
            timeout: Seconds to wait; None means until there is one.

        Returns:
            A key as `decode` names it, or `RESIZED`; None after the timeout.

        Raises:
            EOFError: If the terminal is gone.
        """
        left = timeout
        while not self._keys:
            raise_if_stopped()
            if self._size != self.size:
                self._size = self.size
                return RESIZED
            wait = _POLL if left is None else min(left, _POLL)
            if select.select([self._source], [], [], wait)[0]:
                data = os.read(self._source.fileno(), _READ)
                if not data:
                    raise EOFError("the terminal is gone")
                self._keys += decode(data)
            elif left is not None:
                left -= wait
                if left <= 0:
                    return None
        return self._keys.pop(0)

    def suspend(self) -> None:
        """Go into the background, as Ctrl-Z does, and take over again when called back."""
        self._restore()
        os.kill(os.getpid(), signal.SIGTSTP)
        self._take()

    def _take(self) -> None:
        termios, file = self._termios, self._source.fileno()
        mode = termios.tcgetattr(file)
        mode[3] &= ~(termios.ECHO | termios.ICANON)
        mode[6][termios.VMIN], mode[6][termios.VTIME] = 1, 0
        # Ctrl-C stays an interrupt; Ctrl-Z and Ctrl-\\ would leave the terminal as it is now.
        off = os.fpathconf(file, "PC_VDISABLE").to_bytes(1, "little")
        mode[6][termios.VSUSP], mode[6][termios.VQUIT] = off, off
        termios.tcsetattr(file, termios.TCSADRAIN, mode)
        self._write(ENTER)

    def _restore(self) -> None:
        try:
            self._write(LEAVE)
        finally:
            self._termios.tcsetattr(self._source.fileno(), self._termios.TCSADRAIN, self._before)

    def _write(self, text: str) -> None:
        # Straight to the file, unbuffered; a letter that the terminal lacks becomes a "?".
        encoding = codecs.lookup(self._target.encoding or "utf-8").name
        data = text.encode(encoding, "replace")
        self._target.flush()
        while data:
            data = data[os.write(self._target.fileno(), data) :]


def _is_terminal(stream: TextIO) -> bool:
    try:
        return os.isatty(stream.fileno())
    except (OSError, ValueError):
        return False
