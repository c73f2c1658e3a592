"""What `Drawn` names: figures of houses, panoramas, rewards and plans; recordings of results."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import UsageError
from lcrl_bench.houses.house import House
from lcrl_bench.methods.learned import Plan, Policy, Reward, RewardMap
from lcrl_bench.panoramas import CLASSES, Panorama
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import draw_class_legend
from lcrl_bench.recording.maps import tile_maps
from lcrl_bench.recording.pictures import house_figure, panorama_picture, reward_map_figure
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.rollout import episode_of


def draw_house(house: House) -> Figure:
    """The plan of a house."""
    return house_figure(house)


def draw_panorama(panorama: Panorama) -> Figure:
    """The four views of a panorama side by side, with the classes that they show."""
    _check_whole(panorama)
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.imshow(panorama_picture(panorama), interpolation="nearest")
    width = panorama.shape[2]
    names = ("north", "east", "south", "west")
    axes.set_xticks([(k + 0.5) * width - 0.5 for k in range(4)], names, fontsize=8)
    axes.set_yticks([])
    for k in range(1, 4):
        axes.axvline(k * width - 0.5, color="white", linewidth=1.0)
    counts = np.bincount(np.asarray(panorama).reshape(-1), minlength=CLASSES)
    draw_class_legend(figure, counts, most=12, columns=6, size=7)
    return figure


def draw_reward_map(rewards: RewardMap) -> Figure:
    """A learned reward over the plan of the house, a map per place of the object."""
    _check_whole(rewards)
    episode = _episode(rewards.subject.learned, rewards.subject.tasks)
    return reward_map_figure(episode, tile_maps(episode)[:1])


def draw_plan(planned: Plan) -> Figure:
    """A learned reward and its value over the plan of the house, with the path that follows.

    Raises:
        UsageError: If the plan is of several tasks.
    """
    return reward_map_figure(_episode(planned.learned, planned.tasks))


def record_task(
    path: Path, learned: Reward | Policy, task: Task, *, method: str, seed: int
) -> Path:
    """Record what a learned reward or policy does in a task as a Rerun recording.

    Raises:
        UsageError: If `path` does not end in `.rrd`.
    """
    if path.suffix != ".rrd":
        raise UsageError(f"{path}: the file of a recording ends in .rrd.")
    record_episodes(path, [_episode(learned, task.single(), method=method, seed=seed)])
    return path


def _episode(learned: Reward | Policy, one: TaskSet, *, method: str = "", seed: int = 0) -> Episode:
    home = one.task.home or one.task.single().task.home
    return episode_of(
        learned,
        one,
        benchmark=home.benchmark,
        method=method or type(learned).__name__,
        seed=seed,
    )


def _check_whole(array: Panorama | RewardMap) -> None:
    if array.subject is None:
        raise UsageError(
            f"This is a part of a {type(array).__name__}, or computed from one: it is drawn whole."
        )
