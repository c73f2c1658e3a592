"""The 61 semantic classes of a panorama pixel, read from `assets/classes.toml`.

Source: paper, section "Environment": "each semantic image contains 61 channels, one per semantic
image class" and "there are 14 objects".
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from lcrl_bench.errors import UnknownNameError


@dataclass(frozen=True)
class SemanticClass:
    """One of the 61 classes."""

    id: int
    """0..60: the value of a pixel."""
    name: str
    """Identifier: `dining_table`."""
    group: str
    """structure, soft, furniture, appliance, fixture, decor or task (the 14 task objects)."""
    color: tuple[int, int, int]
    """RGB for pictures, 0..255."""

    @property
    def words(self) -> str:
        """The class's name in a command: `"dining table"`."""
        return self.name.replace("_", " ")


@lru_cache(maxsize=1)
def semantic_classes() -> tuple[SemanticClass, ...]:
    """All 61 classes, by id."""
    text = resources.files("lcrl_bench.assets").joinpath("classes.toml").read_text("utf-8")
    rows = tomllib.loads(text)["class"]
    return tuple(
        SemanticClass(row["id"], row["name"], row["group"], tuple(row["color"])) for row in rows
    )


@lru_cache(maxsize=1)
def class_names() -> dict[str, int]:
    """Name → id of all 61 classes."""
    return {entry.name: entry.id for entry in semantic_classes()}


def class_id(name: str) -> int:
    """The id of the class named `name`.

    Raises:
        UnknownNameError: If none of the 61 classes has that name.
    """
    if name not in class_names():
        raise UnknownNameError("class", name, class_names())
    return class_names()[name]


@lru_cache(maxsize=1)
def task_objects() -> tuple[str, ...]:
    """Names of the 14 objects that tasks move."""
    return tuple(entry.name for entry in semantic_classes() if entry.group == "task")
