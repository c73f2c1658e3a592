"""How an episode fails: one class for each end, as the evaluation has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import FAILURE_WORDS, about

A, HELD = 0, 1
ENDS = {
    Failure.WAITS_AT_A: ([A], "A"),
    Failure.AT_B_WITHOUT_OBJECT: ([A], "B"),
    Failure.ELSEWHERE: ([A], "elsewhere"),
    Failure.PUT_BACK: ([A, HELD, A], "A"),
    Failure.HELD_AT_B: ([A, HELD], "B"),
    Failure.HELD_ELSEWHERE: ([A, HELD], "A"),
}


def ending(episode: Episode, object_states: list[int], place: str) -> Episode:
    """An episode that stands still at a place while the object goes through states."""
    tiles = episode.scene.grid.tiles
    near = {"A": np.arange(tiles) == 0, "B": np.arange(tiles) == 1}
    tile = {"A": 0, "B": 1, "elsewhere": 2}[place]
    last = [object_states[-1]] * (episode.horizon + 1 - len(object_states))
    states = (np.array([*object_states, *last]) * tiles + tile) * 4
    return replace(episode, states=states, success=False, near_start=near["A"], near_end=near["B"])


@pytest.mark.parametrize("failure", Failure)
def test_each_end_has_its_class_and_its_words(failure: Failure, pick_episode: Episode):
    episode = ending(pick_episode, *ENDS[failure])
    assert episode.failure == failure
    assert FAILURE_WORDS[failure].format(thing="cup") in about(episode)


def test_a_success_and_a_place_to_go_to_have_no_class(pick_episode: Episode, nav_episode: Episode):
    assert pick_episode.failure is None
    assert replace(nav_episode, success=False).failure is None
