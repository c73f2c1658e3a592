"""The preset grammar of commands: "go to the X" and "move the X to the Y".

Source: paper, section "Environment": "We generate language commands based on a preset grammar [...]
of the form 'go to X' for NAV tasks, or 'move X to Y' for PICK tasks, where X and Y stand for names
of locations and objects within the environment."
"""

from __future__ import annotations

import re

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.houses.house import RoomType

NAMED_ROOMS = tuple(kind for kind in RoomType if kind not in {RoomType.OTHER})
"""Room types a command can name."""

NAMED_GROUPS = frozenset({"furniture", "appliance", "fixture", "decor", "task"})
"""Groups of classes a command can name."""

UNNAMED_CLASSES = frozenset({"small_object", "heater_ac"})
"""Catch-all classes, and classes nobody would name in a command."""


def nav_command(target: str) -> str:
    """The command to go to a target, given its words: `"go to the dining table"`."""
    return f"go to the {target}"


def pick_command(thing: str, target: str) -> str:
    """The command to move a thing to a target: `"move the cup to the living room"`."""
    return f"move the {thing} to the {target}"


def named_classes() -> tuple[str, ...]:
    """Names of the classes a command can name, by id."""
    return tuple(
        entry.name
        for entry in semantic_classes()
        if entry.group in NAMED_GROUPS and entry.name not in UNNAMED_CLASSES
    )


def words_of(name: str) -> str:
    """The words of a class or room name: `"dining_table"` becomes `"dining table"`."""
    return name.replace("_", " ")


def tokens(command: str) -> tuple[str, ...]:
    """The lower-case words of a command, without punctuation."""
    return tuple(re.findall(r"[a-z0-9]+", command.lower()))
