"""The rule for identifiers of houses, rooms, objects, tasks, methods and benchmarks."""

from __future__ import annotations

import re
from typing import Final

from lcrl_bench.errors import InvalidNameError

LONGEST: Final = 80
"""Maximum length of an identifier."""

NAME: Final = re.compile(r"[a-z0-9][a-z0-9_.-]{0,79}")
"""Lower-case letters, digits and `_ . -`, starting with a letter or digit, at most 80 long."""

RULE: Final = (
    "use 1 to 80 lower-case letters, digits, '_', '-' or '.', starting with a letter or digit, "
    "without '..'"
)


def check_name(kind: str, name: str) -> str:
    """Return `name` if it is a valid identifier.

    Args:
        kind: What is named, for the message (`"house"`, `"method"`).
        name: The identifier.

    Raises:
        InvalidNameError: If `name` breaks the rule.
    """
    if NAME.fullmatch(name) is None or ".." in name:
        raise InvalidNameError(kind, name, RULE)
    return name


def slug(text: str) -> str:
    """Turn free text into a valid identifier: `"Bed|4|0"` becomes `"bed-4-0"`."""
    words = re.sub(r"[^a-z0-9_.-]+", "-", text.lower()).strip("-._")
    return re.sub(r"\.{2,}", ".", words)[:LONGEST] or "unnamed"


class Identifiers:
    """Makes unique identifiers from free text, deterministically in the order of the texts."""

    def __init__(self) -> None:
        self._taken: set[str] = set()
        self._next: dict[str, int] = {}

    def unique(self, text: str) -> str:
        """A new identifier for `text`: its slug, followed by `-2`, `-3`, ... if that is taken."""
        stem = slug(text)
        name = stem
        while name in self._taken:
            number = self._next.get(stem, 2)
            self._next[stem] = number + 1
            suffix = f"-{number}"
            name = stem[: LONGEST - len(suffix)] + suffix
        self._taken.add(name)
        return name
