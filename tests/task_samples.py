"""A tiny world to learn in: a square of tiles with things in it, seen as coloured rectangles.

Nothing here depends on houses or rendering. A thing fills the views of its own tile and looks
smaller along the four axes from it, behind random clutter that no command names. A NAV task ends
at the tile of the thing the command names; a PICK task is to take one thing to another's tile.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from lcrl_bench.mdp.expert import expert_policy, shortest_way_policy
from lcrl_bench.mdp.rollouts import sample_trajectories
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS, Action, TaskBatch
from lcrl_bench.methods.contract import HouseViews, TaskSet, TrainHouse, TrainSet

SIDE = 4
TILES = SIDE * SIDE
THINGS = {"sofa": 20, "bed": 21, "sink": 22, "cup": 50, "pan": 51, "book": 52}
"""Name -> class id."""
PLACES, OBJECTS = ("sofa", "bed", "sink"), ("cup", "pan", "book")
STEPS = ((0, 1), (1, 0), (0, -1), (-1, 0))
"""North, east, south, west."""
HORIZON, DISCOUNT, SUCCESS_REWARD, DEMONSTRATIONS = 20, 0.99, 10.0, 10
AT_A, HELD, AT_B = 0, 1, 2


def sample_train_set(seed: int, *, houses: int = 2, oracle: bool = False) -> TrainSet:
    """Tiny houses with NAV and PICK tasks and demonstrations of them."""
    rng = np.random.default_rng(seed)
    made = tuple(sample_house(f"tiny-{k}", rng, oracle=oracle) for k in range(houses))
    words = {
        word
        for house in made
        for tasks in house.tasks
        for c in tasks.commands
        for word in c.split()
    }
    return TrainSet(made, tuple(sorted(words)))


def sample_house(name: str, rng: np.random.Generator, *, oracle: bool) -> TrainHouse:
    """One tiny house: six NAV tasks, and as many PICK tasks as objects."""
    tiles = dict(zip(THINGS, rng.choice(TILES, len(THINGS), replace=False).tolist(), strict=True))
    clutter = rng.integers(30, 45, size=(TILES, HEADINGS, 3))
    store: dict[bytes, int] = {}
    panorama_views: list[list[int]] = []

    def panoramas_of(standing: dict[str, int]) -> list[int]:
        """The panoramas of all tiles, with the things that stand somewhere."""
        first = len(panorama_views)
        for tile in range(TILES):
            views = [_view(tile, heading, standing, clutter[tile]) for heading in range(HEADINGS)]
            panorama_views.append([store.setdefault(v.tobytes(), len(store)) for v in views])
        return list(range(first, first + TILES))

    everything = panoramas_of(tiles)
    ends = np.array([tiles[thing] for thing in (*THINGS, *OBJECTS)])
    starts = (ends + rng.integers(1, TILES, size=len(ends))) % TILES * HEADINGS
    nav_goals = np.stack([np.arange(TILES) == tiles[thing] for thing in THINGS])
    nav = TaskBatch(
        next_state=_nav_dynamics().expand(len(THINGS), -1, -1).contiguous(),
        goal=torch.from_numpy(nav_goals),
        start=torch.from_numpy(starts[: len(THINGS)]),
        horizon=HORIZON,
        discount=DISCOUNT,
    )
    nav_commands = tuple(f"go to the {thing}" for thing in THINGS)
    nav_panoramas = torch.tensor([everything] * len(THINGS))
    pairs = list(zip(OBJECTS, rng.permutation(PLACES).tolist(), strict=True))
    pick_panoramas = []
    for thing, place in pairs:
        gone = {name: tile for name, tile in tiles.items() if name != thing}
        moved = gone | {thing: tiles[place]}
        pick_panoramas.append(everything + panoramas_of(gone) + panoramas_of(moved))
    pick = TaskBatch(
        next_state=torch.stack([_pick_dynamics(tiles[a], tiles[b]) for a, b in pairs]),
        goal=(torch.arange(3 * TILES) // TILES == AT_B).expand(len(pairs), -1).contiguous(),
        start=torch.from_numpy(starts[len(THINGS) :]),
        horizon=HORIZON,
        discount=DISCOUNT,
    )
    pick_commands = tuple(f"move the {a} to the {b}" for a, b in pairs)
    views = np.frombuffer(b"".join(store), np.uint8).reshape(-1, 24, 32).copy()
    seen = HouseViews(name, torch.from_numpy(views), torch.tensor(panorama_views))
    sets = (
        _demonstrated(nav, nav_panoramas, nav_commands, oracle=oracle),
        _demonstrated(pick, torch.tensor(pick_panoramas), pick_commands, oracle=oracle),
    )
    return TrainHouse(seen, sets)


def with_goals(train: TrainSet, truth: TrainSet) -> list[tuple[TrainHouse, TaskSet, TaskBatch]]:
    """The task sets of a train set, each with its house and its batch with true goals."""
    return [
        (house, tasks, true_tasks.batch)
        for house, true_house in zip(train.houses, truth.houses, strict=True)
        for tasks, true_tasks in zip(house.tasks, true_house.tasks, strict=True)
    ]


def _demonstrated(
    batch: TaskBatch, panoramas: torch.Tensor, commands: tuple[str, ...], *, oracle: bool
) -> TaskSet:
    generator = torch.Generator().manual_seed(7)
    demos = sample_trajectories(
        batch,
        expert_policy(batch, SUCCESS_REWARD),
        episodes=DEMONSTRATIONS,
        generator=generator,
    )
    expert = shortest_way_policy(batch)
    if not oracle:
        batch = replace(batch, goal=torch.zeros_like(batch.goal))
    held = torch.zeros_like(batch.goal)
    if panoramas.shape[1] > TILES:
        held.view(len(commands), 3, TILES)[:, HELD] = True
    return TaskSet(batch, panoramas, commands, demos.states, held, expert)


def _nav_dynamics() -> torch.Tensor:
    """Moving about an empty square: int64 [state, action]."""
    table = torch.zeros(TILES * HEADINGS, ACTIONS, dtype=torch.int64)
    for tile in range(TILES):
        for heading, (east, north) in enumerate(STEPS):
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
        table[AT_A * layer + at_a, Action.INTERACT] = HELD * layer + at_a
        table[HELD * layer + at_a, Action.INTERACT] = AT_A * layer + at_a
        table[HELD * layer + at_b, Action.INTERACT] = AT_B * layer + at_b
        table[AT_B * layer + at_b, Action.INTERACT] = HELD * layer + at_b
    return table


def _view(tile: int, heading: int, standing: dict[str, int], clutter: np.ndarray) -> np.ndarray:
    """What is seen from a tile in a direction: uint8 [24, 32]."""
    view = np.full((24, 32), 1, np.uint8)
    view[16:] = 2
    for k, label in enumerate(clutter[heading]):
        view[2 + 6 * k : 5 + 6 * k, 3 + 9 * k : 9 + 9 * k] = label
    x, y = tile % SIDE, tile // SIDE
    east, north = STEPS[heading]
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
