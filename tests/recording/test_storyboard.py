"""A storyboard says at every step where things are, and in which words and marks they are shown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import tile_maps
from lcrl_bench.recording.storyboard import storyboard_of

SAMPLES = ("nav_episode", "pick_episode", "policy_episode")


@pytest.fixture(params=SAMPLES)
def episode(request: pytest.FixtureRequest) -> Episode:
    return request.getfixturevalue(request.param)


def test_the_agent_stands_on_its_tile_and_faces_its_heading(episode: Episode):
    board = storyboard_of(episode)
    assert len(board.steps) == episode.horizon + 1
    for step, shown in enumerate(board.steps):
        stands = episode.scene.grid.points[episode.tiles[step]]
        np.testing.assert_array_equal(shown.agent.position, [*stands, 0.0])
        north_east = [-np.sin(shown.agent.yaw), np.cos(shown.agent.yaw)]
        expected = [(0, 1), (1, 0), (0, -1), (-1, 0)][episode.headings[step]]
        np.testing.assert_allclose(north_east, expected, atol=1e-9)


def test_the_object_is_at_a_above_the_agent_or_at_b(pick_episode: Episode):
    found, placed = pick_episode.thing, pick_episode.task.placement
    assert found is not None
    assert placed is not None
    for shown, state in zip(
        storyboard_of(pick_episode).steps, pick_episode.object_states, strict=True
    ):
        assert shown.thing is not None
        if state == 1:
            np.testing.assert_array_equal(shown.thing.position[:2], shown.agent.position[:2])
            assert shown.thing.position[2] > 1.45
            assert shown.thing.yaw == shown.agent.yaw
        else:
            there = placed if state == 2 else found
            np.testing.assert_array_equal(shown.thing.position, there.position)


def test_nothing_is_carried_on_the_way_to_a_place(nav_episode: Episode):
    board = storyboard_of(nav_episode)
    assert board.thing is None
    assert {shown.thing for shown in board.steps} == {None}


def test_every_step_says_what_the_agent_does(pick_episode: Episode):
    actions = [shown.action for shown in storyboard_of(pick_episode).steps]
    assert actions.index("take the cup") < actions.index("put the cup at B")
    assert actions[-1] == "end"


def test_the_maps_are_those_that_explain_the_episode(episode: Episode):
    board = storyboard_of(episode)
    keys = [tile_map.key for tile_map in tile_maps(episode)]
    assert [tile_map.key for tile_map in board.maps] == keys
    visits = ["visits", "expert_visits"]
    # Visits are drawn beside a reward; of a policy they are the maps.
    assert [tile_map.key for tile_map in board.visits] == ([] if keys == visits else visits)
    assert [tile_map.key for tile_map in board.painted] == list(dict.fromkeys([*keys, *visits]))


def test_a_sentence_of_unknown_goal_has_no_mark_for_it(episode: Episode):
    known = [mark.kind for mark in storyboard_of(episode).marks]
    unknown = replace(episode, goal=np.zeros_like(episode.goal), success=False)
    assert [mark.kind for mark in storyboard_of(unknown).marks] == ["start", "agent"]
    assert known[-1] == "goal"
    assert ("take" in known) is (episode.thing is not None)
