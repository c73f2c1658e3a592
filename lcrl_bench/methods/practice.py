"""A tiny world to try a method on: a square of tiles with things in it, drawn as rectangles.

It is a `TrainSet` like any other, made in milliseconds, with no house, renderer or file behind it.
A thing fills the views of its own tile and looks smaller along the four axes from it, behind random
clutter that no command names. A NAV task ends at the tile of the thing that its command names; a
PICK task is to take one thing to the tile of another.

    train = practice_train_set(0)
    generator, device = torch.Generator().manual_seed(0), torch.device("cpu")
    reward = MyMethod().fit(train, generator=generator, device=device, log=print)
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

import numpy as np
import torch

from lcrl_bench.mdp.expert import expert_policy, shortest_way_policy
from lcrl_bench.mdp.rollouts import sample_trajectories
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS, Action, ObjectState, TaskBatch
from lcrl_bench.methods.contract import Panoramas, TaskSet, TrainSet

SIDE: Final = 4
TILES: Final = SIDE * SIDE
THINGS: Final = {"sofa": 20, "bed": 21, "sink": 22, "cup": 50, "pan": 51, "book": 52}
"""Name -> class id."""
PLACES: Final = ("sofa", "bed", "sink")
OBJECTS: Final = ("cup", "pan", "book")
HORIZON: Final = 20
DISCOUNT: Final = 0.99
SUCCESS_REWARD: Final = 10.0
"""What the expert is paid in a state of success."""
DEMONSTRATIONS: Final = 10

_STEPS: Final = ((0, 1), (1, 0), (0, -1), (-1, 0))
"""North, east, south, west."""


def practice_train_set(seed: int, *, houses: int = 2, oracle: bool = False) -> TrainSet:
    """Tiny houses with NAV and PICK tasks, ten demonstrations each.

    Args:
        seed: Draws where things stand, the clutter, the starts and the pairs of the PICK tasks.
        houses: How many.
        oracle: Whether `goal` holds the true goals, as for a method with `oracle = True`.

    Returns:
        In each house six NAV tasks (16 cells) and three PICK tasks (48 cells), horizon 20; the
        optimal action probabilities are in it too, as for a method with `expert = True`.
    """
    rng = np.random.default_rng(seed)
    made = [_practice_house(f"tiny-{number}", rng, oracle=oracle) for number in range(houses)]
    sets = tuple(tasks for house in made for tasks in house)
    words = {word for tasks in sets for command in tasks.commands for word in command.split()}
    return TrainSet(sets, tuple(sorted(words)))


def _practice_house(name: str, rng: np.random.Generator, *, oracle: bool) -> list[TaskSet]:
    chosen = rng.choice(TILES, len(THINGS), replace=False).tolist()
    tiles = dict(zip(THINGS, chosen, strict=True))
    album = _Album(rng.integers(30, 45, size=(TILES, HEADINGS, 3)))
    everything = album.add(tiles, shown=THINGS)
    ends = np.array([tiles[thing] for thing in (*THINGS, *OBJECTS)])
    starts = (ends + rng.integers(1, TILES, size=len(ends))) % TILES * HEADINGS
    pairs = list(zip(OBJECTS, rng.permutation(PLACES).tolist(), strict=True))
    pick_panoramas = []
    for thing, place in pairs:
        gone = album.add(tiles, shown=THINGS.keys() - {thing})
        moved = album.add(tiles | {thing: tiles[place]}, shown=THINGS)
        pick_panoramas.append(everything + gone + moved)
    nav = _nav_batch(tiles, starts[: len(THINGS)])
    pick = _pick_batch([(tiles[a], tiles[b]) for a, b in pairs], starts[len(THINGS) :])
    nav_commands = tuple(f"go to the {thing}" for thing in THINGS)
    pick_commands = tuple(f"move the {a} to the {b}" for a, b in pairs)
    nav_panoramas = torch.tensor([everything] * len(THINGS))
    views = album.house_views(name)
    return [
        _demonstrated(nav, views, nav_panoramas, nav_commands, oracle=oracle),
        _demonstrated(pick, views, torch.tensor(pick_panoramas), pick_commands, oracle=oracle),
    ]


class _Album:
    """The panoramas of a house while it is drawn, each distinct view kept once."""

    def __init__(self, clutter: np.ndarray) -> None:
        self.clutter = clutter
        self.views: dict[bytes, int] = {}
        self.panoramas: list[list[int]] = []

    def add(self, tiles: dict[str, int], *, shown: Collection[str]) -> list[int]:
        """Draw all tiles with the things that stand somewhere: the new panoramas' numbers."""
        standing = {thing: tile for thing, tile in tiles.items() if thing in shown}
        first = len(self.panoramas)
        for tile, clutter in enumerate(self.clutter):
            views = [_view(tile, heading, standing, clutter) for heading in range(HEADINGS)]
            numbers = [self.views.setdefault(view.tobytes(), len(self.views)) for view in views]
            self.panoramas.append(numbers)
        return list(range(first, len(self.panoramas)))

    def house_views(self, name: str) -> Panoramas:
        """Everything drawn."""
        views = np.frombuffer(b"".join(self.views), np.uint8).reshape(-1, 24, 32).copy()
        return Panoramas(torch.from_numpy(views), torch.tensor(self.panoramas), name)


def _view(tile: int, heading: int, standing: dict[str, int], clutter: np.ndarray) -> np.ndarray:
    """What is seen from a tile in a direction: uint8 [24, 32]."""
    view = np.full((24, 32), 1, np.uint8)
    view[16:] = 2
    for k, label in enumerate(clutter[heading]):
        view[2 + 6 * k : 5 + 6 * k, 3 + 9 * k : 9 + 9 * k] = label
    x, y = tile % SIDE, tile // SIDE
    east, north = _STEPS[heading]
    for slot, (thing, label) in enumerate(THINGS.items()):
        if thing not in standing:
            continue
        along = standing[thing] % SIDE - x, standing[thing] // SIDE - y
        distance = along[0] * east + along[1] * north
        if (distance * east, distance * north) == along and distance >= 0:
            size = 14 if distance == 0 else 5 - distance
            left = (4 if slot < len(PLACES) else 17) if distance == 0 else 2 + 5 * slot
            view[22 - size : 22, left : left + size] = label
    return view


def _nav_batch(tiles: dict[str, int], starts: np.ndarray) -> TaskBatch:
    goals = np.stack([np.arange(TILES) == tiles[thing] for thing in THINGS])
    return TaskBatch(
        next_state=_nav_dynamics().expand(len(THINGS), -1, -1).contiguous(),
        goal=torch.from_numpy(goals),
        start=torch.from_numpy(starts),
        horizon=HORIZON,
        discount=DISCOUNT,
    )


def _pick_batch(ways: list[tuple[int, int]], starts: np.ndarray) -> TaskBatch:
    delivered = torch.arange(3 * TILES) // TILES == ObjectState.AT_B
    return TaskBatch(
        next_state=torch.stack([_pick_dynamics(a, b) for a, b in ways]),
        goal=delivered.expand(len(ways), -1).contiguous(),
        start=torch.from_numpy(starts),
        horizon=HORIZON,
        discount=DISCOUNT,
    )


def _nav_dynamics() -> torch.Tensor:
    """Moving about an empty square: int64 [state, action]."""
    table = torch.zeros(TILES * HEADINGS, ACTIONS, dtype=torch.int64)
    for tile in range(TILES):
        for heading, (east, north) in enumerate(_STEPS):
            x, y = tile % SIDE + east, tile // SIDE + north
            ahead = y * SIDE + x if 0 <= x < SIDE and 0 <= y < SIDE else tile
            state = tile * HEADINGS + heading
            table[state, Action.FORWARD] = ahead * HEADINGS + heading
            table[state, Action.LEFT] = tile * HEADINGS + (heading - 1) % HEADINGS
            table[state, Action.RIGHT] = tile * HEADINGS + (heading + 1) % HEADINGS
            table[state, Action.INTERACT] = state
    return table


def _pick_dynamics(a: int, b: int) -> torch.Tensor:
    """The same with an object that stands at tile `a`, is held, or stands at tile `b`."""
    layer = TILES * HEADINGS
    table = torch.cat([_nav_dynamics() + k * layer for k in range(3)])
    for heading in range(HEADINGS):
        at_a, at_b = a * HEADINGS + heading, b * HEADINGS + heading
        table[ObjectState.AT_A * layer + at_a, Action.INTERACT] = ObjectState.HELD * layer + at_a
        table[ObjectState.HELD * layer + at_a, Action.INTERACT] = ObjectState.AT_A * layer + at_a
        table[ObjectState.HELD * layer + at_b, Action.INTERACT] = ObjectState.AT_B * layer + at_b
        table[ObjectState.AT_B * layer + at_b, Action.INTERACT] = ObjectState.HELD * layer + at_b
    return table


def _demonstrated(
    batch: TaskBatch,
    views: Panoramas,
    panoramas: torch.Tensor,
    commands: tuple[str, ...],
    *,
    oracle: bool,
) -> TaskSet:
    generator = torch.Generator().manual_seed(7)
    demos = sample_trajectories(
        batch,
        expert_policy(batch, SUCCESS_REWARD),
        episodes=DEMONSTRATIONS,
        generator=generator,
    )
    held = torch.zeros_like(batch.goal)
    if panoramas.shape[1] > TILES:
        held.view(len(commands), 3, TILES)[:, ObjectState.HELD] = True
    return TaskSet(
        next_state=batch.next_state,
        goal=batch.goal if oracle else torch.zeros_like(batch.goal),
        start=batch.start,
        horizon=batch.horizon,
        discount=batch.discount,
        views=views,
        panoramas=panoramas,
        commands=commands,
        held=held,
        demonstrations=demos.states,
        expert=shortest_way_policy(batch),
    )
