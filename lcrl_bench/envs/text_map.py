"""A text map of a task for the terminal: the command, the tiles of the house, and the agent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.task_batch import HEADINGS, ObjectState

ARROWS: Final = "^>v<"
"""The agent, facing north, east, south, west."""
FREE: Final = "."
GOAL: Final = "*"
"""A goal tile of a NAV task."""
TAKE, PUT, BOTH = "a", "b", "x"
"""Tiles from which a PICK object can be taken at A, put at B, or both."""
HEADING_NAMES: Final = ("north", "east", "south", "west")
_EAST, _SOUTH = 1, 2


def text_map(one: TaskSet, states: Sequence[int], *, horizon: int) -> str:
    """The house as a map of tiles, north up; barriers are `|` or `-`.

    Args:
        one: The task.
        states: All states of the episode so far.
        horizon: Number of actions in a full episode.
    """
    tile, heading, _ = one.place(states[-1])
    letters = tile_letters(one)
    letters[tile] = ARROWS[heading]
    cells = one.scene.grid.cells
    place = {(int(column), int(row)): k for k, (column, row) in enumerate(cells)}
    (west, south), (east, north) = cells.min(axis=0), cells.max(axis=0)
    columns = range(int(west), int(east) + 1)
    lines = [one.task.command, status(one, states, horizon=horizon), ""]
    for row in range(int(north), int(south) - 1, -1):
        here = [place.get((column, row)) for column in columns]
        below = [place.get((column, row - 1)) for column in columns]
        lines.append(_row(one, letters, here))
        between = [_edge(one, a, b, _SOUTH, "-") for a, b in zip(here, below, strict=True)]
        if "-" in between:
            lines.append(" ".join(between).rstrip())
    return "\n".join([*lines, "", _legend(one)])


def status(one: TaskSet, states: Sequence[int], *, horizon: int) -> str:
    """One line: the step, the heading, where the object is, whether the goal is reached."""
    _, heading, held = one.place(states[-1])
    words = [f"step {len(states) - 1} of {horizon}", f"facing {HEADING_NAMES[heading]}"]
    if one.task.moved is not None:
        thing = one.scene.house.object(one.task.moved).label.replace("_", " ")
        where = {
            ObjectState.AT_A: "at A",
            ObjectState.HELD: "in hand",
            ObjectState.AT_B: "at B",
        }
        words.append(f"{thing} {where[held]}")
    if one.goal[0, states[-1] // HEADINGS]:
        words.append("goal reached")
    return ", ".join(words)


def tile_letters(one: TaskSet) -> list[str]:
    """The letter of each tile in a task: `GOAL`, `TAKE`, `PUT`, `BOTH` or `FREE`."""
    take, put = one.object_tiles[0].numpy(), one.target_tiles[0].numpy()
    if one.task.kind == Kind.NAV:
        return [GOAL if goal else FREE for goal in put]
    index = take.astype(np.int64) + 2 * put
    return [(FREE, TAKE, PUT, BOTH)[number] for number in index]


def _row(one: TaskSet, letters: Sequence[str], here: Sequence[int | None]) -> str:
    line = ""
    for first, second in zip(here, [*here[1:], None], strict=True):
        line += " " if first is None else letters[first]
        line += _edge(one, first, second, _EAST, "|")
    return line.rstrip()


def _edge(one: TaskSet, first: int | None, second: int | None, toward: int, wall: str) -> str:
    """The character between two tiles: a space or a barrier."""
    if first is None or second is None:
        return " "
    return " " if one.scene.grid.neighbours[first, toward] == second else wall


def _legend(one: TaskSet) -> str:
    agent = f"{ARROWS} agent"
    if one.task.kind == Kind.NAV:
        return f"{agent}   {GOAL} goal"
    return f"{agent}   {TAKE} object within reach   {PUT} its new place   {BOTH} both"
