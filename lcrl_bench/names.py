"""The one rule for identifiers of houses, rooms, objects, tasks, methods and benchmarks."""

from __future__ import annotations

import re
from typing import Final

from lcrl_bench.errors import InvalidNameError

NAME: Final = re.compile(r"[a-z0-9][a-z0-9_.-]{0,79}")
"""Lower-case letters, digits and `_ . -`, starting with a letter or digit, at most 80 long."""

RULE: Final = (
    "use 1 to 80 lower-case letters, digits, '_', '-' or '.', starting with a letter or digit, "
    "without '..'"
)


def check_name(kind: str, name: str) -> str:
    """Return `name` if it is a valid identifier.

    Args:
        kind: What the name is of, for the message (`"house"`, `"method"`).
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
    return re.sub(r"\.{2,}", ".", words)[:80] or "unnamed"
