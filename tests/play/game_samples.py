"""Games in the two-room house: tasks by command, and runs that were never trained."""

from __future__ import annotations

import numpy as np
from environment_samples import CountingReward, sample_benchmark

from lcrl_bench.evaluation.question import Model
from lcrl_bench.play.game import Game
from lcrl_bench.play.keys import commands_of
from lcrl_bench.play.playlist import choose_tasks

PICK = "rooms-a.move-the-cup-to-the-bed"
NAV = "rooms-a.go-to-the-bed"
COUNTING = Model(CountingReward(), "counting", 0, sample_benchmark(), ())


def make_game(
    task: str | None = None, *, sentence: str | None = None, model: Model | None = None
) -> Game:
    """A game that begins with a task or a sentence."""
    playlist = choose_tasks(
        sample_benchmark(),
        generator=np.random.default_rng(0),
        house="rooms-a" if task is None else None,
        task=task,
        sentence=sentence,
        renderer="rays",
    )
    return Game(playlist, model=model)


def press(game: Game, keys: str) -> Game:
    """Press keys; a walk that is taken over is walked to its end."""
    for command in commands_of(keys):
        game.handle(command)
        while game.autoplay:
            game.step()
    return game
