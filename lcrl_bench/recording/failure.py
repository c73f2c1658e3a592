"""How an episode fails, in words: the classes of `evaluation.outcome`, told of one rollout."""

from __future__ import annotations

from typing import Final

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.episode import Episode

FAILURE_WORDS: Final = {
    Failure.WAITS_AT_A: "never took the {thing}, and ends where it could have",
    Failure.AT_B_WITHOUT_OBJECT: "never took the {thing}, and ends where it was to be put",
    Failure.ELSEWHERE: "never took the {thing}, and ends elsewhere",
    Failure.PUT_BACK: "took the {thing}, and put it back where it was",
    Failure.HELD_AT_B: "ends where the {thing} was to be put, still holding it",
    Failure.HELD_ELSEWHERE: "ends elsewhere, still holding the {thing}",
}
"""What is said of each class; `{thing}` is what was to be moved."""


def failure_of(episode: Episode) -> Failure | None:
    """The class of a PICK episode that fails; None if the goal is reached or unknown, and for NAV.

    The definition is that of `evaluation.outcome.failure_shares`, for a single way.
    """
    if episode.success or episode.task.kind == Kind.NAV or not episode.goal.any():
        return None
    tile, last = int(episode.tiles[-1]), int(episode.object_states[-1])
    at_a = episode.near_start is not None and bool(episode.near_start[tile])
    at_b = episode.near_end is not None and bool(episode.near_end[tile])
    if not (episode.object_states == ObjectState.HELD).any():
        if at_a:
            return Failure.WAITS_AT_A
        return Failure.AT_B_WITHOUT_OBJECT if at_b else Failure.ELSEWHERE
    if last == ObjectState.AT_A:
        return Failure.PUT_BACK
    return Failure.HELD_AT_B if at_b else Failure.HELD_ELSEWHERE
