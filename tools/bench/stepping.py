"""Stepping: the Gymnasium environments, beside MiniGrid."""

from __future__ import annotations

from typing import Final

from lcrl_bench.cli.bench import Figure
from tools.speed.environments import TASKS, measure_environments, times_faster
from tools.speed.peers import MINIGRID

GOALS: Final = {0: 50, 16: 100}
"""How many times as many steps per CPU second as MiniGrid's simplest environment, by the number of
sub-environments."""


def measure_stepping(benchmark: str) -> tuple[Figure, ...]:
    """Step House-v1 with panoramas, single and as a vector, under random actions.

    Args:
        benchmark: A name or a folder.

    Raises:
        EnvironmentMissingError: If MiniGrid is not installed.
    """
    MINIGRID.require()
    found = measure_environments(benchmark, counts=tuple(GOALS), minigrid=True)
    figures = []
    for count, goal in GOALS.items():
        ours = next(each for each in found if each.environments == count)
        ratios = times_faster(ours, found)
        work = f"steps of a vector of {count}" if count else "steps of one environment"
        detail = {"steps_per_s": ours.steps, **{f"times {name}": ratios[name] for name in TASKS}}
        figures.append(
            Figure("environments", work, TASKS[0], ratios[TASKS[0]], "x", goal, detail=detail)
        )
    return tuple(figures)
