"""A model's answer to a sentence: its reward map, path and outcome.

It is written as a picture of reward, value and path, and as a recording of one episode.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from lcrl_bench.evaluation.question import Question
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import save_figure
from lcrl_bench.recording.maps import layer_titles
from lcrl_bench.recording.narration import HEADING_NAMES, action_phrase
from lcrl_bench.recording.rerun.log import record_episodes
from lcrl_bench.recording.reward_plan import reward_map_figure
from lcrl_bench.recording.rollout import episode_of
from lcrl_bench.recording.storyboard import storyboard_of

BEST: Final = 3
"""Number of best places named."""
ALIKE: Final = 1e-6
"""Relative difference between tiles up to which they count as equal: rounding."""
PICTURE, RECORDING = "ask.png", "ask.rrd"


@dataclass(frozen=True)
class Place:
    """One of the best tiles: of highest reward or, for a policy, most visited."""

    tile: int
    room: str
    """`"bedroom"`, with the room's id if the house has several."""
    when: str
    """PICK: `"with the cup in hand"`; empty for NAV, and if the object makes no difference."""
    score: float
    """The learned reward, or a policy's discounted visits."""


@dataclass(frozen=True)
class Leg:
    """Successive steps in one room."""

    first: int
    """Number of the first step, from 1."""
    last: int
    room: str
    actions: tuple[str, ...]
    """In words, one per step."""


@dataclass(frozen=True, eq=False)
class Answer:
    """An answered question."""

    question: Question
    episode: Episode
    best: tuple[Place, ...]
    legs: tuple[Leg, ...]
    """Up to the last step that moves the agent or the object."""

    @property
    def success(self) -> bool | None:
        """Whether the path fulfils the sentence; None if its goal is unknown."""
        return self.episode.success if self.question.posed.asked.known else None

    @property
    def rooms(self) -> tuple[str, ...]:
        """The rooms the path goes through, in order."""
        legs = [leg.room for leg in self.legs] or [room_label(self.episode, 0)]
        last = room_label(self.episode, self.episode.horizon)
        return tuple(room for room, _ in itertools.groupby([*legs, last]))

    def document(self) -> dict[str, Any]:
        """The answer as plain values."""
        task, reached = self.episode.task, np.flatnonzero(self.episode.done)
        known = self.question.posed.asked.known and task.proof.optimal_length >= 0
        return {
            "sentence": task.command,
            "house": task.house,
            "benchmark": self.question.posed.home.name,
            "method": self.question.model.method,
            "seed": self.question.model.seed,
            "kind": task.kind.value,
            "unknown_words": self.question.unknown,
            "notes": list(self.question.notes),
            "start": {
                "tile": task.start_tile,
                "room": room_label(self.episode, 0),
                "heading": HEADING_NAMES[task.start_heading],
            },
            "score": "visits" if self.episode.reward is None else "reward",
            "best": [vars(place) for place in self.best],
            "plan": [{**vars(leg), "actions": list(leg.actions)} for leg in self.legs],
            "rooms": list(self.rooms),
            "success": self.success,
            "reached_at": int(reached[0]) if len(reached) else None,
            "optimal_length": task.proof.optimal_length if known else None,
            "horizon": self.episode.horizon,
        }


def answer_question(question: Question) -> Answer:
    """Score the whole house, plan exactly, and follow the plan."""
    model, posed = question.model, question.posed
    episode = episode_of(
        model.learned,
        posed.tasks,
        benchmark=posed.home,
        method=model.method,
        seed=model.seed,
    )
    if question.own_house:
        episode = replace(episode, fingerprint="")
    return Answer(question, episode, best_places(episode), plan_legs(episode))


def write_answer(folder: Path, answer: Answer) -> None:
    """Write `ask.png` and `ask.rrd` into a folder, each whole or not at all."""
    folder.mkdir(parents=True, exist_ok=True)
    board = storyboard_of(answer.episode)
    save_figure(folder / PICTURE, reward_map_figure(board))
    record_episodes(folder / RECORDING, [board])


def best_places(episode: Episode, *, count: int = BEST) -> tuple[Place, ...]:
    """The tiles with the highest reward, or a policy's most visited ones, best first.

    A tile is named once, at its best; there is none if all tiles are alike.
    """
    scores = episode.occupancy if episode.reward is None else episode.reward
    if scores is None or np.ptp(scores) <= ALIKE * np.abs(scores).max():
        return ()
    layers = scores.reshape(-1, episode.scene.grid.tiles)
    best = layers.max(axis=0)
    titles = layer_titles(episode)
    return tuple(
        Place(
            int(tile),
            _room_of_tile(episode, int(tile)),
            # The same in every object state.
            "" if np.ptp(layers[:, tile]) == 0 else titles[int(layers[:, tile].argmax())],
            float(best[tile]),
        )
        for tile in np.argsort(-best, kind="stable")[:count]
    )


def plan_legs(episode: Episode) -> tuple[Leg, ...]:
    """The path in words, room by room."""
    changes = np.flatnonzero(np.diff(episode.cells))
    steps = range(int(changes[-1]) + 1) if len(changes) else range(0)
    legs = []
    for room, group in itertools.groupby(steps, key=lambda step: room_label(episode, step)):
        within = list(group)
        actions = tuple(action_phrase(episode, step) for step in within)
        legs.append(Leg(within[0] + 1, within[-1] + 1, room, actions))
    return tuple(legs)


def room_label(episode: Episode, step: int) -> str:
    """The agent's room at a step: its type, with its id if several rooms share that."""
    return _room_of_tile(episode, int(episode.tiles[step]))


def _room_of_tile(episode: Episode, tile: int) -> str:
    house = episode.scene.house
    room = house.room(episode.scene.grid.rooms[tile])
    alike = sum(other.type == room.type for other in house.rooms)
    return room.type.value if alike == 1 else f"{room.type.value} ({room.id})"
