"""All errors that the suite raises on purpose, and the exit codes of its commands.

Each class builds its own message from its fields: the offending value and file, what is valid, and
the next step. Modules raise the most specific class; a command catches `LcrlError` once, prints
the message on stderr and exits with the class's `exit_code`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import IntEnum
from pathlib import Path


class ExitCode(IntEnum):
    """Exit codes of all commands."""

    DONE = 0
    """All requested work was done, and is valid."""
    RED = 1
    """The command ran, but a check failed or an input was rejected."""
    USAGE = 2
    """An unknown flag, name or value."""
    BUG = 3
    """An internal error; the traceback is in a log file named on stderr."""
    ENVIRONMENT = 4
    """A missing extra, no usable renderer, a file whose hash does not match, or a folder in use."""
    EMPTY = 5
    """Nothing was selected."""
    INTERRUPTED = 130
    """Stopped by Ctrl-C; state is saved and the resume command printed."""
    TERMINATED = 143
    """Stopped by SIGTERM; state is saved and the resume command printed."""


class LcrlError(Exception):
    """Base of all errors raised on purpose; commands return its `exit_code`."""

    exit_code: ExitCode = ExitCode.RED


class UnknownNameError(LcrlError):
    """A name that is not registered: suggests the nearest and lists the valid ones."""

    exit_code = ExitCode.USAGE

    def __init__(self, kind: str, name: str, valid: Iterable[str]) -> None:
        self.kind, self.name, self.valid = kind, name, sorted(valid)
        near = difflib.get_close_matches(name, self.valid, n=1)
        hint = f" Did you mean '{near[0]}'?" if near else ""
        listing = ", ".join(self.valid) or "none"
        super().__init__(f"Unknown {kind} '{name}'.{hint} Valid: {listing}.")


class DuplicateNameError(LcrlError):
    """A name registered twice."""

    exit_code = ExitCode.USAGE

    def __init__(self, kind: str, name: str) -> None:
        self.kind, self.name = kind, name
        super().__init__(
            f"{kind.capitalize()} '{name}' is already registered; choose another name."
        )


class InvalidNameError(LcrlError):
    """An identifier that breaks the suite's rule for names."""

    exit_code = ExitCode.USAGE

    def __init__(self, kind: str, name: str, rule: str) -> None:
        self.kind, self.name = kind, name
        super().__init__(f"{kind.capitalize()} name {name!r} is not valid: {rule}.")


class UsageError(LcrlError):
    """A flag, a value or a combination of flags that can't be carried out."""

    exit_code = ExitCode.USAGE


class InvalidFileError(LcrlError):
    """A file that can't be used: names the file, the place in it, the reason and the next step."""

    def __init__(self, path: Path | str, reason: str, *, where: str = "", fix: str = "") -> None:
        self.path, self.reason, self.where, self.fix = str(path), reason, where, fix
        place = f" at {where}" if where else ""
        advice = f" {fix}" if fix else ""
        super().__init__(f"{self.path}: {reason}{place}.{advice}")


class InvalidHouseError(LcrlError):
    """An invalid house (see `houses.validation`)."""

    def __init__(self, house: str, reason: str, *, where: str = "", fix: str = "") -> None:
        self.house, self.reason, self.where, self.fix = house, reason, where, fix
        place = f" ({where})" if where else ""
        advice = f" {fix}" if fix else ""
        super().__init__(f"House '{house}': {reason}{place}.{advice}")


class EnvironmentMissingError(LcrlError):
    """The machine lacks something: a renderer, a device, an optional package."""

    exit_code = ExitCode.ENVIRONMENT


class FolderInUseError(LcrlError):
    """A folder that another process is writing."""

    exit_code = ExitCode.ENVIRONMENT

    def __init__(self, folder: Path | str, holder: str, *, fix: str) -> None:
        self.folder, self.holder = str(folder), holder
        super().__init__(f"{folder} is being written by {holder}. {fix}")


class IntegrityError(LcrlError):
    """A shipped or stored file whose content doesn't match its recorded hash."""

    exit_code = ExitCode.ENVIRONMENT

    def __init__(self, path: Path | str, expected: str, found: str, *, fix: str) -> None:
        self.path, self.expected, self.found = str(path), expected, found
        super().__init__(f"{path}: expected SHA-256 {expected}, found {found}. {fix}")


class NothingSelectedError(LcrlError):
    """A selection that matches nothing."""

    exit_code = ExitCode.EMPTY
