"""`Panoramas`: everything seen in a house, each distinct view once.

A panorama is four views: north, east, south, west. Many panoramas share views (a wall seen from two
tiles, a room without the moved object), so each view is stored once, and networks run over distinct
views only.

Source: Fu et al. (2019), appendix "Observation Caching".
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.drawn_array import DrawnArray
from lcrl_bench.storage import sha256_of

CLASSES: Final = 61
"""Number of semantic classes: a pixel is one of 0 .. 60."""


class Panorama(DrawnArray):
    """What is seen from one tile: uint8 [4, height, width] class ids, the views N, E, S, W."""

    drawing = "lcrl_bench.recording.drawings:draw_panorama"


@dataclass(frozen=True, eq=False)
class Panoramas:
    """The panoramas of one house, as indices of its distinct views.

    Example:
        >>> panoramas = lcrl_bench.load_benchmark("mini").scene("procedural-1000000").panoramas()
        >>> panoramas.pixels(0).shape
        (4, 24, 32)
    """

    views: torch.Tensor
    """uint8 [view, height, width]: class ids, each distinct view once."""
    panorama_views: torch.Tensor
    """int64 [panorama, 4]: the views to the north, east, south and west."""
    house: str = ""
    """The house's id in training; a digest of the views when a learned reward or policy is called,
    as a cache key for what depends on the views alone."""

    @classmethod
    def build(cls, panoramas: Iterable[NDArray[np.uint8]], *, house: str = "") -> Panoramas:
        """Collect panoramas, keeping each view once, in order of appearance.

        Args:
            panoramas: Each [4, height, width], or batches [panorama, 4, height, width], all of
                one size.
            house: The house's id.

        Raises:
            ValueError: If there is no panorama, or sizes differ.
        """
        index: dict[bytes, int] = {}
        rows: list[NDArray[np.int64]] = []
        shape: tuple[int, ...] = ()
        for batch in panoramas:
            shape = shape or batch.shape[-2:]
            if batch.shape[-2:] != shape:
                raise ValueError(f"panoramas are of one size, not {shape} and {batch.shape[-2:]}")
            found = [index.setdefault(view.tobytes(), len(index)) for view in _views(batch)]
            rows.append(np.array(found, np.int64).reshape(-1, 4))
        if not index:
            raise ValueError("at least one panorama is needed")
        views = np.frombuffer(b"".join(index), np.uint8).reshape(-1, *shape).copy()
        return cls(torch.from_numpy(views), torch.from_numpy(np.concatenate(rows)), house)

    @classmethod
    def from_arrays(
        cls, views: NDArray[np.uint8], panorama_views: NDArray[np.integer], *, house: str = ""
    ) -> Panoramas:
        """Wrap arrays of the fields' shapes, without copying if possible."""
        rows = torch.from_numpy(panorama_views.astype(np.int64, copy=False))
        return cls(torch.from_numpy(views), rows, house)

    @classmethod
    def joined(cls, parts: Sequence[Panoramas]) -> Panoramas:
        """The panoramas of all parts, one part after the other; the house is that of the first."""
        index: dict[bytes, int] = {}
        rows = []
        for part in parts:
            found = [index.setdefault(view.tobytes(), len(index)) for view in part.views.numpy()]
            rows.append(torch.tensor(found)[part.panorama_views])
        views = np.frombuffer(b"".join(index), np.uint8).reshape(-1, *parts[0].views.shape[1:])
        return cls(torch.from_numpy(views.copy()), torch.cat(rows), parts[0].house)

    def chosen(self, panoramas: NDArray[np.int64]) -> Panoramas:
        """Some of the panoramas, as if only these had been collected.

        Args:
            panoramas: Their numbers, [chosen].
        """
        rows = self.panorama_views.numpy()[panoramas]
        views, first, places = np.unique(rows, return_index=True, return_inverse=True)
        order = np.argsort(first)
        kept = self.views[torch.from_numpy(views[order])]
        return Panoramas(
            kept, torch.from_numpy(np.argsort(order)[places].reshape(-1, 4)), self.house
        )

    def __len__(self) -> int:
        """Number of panoramas."""
        return len(self.panorama_views)

    def to(self, device: torch.device | str) -> Panoramas:
        """The panoramas on another device; `self` if they are already there."""
        if self.views.device == torch.device(device):
            return self
        return replace(
            self, views=self.views.to(device), panorama_views=self.panorama_views.to(device)
        )

    def pixels(self, panorama: int) -> NDArray[np.uint8]:
        """The views N, E, S, W of one panorama, a copy: [4, height, width] class ids."""
        views, rows = self._arrays
        return views[rows[panorama]]

    @cached_property
    def _arrays(self) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
        """Views and panoramas as arrays, which makes single look-ups several times faster."""
        return self.views.cpu().numpy(), self.panorama_views.cpu().numpy()

    @property
    def classes(self) -> int:
        """Number of semantic classes."""
        return CLASSES

    def class_shares(self) -> torch.Tensor:
        """Fraction of each panorama's pixels per class: float32 [panorama, class].

        Rows sum to 1.
        """
        counts = self.class_counts().to(torch.float32)
        return counts / counts.sum(1, keepdim=True)

    def class_counts(self) -> torch.Tensor:
        """Pixels of each panorama per class: int64 [panorama, class]."""
        flat = self.views.flatten(1).long()
        counts = torch.zeros(len(flat), CLASSES, dtype=torch.int64, device=flat.device)
        counts.scatter_add_(1, flat, torch.ones_like(flat))
        return counts[self.panorama_views].sum(1)

    @cached_property
    def observed(self) -> ObservedHouse:
        """What a learned reward or policy is shown of the house."""
        return ObservedHouse.of(self)


@dataclass(frozen=True, eq=False)
class ObservedHouse:
    """The distinct panoramas of a house, without anything that reveals where they are seen.

    Indices and order could reveal that: in a house's own numbering, the index of a panorama tells
    where the object is. So each distinct panorama is kept once, whatever its tile or task, sorted
    by a digest of its pixels, and the house is named by a digest of its views.
    """

    views: Panoramas
    """Distinct views and panoramas, both sorted by digest."""
    place: torch.Tensor
    """int64 [panorama of the house]: its index in `views`; -1 if it is not shown."""

    @classmethod
    def of(cls, house: Panoramas, chosen: torch.Tensor | None = None) -> ObservedHouse:
        """Drop the numbering of a house.

        Args:
            house: The house.
            chosen: int64 [chosen]: panoramas to show; None for all. Views that only
                other panoramas have are dropped.
        """
        device = house.views.device
        sides = house.panorama_views if chosen is None else house.panorama_views[chosen]
        pixels = house.views.cpu().numpy()
        names = {k: sha256_of(pixels[k].tobytes()) for k in torch.unique(sides).tolist()}
        # Equal views count as one, whatever their numbers.
        views = {names[k]: k for k in names}
        order = {name: number for number, name in enumerate(sorted(views))}
        rows = sides.tolist()
        seen = [sha256_of("".join(names[k] for k in row).encode()) for row in rows]
        first = {name: row for name, row in zip(seen, rows, strict=True)}
        number = {name: k for k, name in enumerate(sorted(first))}
        shown = Panoramas(
            views=house.views[torch.tensor([views[name] for name in order], device=device)],
            panorama_views=torch.tensor(
                [[order[names[k]] for k in first[name]] for name in number], device=device
            ),
            house=sha256_of("".join(number).encode()),
        )
        place = torch.full((len(house),), -1, device=device)
        numbers = torch.tensor([number[name] for name in seen], device=device)
        place[slice(None) if chosen is None else chosen] = numbers
        return cls(shown, place)

    def show(self) -> Panoramas:
        """Copies of the panoramas for a method, which may modify them."""
        views = self.views
        return Panoramas(views.views.clone(), views.panorama_views.clone(), views.house)


def _views(batch: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if batch.dtype != np.uint8 or batch.ndim not in (3, 4) or batch.shape[-3] != 4:
        found = f"{batch.dtype}{list(batch.shape)}"
        raise ValueError(f"a panorama is uint8[4, height, width], not {found}")
    return batch.reshape(-1, *batch.shape[-2:])
