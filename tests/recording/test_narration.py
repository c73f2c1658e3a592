"""What an episode says in words."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import (
    about,
    action_phrase,
    action_word,
    now,
    object_phrase,
    plain,
    room_name,
)


@given(st.text())
def test_plain_text_holds_only_latin_letters(text: str):
    drawn = plain(text)
    assert plain(drawn) == drawn
    assert all(letter == "\n" or (letter.isprintable() and letter <= "ſ") for letter in drawn)


@given(st.text(st.characters(min_codepoint=32, max_codepoint=126)))
def test_plain_text_stays_as_it_is(text: str):
    assert plain(text) == text


def test_accents_are_kept_however_they_are_written():
    assert plain("cafe\u0301") == plain("café") == "café"


def test_an_interaction_says_what_it_does(pick_episode: Episode):
    states = pick_episode.object_states
    take = int(np.flatnonzero(np.diff(states) == 1)[0])
    put = int(np.flatnonzero(states == 2)[0]) - 1
    assert action_phrase(pick_episode, take) == "take the cup"
    assert action_phrase(pick_episode, put) == "put the cup at B"
    assert (action_word(pick_episode, take), action_word(pick_episode, put)) == ("take", "put")
    assert [object_phrase(pick_episode, step) for step in (take, put, put + 1)] == [
        "at A",
        "in hand",
        "at B",
    ]


@pytest.mark.parametrize("name", ["nav_episode", "pick_episode", "policy_episode"])
def test_a_blocked_step_is_told_from_one_that_leads_on(name: str, request: pytest.FixtureRequest):
    episode: Episode = request.getfixturevalue(name)
    for step in range(episode.horizon):
        moved = episode.states[step] != episode.states[step + 1]
        phrase = action_phrase(episode, step)
        assert (phrase in ("forward (blocked)", "stay")) is not moved
    assert action_phrase(episode, episode.horizon) == "end"


def test_a_policy_that_runs_into_a_wall_is_said_to_be_blocked(policy_episode: Episode):
    phrases = {action_phrase(policy_episode, step) for step in range(policy_episode.horizon)}
    assert phrases == {"forward", "forward (blocked)"}


def test_the_card_tells_what_is_known_of_the_task(nav_episode: Episode, policy_episode: Episode):
    card = about(nav_episode)
    reached = int(np.flatnonzero(nav_episode.done)[0])
    for words in (
        "go to the bed",
        f"reached at step {reached}",
        "takes 9 of 30 steps",
        "succeed in 1.2 %",
        "best return is 123.0",
        "NAV, train",
    ):
        assert words in card, words
    assert "Goal **not reached**" in about(policy_episode)


def test_a_line_tells_where_the_agent_is_and_what_it_sees(nav_episode: Episode):
    first, last = now(nav_episode, 0), now(nav_episode, nav_episode.horizon)
    assert "in the kitchen, facing east" in first
    assert "goal not reached yet" in first
    assert f"in the {room_name(nav_episode, 30)}" in last
    assert "**goal reached**" in last
    assert "bed" in last.split("sees")[1]
    assert "wall" not in last.split("sees")[1]
