"""One walk through a task: where the agent is, what it did, and whether the goal was reached."""

from __future__ import annotations

from typing import Final

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.task_batch import HEADINGS, Action, ObjectState

ACTION_PHRASES: Final = {
    Action.FORWARD: "forward",
    Action.LEFT: "turn left",
    Action.RIGHT: "turn right",
    Action.INTERACT: "take or put",
}
"""An action in words, whatever it acts on."""


class Walk:
    """An episode that a person walks; it ends at the goal, or when no steps are left."""

    def __init__(self, one: TaskSet) -> None:
        """Stand at the start."""
        self.played = one
        self.states = [int(one.start[0])]

    @property
    def state(self) -> int:
        """Where the agent is, as in `mdp.task_batch`."""
        return self.states[-1]

    @property
    def steps(self) -> int:
        """Actions taken so far."""
        return len(self.states) - 1

    @property
    def horizon(self) -> int:
        """The most actions that can be taken."""
        return self.played.horizon

    @property
    def goal_known(self) -> bool:
        """Whether success can be checked."""
        return bool(self.played.goal.any())

    @property
    def reached(self) -> bool:
        """Whether the agent is at the goal."""
        return bool(self.played.goal[0, self.state // HEADINGS])

    @property
    def over(self) -> bool:
        """Whether the goal is reached, or no action is left."""
        return self.reached or self.steps >= self.horizon

    def act(self, action: Action) -> str:
        """Take an action, unless the walk is over.

        Returns:
            A remark on the outcome; empty where the page shows it anyway.
        """
        if self.over:
            return ""
        before = self.state
        self.states.append(int(self.played.next_state[0, before, action]))
        if action == Action.INTERACT:
            return self._handled(before, self.state)
        blocked = action == Action.FORWARD and self.state == before
        return "something is in the way" if blocked else ""

    def phrase(self, action: Action) -> str:
        """An action in words: `"turn left"`, `"take the cup"`."""
        if action != Action.INTERACT:
            return ACTION_PHRASES[action]
        after = int(self.played.next_state[0, self.state, action])
        return ACTION_PHRASES[action] if after == self.state else self._handling(after)

    @property
    def in_reach(self) -> str:
        """What interacting would do here: `"take the cup"`; empty where it does nothing."""
        phrase = self.phrase(Action.INTERACT)
        return "" if phrase == ACTION_PHRASES[Action.INTERACT] else phrase

    @property
    def room(self) -> str:
        """The use of the room the agent is in."""
        tile, _, _ = self.played.place(self.state)
        scene = self.played.scene
        return scene.house.room(scene.grid.rooms[tile]).type.value

    @property
    def object_name(self) -> str:
        """The object of PICK, in words; empty for NAV."""
        moved = self.played.task.moved
        return (
            "" if moved is None else self.played.scene.house.object(moved).label.replace("_", " ")
        )

    @property
    def object_state(self) -> ObjectState | None:
        """Where the object of PICK is; None for NAV."""
        return None if self.played.task.kind == Kind.NAV else self.played.place(self.state)[2]

    def _handled(self, before: int, after: int) -> str:
        if before == after:
            return "nothing within reach to take or put"
        return f"you {self._handling(after)}"

    def _handling(self, after: int) -> str:
        state = self.played.place(after)[2]
        if state == ObjectState.HELD:
            return f"take the {self.object_name}"
        return f"put the {self.object_name} at {'B' if state == ObjectState.AT_B else 'A'}"
