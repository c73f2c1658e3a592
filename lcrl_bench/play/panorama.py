"""The four views joined into one picture, the view ahead in the middle.

From left to right: the right half of what is behind, left, ahead, right, the left half of what is
behind. Turning moves it by a quarter.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import HEADINGS

STRUCTURE: Final = "structure"
"""The group of classes of the building itself."""
EMPTY_LETTERS: Final = {"void": " ", "wall": " ", "ceiling": " ", "floor": "."}
"""Classes that are everywhere; every other has a letter or a digit."""
_SPARE: Final = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"


def join_views(views: NDArray[np.uint8], heading: int) -> NDArray[np.uint8]:
    """The views side by side, as the agent turns.

    Args:
        views: uint8 [4, row, column] class ids, views N, E, S, W.
        heading: 0..3, where the agent faces.

    Returns:
        uint8 [row, 4 * column], the view ahead in the middle.
    """
    left, ahead, right, behind = (views[(heading + turn) % HEADINGS] for turn in (-1, 0, 1, 2))
    half = behind.shape[1] // 2
    return np.concatenate([behind[:, half:], left, ahead, right, behind[:, :half]], axis=1)


def resized(classes: NDArray[np.uint8], rows: int, columns: int) -> NDArray[np.uint8]:
    """A class picture resized; where it shrinks, each pixel keeps its rarest class.

    A cup is a few pixels wide: it would be lost if pixels were merely left out.

    Args:
        classes: uint8 [row, column] class ids.
        rows: Rows of the result.
        columns: Columns of the result.
    """
    order = _rank(classes)
    (top, tall), (left, wide) = _windows(len(classes), rows), _windows(classes.shape[1], columns)
    ranks, best = order[classes], np.zeros((rows, columns), np.int64)
    for down in range(int(tall.max())):
        for across in range(int(wide.max())):
            row, column = top + np.minimum(down, tall - 1), left + np.minimum(across, wide - 1)
            best = np.maximum(best, ranks[np.ix_(row, column)])
    return np.argsort(order)[best].astype(np.uint8)


def classes_in_sight(views: NDArray[np.uint8]) -> list[tuple[int, float]]:
    """The classes of a panorama and their shares of it, things before structure, largest first."""
    counts = np.bincount(views.reshape(-1), minlength=len(semantic_classes()))
    seen = [(int(k), float(counts[k]) / views.size) for k in np.flatnonzero(counts)]
    groups = [entry.group for entry in semantic_classes()]
    return sorted(seen, key=lambda pair: (groups[pair[0]] == STRUCTURE, -pair[1], pair[0]))


@lru_cache(maxsize=1)
def class_letters() -> tuple[str, ...]:
    """A letter or digit of its own for each class, out of its name where one is left.

    The objects that tasks move come first, and in capitals.
    """
    entries = semantic_classes()
    letters: dict[int, str] = {
        entry.id: EMPTY_LETTERS[entry.name] for entry in entries if entry.name in EMPTY_LETTERS
    }
    for entry in sorted(entries, key=lambda entry: (entry.group != "task", entry.id)):
        if entry.id in letters:
            continue
        name = entry.name.replace("_", "")
        wanted = name.upper() + name if entry.group == "task" else name + name.upper()
        taken = set(letters.values())
        letters[entry.id] = next(letter for letter in wanted + _SPARE if letter not in taken)
    return tuple(letters[entry.id] for entry in entries)


def lettered(classes: NDArray[np.uint8]) -> list[str]:
    """A class picture in letters, one line per row."""
    letters = class_letters()
    return ["".join(letters[number] for number in row) for row in classes.tolist()]


def _rank(classes: NDArray[np.uint8]) -> NDArray[np.int64]:
    """[class]: structure lowest, things above it; of both the rarer is the higher."""
    entries = semantic_classes()
    counts = np.bincount(classes.reshape(-1), minlength=len(entries))
    things = np.array([entry.group != STRUCTURE for entry in entries])
    ranks = np.empty(len(entries), np.int64)
    ranks[np.lexsort((np.arange(len(entries)), -counts, things))] = np.arange(len(entries))
    return ranks


def _windows(size: int, wanted: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First source pixel and number of source pixels per pixel of the result; at least one."""
    edges = np.arange(wanted + 1) * size // wanted
    return edges[:-1], np.maximum(np.diff(edges), 1)
