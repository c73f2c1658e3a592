"""Command-line parsing: verbs, sub-verbs, and flags as frozen dataclasses.

The docstrings of a dataclass's fields are the `--help` text.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TypeVar

from lcrl_bench.cli.output import print_text, say
from lcrl_bench.cli.values import check_values
from lcrl_bench.errors import ExitCode, UnknownNameError, UsageError

Verb = Callable[[Sequence[str]], int]
"""Takes the words after its name, returns an exit code."""

Config = TypeVar("Config")


def run_verb(
    argv: Sequence[str],
    verbs: Mapping[str, Verb],
    *,
    kind: str,
    help_text: str,
    moved: Mapping[str, str] = MappingProxyType({}),
) -> int:
    """Run the verb that the first word names, over the words after it.

    Args:
        argv: The words of the command.
        verbs: Verbs by name.
        kind: What they are called in the message (`"house verb"`).
        help_text: Shown on stdout if it is asked for, and on stderr if no verb is given.
        moved: Former verbs, and the command of a checkout that each has become.

    Raises:
        UnknownNameError: If the first word is no verb.
        UsageError: If it is a former verb.
    """
    if not argv:
        say(help_text)
        return ExitCode.USAGE
    if argv[0] in ("-h", "--help"):
        print_text(help_text)
        return ExitCode.DONE
    if argv[0] in moved:
        raise UsageError(
            f"The {kind} '{argv[0]}' is no longer part of the package: run `{moved[argv[0]]}` "
            "in a checkout of the repository."
        )
    if argv[0] not in verbs:
        raise UnknownNameError(kind, argv[0], verbs)
    return verbs[argv[0]](argv[1:])


def parse_arguments(
    config: type[Config],
    argv: Sequence[str],
    *,
    verb: str = "",
    program: str = "lcrl-bench",
    description: str | None = None,
) -> Config:
    """Parse a verb's flags into its dataclass.

    Args:
        config: The dataclass; its docstring is the description unless one is given.
        argv: Words after the verb.
        verb: The verb's name, for the usage line; empty for a program without verbs.
        program: The program's name, for the usage line.
        description: Shown above the flags.

    Raises:
        SystemExit: 0 after `--help` (on stdout), 2 after a usage error (on stderr).
        UsageError: If `check_values` refuses a value.
        UnknownNameError: If it doesn't know a name.
    """
    # Imported late: finding and listing verbs needs no parser.
    import tyro

    with _colour_only_if_wanted():
        flags = tyro.cli(
            config,
            prog=f"{program} {verb}".rstrip(),
            args=list(argv),
            description=description,
            config=(tyro.conf.OmitArgPrefixes, tyro.conf.FlagCreatePairsOff),
        )
    check_values(flags)
    return flags


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
