"""A benchmark of the two-room sample house, and a reward and a policy to follow in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from house_samples import two_rooms

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.methods.contract import Panoramas, Policy, Reward
from lcrl_bench.methods.tensors import TensorPolicy, TensorReward
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.rollout import episode_of
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS

PROOF = Proof(optimal_length=9, value=123.0, random_success=0.0123)
ON_THE_BED = PlacedObject("cup", "cup", "bedroom", (0.8, 1.7, 0.65), (0.08, 0.08, 0.1), 0.0, "bed")


class SeenReward(TensorReward):
    """How many pixels of the things a command names are in sight, multiplied."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        flat = views.views.reshape(len(views.views), -1)
        rows = []
        for command in commands:
            named = [word for word in command.split() if word in {"bed", "cup"}]
            counts = torch.stack([(flat == class_id(word)).sum(1) for word in named])
            rows.append(counts[:, views.panorama_views].sum(-1).prod(0).float() / 100)
        return torch.stack(rows)


class NoiseReward(TensorReward):
    """Differs everywhere: its maps compress the least."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        shape = len(commands), len(views)
        return torch.rand(shape, generator=torch.Generator().manual_seed(0))


class ForwardPolicy(TensorPolicy):
    """Likes to go forward, and to turn right now and then."""

    def logits(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        logits = torch.zeros(len(commands), len(views), 2, 4, 4)
        logits[..., 0], logits[..., 2] = 2.0, 1.0
        return logits


def sample_benchmark() -> Benchmark:
    """A NAV and a PICK task in the two-room house."""
    house = two_rooms()
    grid = build_grid(house, DEFAULT_SEMANTICS)
    kitchen = int(np.argmin(np.linalg.norm(grid.points - (4.6, 1.5), axis=1)))
    tasks = (
        Task(
            "two-rooms.go-to-the-bed",
            Kind.NAV,
            Split.TRAIN,
            house.id,
            "go to the bed",
            "bed",
            kitchen,
            1,
            PROOF,
        ),
        Task(
            "two-rooms.move-the-cup-to-the-bed",
            Kind.PICK,
            Split.TEST_TASK,
            house.id,
            "move the cup to the bed",
            "bed",
            kitchen,
            2,
            PROOF,
            "cup",
            ON_THE_BED,
        ),
    )
    return Benchmark("sample", DEFAULT_SEMANTICS, {house.id: house}, {house.id: grid}, tasks)


def make_episode(
    learned: Reward | Policy, sets: Sequence[TaskSet], benchmark: Benchmark, kind: Kind
) -> Episode:
    (one,) = [tasks for tasks in sets if tasks.kind == kind]
    return episode_of(learned, one, benchmark=benchmark, method="seen", seed=3)
