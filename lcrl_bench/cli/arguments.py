"""Flags of a verb: a frozen dataclass, whose fields' docstrings are the `--help` text."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from typing import TypeVar

import tyro

Config = TypeVar("Config")


def parse_arguments(
    config: type[Config], argv: Sequence[str], *, verb: str, description: str | None = None
) -> Config:
    """Parse a verb's flags into its dataclass.

    Args:
        config: The dataclass; its docstring is the description unless one is given.
        argv: Words after the verb.
        verb: The verb's name, for the usage line.
        description: Shown above the flags.

    Raises:
        SystemExit: 0 after `--help` (on stdout), 2 after a usage error (on stderr).
    """
    with _colour_only_if_wanted():
        return tyro.cli(
            config,
            prog=f"lcrl-bench {verb}",
            args=list(argv),
            description=description,
            config=(tyro.conf.OmitArgPrefixes, tyro.conf.FlagCreatePairsOff),
        )


@contextlib.contextmanager
def _colour_only_if_wanted() -> Iterator[None]:
    # tyro knows TERM=dumb but not NO_COLOR.
    if "NO_COLOR" not in os.environ:
        yield
        return
    kept = os.environ.get("TERM")
    os.environ["TERM"] = "dumb"
    try:
        yield
    finally:
        if kept is None:
            del os.environ["TERM"]
        else:
            os.environ["TERM"] = kept
