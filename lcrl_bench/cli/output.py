"""What a command prints: results on stdout, messages on stderr.

A result is a table or, with `--json`, one JSON object. There is no colour if `NO_COLOR` is set or
the stream is not a terminal; progress bars are shown on a terminal only.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import shlex
import sys
from collections.abc import Collection, Iterator, Sequence
from typing import Any, TextIO

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

UNWRAPPED_WIDTH = 10_000
"""Width in characters of a table in a file or a pipe, so that its rows never wrap."""


def print_json(value: dict[str, Any]) -> None:
    """Print one JSON object on stdout (sorted keys, indented).

    Raises:
        ValueError: If `value` contains a NaN or an infinity, which JSON lacks.
    """
    print(json.dumps(value, indent=2, sort_keys=True, allow_nan=False))


def print_text(text: str) -> None:
    """Print plain text on stdout, as it is."""
    print(text)


def print_table(
    columns: Sequence[str],
    rows: Sequence[Sequence[object]],
    *,
    title: str | None = None,
    right: Collection[str] = (),
) -> None:
    """Print a table on stdout.

    Args:
        columns: Headings.
        rows: One sequence of cells per row, each printed with `str`.
        title: Shown above the table.
        right: Headings of the columns aligned to the right (numbers).
    """
    table = Table(
        title=title, title_justify="left", box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False
    )
    for column in columns:
        table.add_column(column, justify="right" if column in right else "left")
    for row in rows:
        table.add_row(*(Text(str(cell)) for cell in row))
    width = None if sys.stdout.isatty() else UNWRAPPED_WIDTH
    Console(file=sys.stdout, width=width, highlight=False).print(table)


def say(message: str, *, style: str | None = None) -> None:
    """Tell the person something on stderr, never folded; `style` is a rich style (`"bold red"`)."""
    Console(file=sys.stderr, highlight=False, soft_wrap=True).print(
        Text(message, style=style or "")
    )


def warn(message: str) -> None:
    """Print a warning on stderr: `warning: software renderer ...`."""
    say(f"warning: {message}", style="bold yellow")


def suggest(words: Sequence[str], purpose: str) -> None:
    """Suggest the next command on stderr, quoted for the shell."""
    say(f"next: {shlex.join(words)}   # {purpose}", style="dim")


def bars_wanted() -> bool:
    """Whether to draw progress bars: only if stderr is a terminal.

    For `tqdm(..., disable=not bars_wanted())`.
    """
    return sys.stderr.isatty()


@contextlib.contextmanager
def stdout_kept_clean(wanted: bool = True) -> Iterator[None]:
    """Redirect everything the block prints on stdout to stderr, even from C libraries.

    A command with `--json` works inside this block and prints its object afterwards, so that no
    library's message can corrupt it.
    """
    if not wanted:
        yield
        return
    with contextlib.redirect_stdout(sys.stderr), _file_descriptor_redirected():
        yield


@contextlib.contextmanager
def _file_descriptor_redirected() -> Iterator[None]:
    out, err = sys.__stdout__, sys.__stderr__
    target, source = _file_descriptor(out), _file_descriptor(err)
    if out is None or target is None or source is None:
        yield
        return
    out.flush()
    kept = os.dup(target)
    try:
        os.dup2(source, target)
        yield
    finally:
        os.dup2(kept, target)
        os.close(kept)


def _file_descriptor(stream: TextIO | None) -> int | None:
    # None if the stream is closed, or replaced by a program that embeds this one.
    try:
        return None if stream is None else stream.fileno()
    except (OSError, ValueError, io.UnsupportedOperation):
        return None
