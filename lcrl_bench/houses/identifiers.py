"""Identifiers made from a source's free text: valid, unique, and the same for the same file."""

from __future__ import annotations

from lcrl_bench.names import slug

_LONGEST = 80


class Identifiers:
    """Hands out one identifier a call, never the same twice."""

    def __init__(self) -> None:
        self._taken: set[str] = set()
        self._next: dict[str, int] = {}

    def unique(self, text: str) -> str:
        """A new identifier for `text`: its slug, with `-2`, `-3`, ... where that is taken."""
        stem = slug(text)
        name = stem
        while name in self._taken:
            number = self._next.get(stem, 2)
            self._next[stem] = number + 1
            suffix = f"-{number}"
            name = stem[: _LONGEST - len(suffix)] + suffix
        self._taken.add(name)
        return name
