"""A generic registry for house sources, methods and benchmarks.

An entry is a name and the location of its value (`"package.module:attribute"`), so listing names
imports nothing heavy; the value is imported on first use.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from lcrl_bench.errors import DuplicateNameError, UnknownNameError, UsageError
from lcrl_bench.names import check_name

T = TypeVar("T")


@dataclass(frozen=True)
class Entry:
    """A registered name: the location of its value, and a one-line summary."""

    name: str
    target: str
    """`"package.module:attribute"`."""
    summary: str


@dataclass
class Registry(Generic[T]):
    """Names of one kind, each resolved to its value on demand."""

    kind: str
    entries: dict[str, Entry] = field(default_factory=dict)

    def register(self, name: str, target: str, *, summary: str) -> None:
        """Add an entry.

        Raises:
            InvalidNameError: If `name` is not a valid identifier.
            DuplicateNameError: If `name` is taken.
        """
        check_name(self.kind, name)
        if name in self.entries:
            raise DuplicateNameError(self.kind, name)
        self.entries[name] = Entry(name, target, summary)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self.entries[name] for name in sorted(self.entries))

    def __contains__(self, name: str) -> bool:
        return name in self.entries

    def get(self, name: str) -> T:
        """Import and return the value registered as `name`.

        Raises:
            UnknownNameError: If nothing is registered under `name`.
            UsageError: If its module or attribute does not exist.
        """
        if name not in self.entries:
            raise UnknownNameError(self.kind, name, self.entries)
        return import_target(self.entries[name].target)


def import_target(target: str) -> Any:  # noqa: ANN401 - the value's type is the caller's to know
    """Import `"package.module:attribute"`.

    Raises:
        UsageError: If the module or the attribute does not exist.
    """
    module_name, _, attribute = target.partition(":")
    try:
        return getattr(importlib.import_module(module_name), attribute)
    except ModuleNotFoundError as error:
        if error.name is not None and not module_name.startswith(error.name):
            raise
        raise UsageError(f"No module '{module_name}' (wanted for '{target}').") from error
    except AttributeError as error:
        raise UsageError(f"Module '{module_name}' has no '{attribute}'.") from error
