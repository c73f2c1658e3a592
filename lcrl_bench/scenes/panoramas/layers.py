"""Depth compositing: the still house and each movable object are drawn once, and put together.

The still house is a depth and a class per pixel. A movable object is a `Layer`: only the pixels
where it is nearer than the still house. An arrangement hides one object and may show it elsewhere,
so it differs from the original one only at the pixels of these two layers, where the next nearest
layer shows instead, or the still house.

A layer decides where its object is in front of the still house, at equal depths too; of objects at
equal depths, the first among the layers is seen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

_NOTHING: Final = -1
"""The number of no object."""


@dataclass(frozen=True, eq=False)
class StillHouse:
    """What is seen without any movable object."""

    depths: NDArray[np.float32]
    """[panorama, pixel]: depth from the near plane, metres."""
    classes: NDArray[np.uint8]
    """[panorama, pixel]: class id."""


@dataclass(frozen=True, eq=False)
class Layer:
    """Where an object is in front of the still house, and what it shows there."""

    pixels: NDArray[np.int64]
    """[hit]: index into all pixels of all panoramas, `panorama * pixels + pixel`, each once."""
    depths: NDArray[np.float32]
    """[hit]: depth, smaller if nearer."""
    classes: NDArray[np.uint8]
    """[hit]: class id."""


class Composition:
    """The panoramas of a house, put together from layers.

    Attributes:
        found: uint8 [panorama, pixel], the class ids with every object at its original place.
    """

    def __init__(self, still: NDArray[np.uint8], layers: Mapping[str, Layer]) -> None:
        """Sort the layers by pixel and depth.

        Args:
            still: [panorama, pixel] class ids of the still house.
            layers: The movable objects at their original places, by id.
        """
        self._still = still.reshape(-1)
        self._numbers = {name: number for number, name in enumerate(layers)}
        parts = tuple(layers.values())
        owners = np.repeat(np.arange(len(parts)), [len(part.pixels) for part in parts])
        every = joined(parts)
        order = np.lexsort((owners, every.depths, every.pixels))
        # The last entry belongs to no pixel and no object, so that every search ends at one.
        self._owners = np.append(owners[order], _NOTHING)
        self._pixels = np.append(every.pixels[order], np.iinfo(np.int64).max)
        self._hits, self._seen = every.depths[order], every.classes[order]
        self._nearest = np.diff(self._pixels, prepend=-1) != 0
        self._nearest[-1] = False
        self.found = still.copy()
        self.found.reshape(-1)[self._pixels[self._nearest]] = self._seen[self._nearest[:-1]]

    def change(
        self, hidden: str | None, placed: Layer | None = None
    ) -> tuple[NDArray[np.int64], NDArray[np.uint8]]:
        """What hiding an object, and showing it elsewhere, changes.

        Args:
            hidden: Id of the object that is not at its original place; None if all are.
            placed: The object where it is now; None if it is invisible.

        Returns:
            The panoramas that change, int64 [changed], and their class ids, uint8 [changed, pixel].
        """
        number = _NOTHING if hidden is None else self._numbers.get(hidden, _NOTHING)
        pixels = self._pixels[self._nearest & (self._owners == number)]
        shown = self._still[pixels]
        entries, covered = self._behind(pixels, number)
        shown[covered] = self._seen[entries[covered]]
        if placed is not None:
            front = self._in_front(placed, number)
            # Later entries win, as they are written last.
            pixels = np.concatenate([pixels, placed.pixels[front]])
            shown = np.concatenate([shown, placed.classes[front]])
        size = self.found.shape[1]
        changed, row = np.unique(pixels // size, return_inverse=True)
        views = self.found[changed]
        views[row, pixels % size] = shown
        return changed, views

    def _in_front(self, placed: Layer, number: int) -> NDArray[np.bool_]:
        """[hit]: whether an object with this number is seen there, before all others."""
        entries, covered = self._behind(placed.pixels, number)
        depths, front = placed.depths[covered], ~covered
        others, owners = self._hits[entries[covered]], self._owners[entries[covered]]
        front[covered] = (depths < others) | ((depths == others) & (number < owners))
        return front

    def _behind(
        self, pixels: NDArray[np.int64], number: int
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """The nearest entry at each pixel without one of the objects, and whether there is one."""
        entries = np.searchsorted(self._pixels, pixels)
        # A pixel has at most one entry per object.
        entries += self._belongs(entries, pixels) & (self._owners[entries] == number)
        return entries, self._belongs(entries, pixels)

    def _belongs(self, entries: NDArray[np.int64], pixels: NDArray[np.int64]) -> NDArray[np.bool_]:
        return self._pixels[entries] == pixels


def joined(layers: Sequence[Layer]) -> Layer:
    """Several layers, one after the other."""
    return Layer(
        np.concatenate([np.empty(0, np.int64), *(layer.pixels for layer in layers)]),
        np.concatenate([np.empty(0, np.float32), *(layer.depths for layer in layers)]),
        np.concatenate([np.empty(0, np.uint8), *(layer.classes for layer in layers)]),
    )
