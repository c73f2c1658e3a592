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
from lcrl_bench.panoramas import Panorama
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.pictures import house_figure
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.reward_plan import reward_map_figure
from lcrl_bench.recording.rollout import episode_of
from lcrl_bench.recording.storyboard import storyboard_of
from lcrl_bench.recording.views import panorama_figure


def draw_house(house: House) -> Figure:
    """The plan of a house."""
    return house_figure(house)


def draw_panorama(panorama: Panorama) -> Figure:
    """The four views of a panorama side by side, with the classes that they show."""
    _check_whole(panorama)
    return panorama_figure(np.asarray(panorama))


def draw_reward_map(rewards: RewardMap) -> Figure:
    """A learned reward over the plan of the house, a map per place of the object."""
    _check_whole(rewards)
    board = storyboard_of(_episode(rewards.subject.learned, rewards.subject.tasks))
    return reward_map_figure(board, board.maps[:1])


def draw_plan(planned: Plan) -> Figure:
    """A learned reward and its value over the plan of the house, with the path that follows.

    Raises:
        UsageError: If the plan is of several tasks.
    """
    return reward_map_figure(storyboard_of(_episode(planned.learned, planned.tasks)))


def record_task(
    path: Path, learned: Reward | Policy, task: Task, *, method: str, seed: int
) -> Path:
    """Record what a learned reward or policy does in a task as a Rerun recording.

    Raises:
        UsageError: If `path` does not end in `.rrd`.
    """
    if path.suffix != ".rrd":
        raise UsageError(f"{path}: the file of a recording ends in .rrd.")
    episode = _episode(learned, task.single(), method=method, seed=seed)
    record_episodes(path, [storyboard_of(episode)])
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
