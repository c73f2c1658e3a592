"""A game: the current task, what is shown of it, and the outcomes of those before."""

from __future__ import annotations

from dataclasses import dataclass

from lcrl_bench.evaluation.question import Model
from lcrl_bench.mdp.task_batch import Action
from lcrl_bench.play.guide import Guide, learned_guide, optimum
from lcrl_bench.play.keys import Command
from lcrl_bench.play.playlist import Playlist
from lcrl_bench.play.walk import Walk
from lcrl_bench.recording.maps import TileMap

ACTIONS = {
    Command.FORWARD: Action.FORWARD,
    Command.LEFT: Action.LEFT,
    Command.RIGHT: Action.RIGHT,
    Command.INTERACT: Action.INTERACT,
}


@dataclass(frozen=True)
class Played:
    """The outcome of a walk."""

    command: str
    steps: int
    reached: bool
    shortest: int
    """Steps of the optimum; -1 if it is unknown, or there is no way within the horizon."""


class Game:
    """The state of a game; changed by `handle` and `step`."""

    def __init__(self, playlist: Playlist, *, model: Model | None = None) -> None:
        """Begin with the first task.

        Args:
            playlist: The tasks.
            model: A run's model, a guide beside the optimum.
        """
        self.playlist = playlist
        self.number = 0
        self.played: list[Played] = []
        self.marks = True
        """Whether the map shows the goal."""
        self.autoplay = False
        """Whether the guide moves the agent."""
        self._model = model
        self._guide = 0
        self._layer = 0
        self._begin()

    def handle(self, command: Command) -> None:
        """Carry out a command."""
        self.message = ""
        if command in ACTIONS:
            self.autoplay = False
            self._act(ACTIONS[command])
        elif command == Command.RESTART:
            self.walk, self.autoplay = Walk(self.walk.played), False
        elif command == Command.NEXT:
            self.number += 1
            self._begin()
        elif command == Command.GUIDE:
            self._guide = (self._guide + 1) % (len(self.guides) + 1)
        elif command == Command.AUTOPLAY:
            self._toggle_autoplay()
        elif command == Command.LAYER:
            self._layer = (self._layer + 1) % (len(self._maps) + 1)
            if not self._maps:
                self.message = "other maps need a learned reward: --run RUN"
        elif command == Command.MARKS:
            self.marks = not self.marks

    def step(self) -> None:
        """Let the guide take a step; autoplay ends with the walk."""
        guide = self.guide or (self.guides[0] if self.guides else None)
        advice = None if guide is None else guide.advice(self.walk)
        if advice is None:
            self.autoplay = False
            return
        self._act(advice)
        self.autoplay = self.autoplay and not self.walk.over

    @property
    def guide(self) -> Guide | None:
        """The guide whose next action is shown; None if none is."""
        return None if self._guide == 0 else self.guides[self._guide - 1]

    @property
    def layer(self) -> TileMap | None:
        """The values that colour the map; None means its rooms."""
        return None if self._layer == 0 else self._maps[self._layer - 1]

    @property
    def shortest(self) -> int:
        """Steps of the optimum; -1 if it is unknown, or there is no way within the horizon."""
        return self.walk.played.task.proof.optimal_length if self.walk.goal_known else -1

    def _begin(self) -> None:
        one = self.playlist.played(self.number)
        self.walk = Walk(one)
        own = [] if self._model is None else [learned_guide(one, self._model)]
        best = optimum(one)
        self.guides = (*([best] if best else []), *own)
        self._maps = own[0].maps if own else ()
        self._guide = min(self._guide, len(self.guides))
        self._layer = min(self._layer, len(self._maps))
        self.autoplay = False
        self.message = self.playlist.note(self.number)

    def _act(self, action: Action) -> None:
        if self.walk.over:
            self.message = "this walk is over: r again, n next task"
            return
        self.message = self.walk.act(action)
        if self.walk.over:
            self.message = ""
            task = self.walk.played.task
            row = Played(task.command, self.walk.steps, self.walk.reached, self.shortest)
            self.played.append(row)

    def _toggle_autoplay(self) -> None:
        if not self.guides:
            self.message = "nobody knows the way: the goal is unknown"
        elif self.walk.over:
            self.message = "this walk is over: r again, n next task"
        else:
            self.autoplay = not self.autoplay
