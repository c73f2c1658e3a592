"""Keys by name, and their commands."""

from __future__ import annotations

import re
from enum import Enum
from typing import Final

from lcrl_bench.errors import UsageError


class Command(Enum):
    """What a key does."""

    FORWARD = "forward"
    LEFT = "left"
    RIGHT = "right"
    INTERACT = "take or put"
    RESTART = "again"
    NEXT = "next task"
    GUIDE = "show the way"
    AUTOPLAY = "let it walk"
    LAYER = "another map"
    MARKS = "hide the goal"
    SUSPEND = "suspend"
    QUIT = "quit"


KEYS: Final = {
    "w": Command.FORWARD,
    "up": Command.FORWARD,
    "a": Command.LEFT,
    "left": Command.LEFT,
    "d": Command.RIGHT,
    "right": Command.RIGHT,
    " ": Command.INTERACT,
    "r": Command.RESTART,
    "n": Command.NEXT,
    "v": Command.GUIDE,
    "p": Command.AUTOPLAY,
    "m": Command.LAYER,
    "g": Command.MARKS,
    "\x1a": Command.SUSPEND,
    "q": Command.QUIT,
    "\x04": Command.QUIT,
}
"""Key → command. Letters work as capitals, too; `"\\x1a"` is Ctrl-Z, `"\\x04"` Ctrl-D."""
_ARROWS: Final = {b"A": "up", b"B": "down", b"C": "right", b"D": "left"}
_SEQUENCE: Final = re.compile(rb"\x1b(?:\[[0-9;<?]*|O)([A-Za-z~])|\x1b|[^\x1b]", re.DOTALL)


def decode(data: bytes) -> list[str]:
    """The keys in what a terminal sent: `"up"`, `"w"`, `" "`; sequences of other keys are left out.

    Source: ECMA-48; arrows come as `ESC [ A` or, in application mode, as `ESC O A`.
    """
    keys: list[str] = []
    for found in _SEQUENCE.finditer(data):
        if found[1] is not None:
            keys += [_ARROWS[found[1]]] if found[1] in _ARROWS else []
        elif found[0] != b"\x1b":
            keys.append(found[0].decode("latin-1").lower())
    return keys


def commands_of(text: str) -> list[Command]:
    """The commands of a string of keys: `"wwda q"`.

    Raises:
        UsageError: If a letter is no key.
    """
    for letter in text:
        if letter.lower() not in KEYS:
            valid = " ".join(repr(key)[1:-1] if key.strip() else "space" for key in "wadrnvpmgq ")
            raise UsageError(f"--keys: {letter!a} is no key. Valid: {valid}.")
    return [KEYS[letter.lower()] for letter in text]
