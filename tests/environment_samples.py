"""A benchmark of two copies of the two-room house, and rewards for an environment to pay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
import torch
from house_samples import two_rooms

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.proof import start_table
from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task
from lcrl_bench.benchmarks.task_set import one_task
from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.tensors import TensorReward
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS

UNPROVED = Proof(optimal_length=0, value=0.0, random_success=0.0)
ON_THE_BED = PlacedObject("cup", "cup", "bedroom", (0.8, 1.7, 0.65), (0.08, 0.08, 0.1), 0.0, "bed")
ON_THE_TABLE = replace(ON_THE_BED, room="kitchen", position=(4.8, 2.2, 0.8), support="table")


class CountingReward(TensorReward):
    """Twice the pixels of beds in sight, plus the words of the command; counts what it scored."""

    def __init__(self) -> None:
        self.scored: list[str] = []

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        self.scored += commands
        flat = views.views.reshape(len(views.views), -1)
        beds = (flat == class_id("bed")).sum(1)[views.panorama_views].sum(1)
        words = torch.tensor([len(command.split()) for command in commands])
        return (2 * beds + words[:, None]).float()


@lru_cache(maxsize=1)
def sample_benchmark() -> Benchmark:
    """Two houses, the second held out: NAV and PICK tasks with their true proofs."""
    houses = {name: replace(two_rooms(), id=name) for name in ("rooms-a", "rooms-b")}
    grid = build_grid(two_rooms(), DEFAULT_SEMANTICS)
    kitchen = int(np.argmin(np.linalg.norm(grid.points - (4.6, 1.5), axis=1)))
    tasks = (*_tasks(houses["rooms-a"], kitchen), *_tasks(houses["rooms-b"], kitchen))
    grids = dict.fromkeys(houses, grid)
    unproved = Benchmark("rooms", DEFAULT_SEMANTICS, houses, grids, tasks)
    return replace(unproved, tasks=tuple(_proved(unproved)))


def _tasks(house: House, tile: int) -> list[Task]:
    train, test = Split.TRAIN, Split.TEST_TASK
    if house.id == "rooms-b":
        train = test = Split.TEST_HOUSE

    def task(kind: Kind, split: Split, command: str, target: str, heading: int) -> Task:
        name = f"{house.id}.{command.replace(' ', '-')}"
        return Task(name, kind, split, house.id, command, target, tile, heading, UNPROVED)

    bed = task(Kind.NAV, train, "go to the bed", "bed", 1)
    room = task(Kind.NAV, test, "go to the bedroom", "bedroom", 3)
    to_bed = task(Kind.PICK, train, "move the cup to the bed", "bed", 2)
    to_table = task(Kind.PICK, train, "move the cup to the dining table", "dining_table", 0)
    return [
        bed,
        room,
        replace(to_bed, moved="cup", placement=ON_THE_BED),
        replace(to_table, moved="cup", placement=ON_THE_TABLE),
    ]


def _proved(benchmark: Benchmark) -> list[Task]:
    proved = {}
    for name in benchmark.houses:
        scene = benchmark.scene(name)
        for task in benchmark.select(house=name):
            one = one_task(scene, task)
            table = start_table(one, benchmark.semantics.success_reward)
            proved[task.id] = replace(task, proof=table.proof(int(one.start[0])))
    return [proved[task.id] for task in benchmark.tasks]
