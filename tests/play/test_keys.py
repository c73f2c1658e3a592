"""Keys as terminals send them."""

from __future__ import annotations

import pytest

from lcrl_bench.errors import UsageError
from lcrl_bench.play.keys import KEYS, Command, commands_of, decode


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        (b"w", ["w"]),
        (b"W q", ["w", " ", "q"]),
        (b"\x1b[A\x1b[C\x1b[D\x1b[B", ["up", "right", "left", "down"]),
        (b"\x1bOA", ["up"]),
        (b"\x1b[1;5Aw", ["up", "w"]),
        (b"\x1b[3~w", ["w"]),
        (b"\x1b", []),
        (b"\x1bw", ["w"]),
        (b"\xc3\xa9", ["\xe3", "\xa9"]),
        (b"", []),
    ],
)
def test_what_a_terminal_sends_is_told_apart(data, keys):
    assert decode(data) == keys


def test_every_command_has_a_key():
    assert set(KEYS.values()) == set(Command)


def test_a_string_of_keys_is_a_list_of_commands():
    forward, left, right = Command.FORWARD, Command.LEFT, Command.RIGHT
    wanted = [forward, forward, right, left, Command.INTERACT, Command.QUIT]
    assert commands_of("wWda q") == wanted
    with pytest.raises(UsageError, match="'x' is no key"):
        commands_of("wx")
