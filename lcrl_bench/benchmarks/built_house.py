"""`build_house`: the grid and the proved tasks of one house, whatever other houses there are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.projections import MIN_SUCCESS, Projection, success_by_sight
from lcrl_bench.benchmarks.sampling import draw_tasks
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.benchmarks.task_set import stack_tasks
from lcrl_bench.benchmarks.visibility import visibility_failures
from lcrl_bench.houses.house import House
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.semantics import Semantics

SPARE: Final = 2
"""Candidates drawn per task wanted, as some turn out to be invisible."""


@dataclass(frozen=True)
class BuiltHouse:
    """A house with its grid and tasks."""

    house: House
    grid: Grid
    tasks: tuple[Task, ...]
    """All in the training split for now; empty if none could be proved."""


def build_house(
    house: House,
    semantics: Semantics,
    *,
    nav: int,
    pick: int,
    rng: np.random.Generator,
    renderer: str = "auto",
) -> BuiltHouse:
    """Draw and prove the tasks of a house.

    The result depends on the arguments alone; the views that are rendered for it stay in the cache.

    Args:
        house: The house.
        semantics: Size and cameras of the agent, horizon and rewards.
        nav: NAV tasks wanted; there may be fewer.
        pick: PICK tasks wanted; there may be fewer.
        rng: The house's own.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.

    Raises:
        InvalidHouseError: If the agent can't stand anywhere in it.
    """
    scene = Scene(house, semantics, renderer=renderer)
    drawn = draw_tasks(scene, nav=nav * SPARE, pick=pick * SPARE, rng=rng)
    arrangements = arrangements_of(drawn)
    sets = stack_tasks(scene, drawn, scene.panoramas(arrangements), arrangements)
    limits = {Kind.NAV: nav, Kind.PICK: pick}
    chosen: list[Task] = []
    for tasks in sets:
        enough = success_by_sight(tasks, Projection.CELLS)
        invisible = visibility_failures(tasks)
        visible = [
            task
            for row, task in enumerate(tasks.tasks)
            if enough[row] >= MIN_SUCCESS and not invisible[row]
        ]
        chosen.extend(visible[: limits[tasks.kind]])
    return BuiltHouse(house, scene.grid, tuple(chosen))
