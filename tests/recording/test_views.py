"""What the agent sees, as pictures: panoramas, and a strip with every step and action once."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from lcrl_bench.houses.classes import class_id, semantic_classes
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import save_figure
from lcrl_bench.recording.storyboard import storyboard_of
from lcrl_bench.recording.views import (
    facing,
    frame_words,
    panorama_picture,
    strip_figure,
    strip_frames,
)


def test_a_panorama_is_drawn_in_the_colours_of_its_classes():
    views = np.array([[["bed", "cup"]], [["wall", "sofa"]], [["rug", "bed"]], [["lamp", "cup"]]])
    panorama = np.vectorize(class_id)(views).astype(np.uint8)
    picture = panorama_picture(panorama)
    assert picture.shape == (1, 8, 3)
    colors = {entry.name: entry.color for entry in semantic_classes()}
    expected = [colors[name] for name in views.reshape(-1)]
    assert [tuple(pixel) for pixel in picture[0].tolist()] == expected


@pytest.mark.parametrize("name", ["nav_episode", "pick_episode", "policy_episode"])
def test_each_step_is_in_one_frame_and_a_frame_holds_one_state(
    name: str, request: pytest.FixtureRequest
):
    episode: Episode = request.getfixturevalue(name)
    frames = strip_frames(episode.states)
    steps = [step for frame in frames for step in range(frame.first, frame.last + 1)]
    assert steps == list(range(episode.horizon + 1))
    for before, after in itertools.pairwise(frames):
        assert episode.states[before.last] != episode.states[after.first]
    for frame in frames:
        assert len(np.unique(episode.states[frame.first : frame.last + 1])) == 1


def test_the_words_tell_when_the_cup_is_in_hand_and_when_the_goal_is_reached(
    pick_episode: Episode,
):
    board = storyboard_of(pick_episode)
    words = [frame_words(board, frame) for frame in strip_frames(pick_episode.states)]
    acts = [below for _, below in words]
    taken, put = acts.index("take the cup"), acts.index("put the cup at B")
    for number, (above, _) in enumerate(words):
        assert ("has the cup" in above) == (taken < number <= put)
        assert ("at the goal" in above) == (number > put)


def test_a_strip_is_drawn_with_its_command(pick_episode: Episode, tmp_path: Path):
    path = tmp_path / "strip.svg"
    save_figure(path, strip_figure(storyboard_of(pick_episode)))
    text = path.read_text()
    for words in ("move the cup to the bed", "goal reached", "take the cup", ">bed<"):
        assert words in text, words


def test_what_lies_ahead_is_in_the_middle_of_the_panorama_and_its_views_join():
    views = np.arange(4, dtype=np.uint8)[:, None, None] * np.ones((4, 2, 6), np.uint8)
    for heading in range(4):
        picture = facing(views, heading)
        assert picture.shape == (2, 24)
        left, behind, right = ((heading + turn) % 4 for turn in (-1, 2, 1))
        expected = [behind] * 3 + [left] * 6 + [heading] * 6 + [right] * 6 + [behind] * 3
        np.testing.assert_array_equal(picture, [expected] * 2)
