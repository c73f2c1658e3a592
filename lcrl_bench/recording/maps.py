"""Maps over a house: a number and its colour per tile and per place of the object.

The paper's figures show two of a PICK task's three object states, before and after the object is
taken; in the third, the object at B, a reward on observations pays for success.

Low is red and high is blue, as in the paper (appendix "Learned Rewards and Qualitative Results"),
with light grey in the middle: people with any common colour deficiency can tell red from blue.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.mdp.task_batch import HEADINGS, ObjectState
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.palette import Color

NEAR_AN_END: Final = 0.2
"""Share of a scale that counts as near one of its ends."""
LOW_TO_HIGH: Final[tuple[Color, ...]] = (
    (178, 24, 43),
    (205, 75, 70),
    (229, 131, 104),
    (246, 183, 150),
    (243, 236, 230),
    (160, 205, 227),
    (94, 166, 206),
    (48, 122, 184),
    (16, 74, 138),
)
"""Evenly spaced anchors of the diverging map.

Source: ColorBrewer RdBu, without its darkest ends.
"""

FEW_TO_MANY: Final[tuple[Color, ...]] = (
    (250, 250, 247),
    (203, 222, 240),
    (140, 187, 220),
    (72, 142, 196),
    (28, 98, 166),
    (8, 48, 107),
)
"""Evenly spaced anchors of the map of counts: paper for zero.

Source: ColorBrewer Blues, starting at paper.
"""


@dataclass(frozen=True, eq=False)
class TileMap:
    """A quantity over the tiles of a house, one layer per object state, on one scale."""

    key: str
    """Identifier: `"reward"`, `"value"`, `"visits"`, `"expert_visits"`."""
    name: str
    """In words."""
    layers: NDArray[np.float64]
    """[object state, tile]."""
    limits: tuple[float, float]
    """Ends of the scale: the smallest and the largest number of all layers."""
    visits: bool
    """Whether it counts visits: its scale starts at zero and is stretched at the low end."""
    titles: tuple[str, ...]
    """What each layer stands for; one empty title if there is one layer."""
    captions: tuple[str, ...]
    """Full name of each layer: `"value, with the cup in hand"`."""
    colors: NDArray[np.uint8]
    """[object state, tile, 3]."""
    signs: dict[str, NDArray[np.bool_]]
    """Tiles near the ends of the scale: `"+"` and `"-"` → [object state, tile].

    Both ends are dark: printed in grey, only a sign tells them apart. Visits need none.
    """

    @staticmethod
    def of(
        key: str,
        name: str,
        layers: NDArray[np.float64],
        titles: tuple[str, ...] = ("",),
        *,
        most_visits: float | None = None,
    ) -> TileMap:
        """A map whose scale spans all its layers; one of visits if their maximum is given."""
        visits = most_visits is not None
        limits = (0.0, most_visits) if visits else (float(layers.min()), float(layers.max()))
        shares = unit_interval(layers, limits)
        signs = {"+": shares >= 1 - NEAR_AN_END, "-": shares <= NEAR_AN_END}
        captions = tuple(f"{name}, {title}" if title else name for title in titles)
        return TileMap(
            key=key,
            name=name,
            layers=layers,
            limits=limits,
            visits=visits,
            titles=titles,
            captions=captions,
            colors=_visit_colors(shares) if visits else diverging(shares),
            signs={} if visits else signs,
        )

    def ramp(self, count: int) -> NDArray[np.uint8]:
        """Colours of evenly spaced numbers from one end of the scale to the other.

        Returns:
            uint8 [count, 3].
        """
        shares = np.linspace(0.0, 1.0, count)
        return _visit_colors(shares) if self.visits else diverging(shares)


def _visit_colors(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    # Waiting counts at every step; a linear scale would hide the path there.
    return rising(np.sqrt(shares))


def unit_interval(values: NDArray[np.float64], limits: tuple[float, float]) -> NDArray[np.float64]:
    """Position of values between two limits, 0..1; 0.5 if the limits coincide."""
    low, high = limits
    if high <= low:
        return np.full(np.shape(values), 0.5)
    return np.clip((np.asarray(values, np.float64) - low) / (high - low), 0.0, 1.0)


def diverging(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    """The colours of shares 0 (red) .. 1 (blue).

    Returns:
        uint8 [..., 3].
    """
    return _between(LOW_TO_HIGH, shares)


def rising(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    """The colours of shares 0 (paper) .. 1 (dark blue).

    Returns:
        uint8 [..., 3].
    """
    return _between(FEW_TO_MANY, shares)


def _between(colors: tuple[Color, ...], shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    anchors = np.array(colors, np.float64)
    positions = np.linspace(0.0, 1.0, len(anchors))
    channels = [np.interp(shares, positions, anchors[:, channel]) for channel in range(3)]
    return np.stack(channels, axis=-1).round().astype(np.uint8)


def tile_maps(episode: Episode) -> tuple[TileMap, ...]:
    """The maps that explain an episode.

    Of a learned reward: the reward and its value V_0 (best of a tile's four headings). Of a learned
    policy: `visit_maps`.
    """
    if episode.reward is None or episode.value is None:
        return visit_maps(episode)
    best = episode.value.reshape(-1, HEADINGS).max(axis=1)
    named = (("reward", "learned reward", episode.reward), ("value", "value", best))
    shape = (len(episode.parts), episode.scene.grid.tiles)
    titles = layer_titles(episode)
    return tuple(TileMap.of(key, name, array.reshape(shape), titles) for key, name, array in named)


def visit_maps(episode: Episode) -> tuple[TileMap, ...]:
    """Discounted visits of the policy and of the expert, on one scale from zero."""
    named = (
        ("visits", "visits", episode.occupancy),
        ("expert_visits", "expert's visits", episode.expert_occupancy),
    )
    known = [(key, name, array) for key, name, array in named if array is not None]
    most = max((float(array.max()) for _, _, array in known), default=0.0)
    titles = layer_titles(episode)
    shape = (len(episode.parts), episode.scene.grid.tiles)
    return tuple(
        TileMap.of(key, name, array.reshape(shape), titles, most_visits=most)
        for key, name, array in known
    )


def whole_visits(episode: Episode) -> tuple[TileMap, ...]:
    """`visit_maps` summed over object states: one layer each."""
    sums = [(tile_map, tile_map.layers.sum(axis=0)) for tile_map in visit_maps(episode)]
    most = max((float(numbers.max()) for _, numbers in sums), default=0.0)
    return tuple(
        TileMap.of(tile_map.key, tile_map.name, numbers[None], most_visits=most)
        for tile_map, numbers in sums
    )


def every_map(episode: Episode) -> tuple[TileMap, ...]:
    """The maps that explain an episode, then its visits if they are not among them."""
    maps = tile_maps(episode)
    shown = {tile_map.key for tile_map in maps}
    return (*maps, *(each for each in visit_maps(episode) if each.key not in shown))


def layer_titles(episode: Episode) -> tuple[str, ...]:
    """A title for each object state: one empty title for NAV."""
    if episode.thing is None:
        return ("",)
    thing = episode.thing_name
    titles = {
        ObjectState.AT_A: f"before the {thing} is taken",
        ObjectState.HELD: f"with the {thing} in hand",
        ObjectState.AT_B: f"after the {thing} is put",
    }
    return tuple(titles[part] for part in episode.parts)
