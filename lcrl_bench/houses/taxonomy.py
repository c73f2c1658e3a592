"""`Taxonomy`: maps a source's labels to the 61 classes, and its words to room types.

One TOML file per source in `assets/taxonomies/`: a table `[labels]` (source label = class name)
and a table `[rooms]` (word = room type). Objects of the class `"void"` are left out.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.classes import class_names
from lcrl_bench.houses.house import RoomType

FALLBACK = "small_object"
"""Class of objects with unknown labels."""

DROPPED = "void"
"""Class of objects that are left out of the house."""


@dataclass(frozen=True)
class Taxonomy:
    """The classes and room types that a source's words mean."""

    name: str
    labels: dict[str, str]
    """Source label → class name."""
    rooms: dict[str, RoomType]
    """Lower-case word → room type."""

    def classify(self, label: str) -> str | None:
        """The class of a source label; None if the taxonomy does not know it.

        Case, spaces and underscores are ignored, and class names mean themselves:
        `"DiningTable"`, `"dining table"` and `"dining_table"` are the same.
        """
        if label in self.labels:
            return self.labels[label]
        return _folded_labels(self.name).get(_fold(label))

    def room_type(self, text: str) -> RoomType:
        """The room type that free text means: by its last known word, else its nearest.

        `"LivingRoom"` and `"cosy living room"` are living rooms; `"baby food storage"` is a room.
        """
        words = re.findall(r"[a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", text[:200]).lower())
        for word in reversed(words):
            if word in self.rooms:
                return self.rooms[word]
        for word in reversed(words):
            near = difflib.get_close_matches(word, self.rooms, n=1, cutoff=0.8)
            if near:
                return self.rooms[near[0]]
        return RoomType.OTHER


def _fold(label: str) -> str:
    return re.sub(r"[\s_-]+", "", label).lower()


@lru_cache(maxsize=8)
def _folded_labels(name: str) -> dict[str, str]:
    own = {_fold(known): known for known in class_names()}
    return own | {_fold(label): known for label, known in load_taxonomy(name).labels.items()}


@lru_cache(maxsize=8)
def load_taxonomy(name: str) -> Taxonomy:
    """The taxonomy of the source named `name`.

    Raises:
        InvalidFileError: If a label maps to an unknown class, or a word to an unknown room type.
    """
    file = resources.files("lcrl_bench.assets").joinpath("taxonomies", f"{name}.toml")
    rows = tomllib.loads(file.read_text("utf-8"))
    for label, known in rows["labels"].items():
        if known not in class_names():
            reason = f"'{known}' is not one of the 61 classes"
            raise InvalidFileError(str(file), reason, where=label, fix="See assets/classes.toml.")
    try:
        rooms = {word: RoomType(value) for word, value in rows["rooms"].items()}
    except ValueError as error:
        fix = f"Room types: {', '.join(RoomType)}."
        raise InvalidFileError(str(file), str(error), where="rooms", fix=fix) from error
    return Taxonomy(name, rows["labels"], rooms)
