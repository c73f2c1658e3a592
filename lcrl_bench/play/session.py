"""The game loop: in a terminal, or with a string of keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

from lcrl_bench.play.colors import Colors
from lcrl_bench.play.game import Game
from lcrl_bench.play.keys import KEYS, Command
from lcrl_bench.play.page import Page
from lcrl_bench.play.terminal import RESIZED, Terminal

PACE: Final = 0.3
"""Seconds between two steps of the guide."""
DEFAULT_SIZE: Final = (80, 24)
"""Columns and rows of printed pages."""


def play_live(game: Game, terminal: Terminal, colors: Colors) -> None:
    """Play until `q` is pressed. The terminal is restored however the game ends."""
    page = Page(colors)
    with terminal:
        while True:
            columns, rows = terminal.size
            terminal.show(page.lines(game, columns, rows))
            key = terminal.key(PACE if game.autoplay else None)
            if key is None:
                game.step()
                continue
            command = None if key == RESIZED else KEYS.get(key)
            if command == Command.QUIT:
                return
            if command == Command.SUSPEND:
                terminal.suspend()
            elif command is not None:
                game.handle(command)


def play_keys(
    game: Game,
    commands: Sequence[Command],
    show: Callable[[list[str]], None],
    *,
    colors: Colors,
    size: tuple[int, int] = DEFAULT_SIZE,
) -> None:
    """Play a given sequence of commands: a page before the first, and one after each.

    Args:
        game: The game.
        commands: The commands; a walk that the guide takes over is walked to its end.
        show: Called with each page.
        colors: What to draw with.
        size: Columns and rows of a page.
    """
    page = Page(colors)
    show(page.lines(game, *size))
    for command in commands:
        if command == Command.QUIT:
            return
        game.handle(command)
        show(page.lines(game, *size))
        while game.autoplay:
            game.step()
            show(page.lines(game, *size))
