"""Frames and text maps show the episode: the agent and the object where they are."""

from __future__ import annotations

import numpy as np
import pytest
from environment_samples import sample_benchmark

from lcrl_bench.envs.environment import HouseEnvironment
from lcrl_bench.envs.frame import SIZE, FramePainter
from lcrl_bench.envs.text_map import ARROWS, text_map
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.palette import AGENT, class_colors

BED = "rooms-a.go-to-the-bed"
TABLE = "rooms-a.move-the-cup-to-the-dining-table"


def make(mode: str, task: str) -> HouseEnvironment:
    environment = HouseEnvironment(
        benchmark=sample_benchmark(), renderer="rays", tasks=[task], render_mode=mode
    )
    environment.reset(seed=0)
    return environment


def agent_place(frame: np.ndarray) -> np.ndarray:
    """The middle of the agent's colour below the views: (column, row)."""
    rows, columns = np.nonzero((frame[220:] == AGENT).all(axis=2))
    return np.array([columns.mean(), rows.mean() + 220])


@pytest.mark.parametrize("task", [BED, TABLE])
def test_a_frame_is_of_one_size_and_the_same_whenever_painted(task):
    environment = make("rgb_array", task)
    frame = environment.render()
    assert (frame.shape, frame.dtype) == ((SIZE[1], SIZE[0], 3), np.uint8)
    assert (environment.render() == frame).all()
    assert (make("rgb_array", task).render() == frame).all()
    environment.step(1)
    assert (environment.render() != frame).any()


def test_the_views_show_the_colours_of_what_is_seen():
    environment = make("rgb_array", BED)
    frame, one = environment.render(), environment.played
    panorama = class_colors()[one.panorama(environment.state)]
    for number, view in enumerate(panorama):
        left = 12 + number * 172
        shown = frame[74 : 74 + 120 : 5, left : left + 160 : 5]
        assert (shown == view).all()


def test_the_agent_moves_on_the_frame_as_in_the_house():
    environment = make("rgb_array", BED)
    one, painter = environment.played, FramePainter(horizon=30)
    points = one.scene.grid.points
    places = np.array([agent_place(painter.paint(one, [4 * k])) for k in range(one.tiles)])
    # One scale in both directions, rows counted downwards.
    scale = np.polyfit(points[:, 0], places[:, 0], 1)[0]
    assert scale > 20
    shift = places - points * (scale, -scale)
    assert np.ptp(shift, axis=0).max() < 4


def test_a_task_painted_before_leaves_no_trace():
    first, second = make("rgb_array", BED), make("rgb_array", TABLE)
    painter = FramePainter(horizon=30)
    before = painter.paint(first.played, first.states)
    painter.paint(second.played, second.states)
    assert (painter.paint(first.played, first.states) == before).all()


@pytest.mark.parametrize("task", [BED, TABLE])
def test_the_text_shows_every_tile_once_and_the_agent_where_it_is(task):
    environment = make("ansi", task)
    one = environment.played
    for heading, arrow in enumerate(ARROWS):
        for tile in range(one.tiles):
            text = text_map(one, [tile * 4 + heading], horizon=30)
            lines = text.split("\n")[3:-2]
            tiles = [line for line in lines if "-" not in line]
            assert sum(len(line.replace(" ", "").replace("|", "")) for line in tiles) == one.tiles
            cells = one.scene.grid.cells - one.scene.grid.cells.min(axis=0)
            assert tiles[::-1][cells[tile, 1]][2 * cells[tile, 0]] == arrow


def test_the_text_of_a_nav_task_marks_its_goal_and_its_end():
    environment = make("ansi", BED)
    one = environment.played
    text = environment.render()
    assert text.startswith("go to the bed\nstep 0 of 30, facing east\n")
    assert "\n".join(text.split("\n")[:-1]).count("*") == one.goal.sum()
    (goal,) = np.flatnonzero(one.goal)[:1]
    assert "goal reached" in text_map(one, [int(goal) * 4], horizon=30)


def test_the_text_of_a_pick_task_says_where_the_object_is():
    environment = make("ansi", TABLE)
    one = environment.played
    for held, words in zip(ObjectState, ("at A", "in hand", "at B"), strict=True):
        text = text_map(one, [held * one.tiles * 4], horizon=30)
        assert f"cup {words}" in text
        assert ("goal reached" in text) == (held == ObjectState.AT_B)
    (away,) = np.flatnonzero(~one.object_tiles[0].numpy() & ~one.target_tiles[0].numpy())[:1]
    letters = "".join(text_map(one, [int(away) * 4], horizon=30).split("\n")[3:-2])
    both = (one.object_tiles[0].numpy() & one.target_tiles[0].numpy()).sum()
    assert letters.count("x") == both
    assert letters.count("a") == one.object_tiles[0].numpy().sum() - both
    assert letters.count("b") == one.target_tiles[0].numpy().sum() - both


def test_without_a_mode_nothing_is_rendered():
    environment = HouseEnvironment(benchmark=sample_benchmark(), renderer="rays")
    environment.reset()
    with pytest.warns(UserWarning, match="No render mode"):
        assert environment.render() is None
