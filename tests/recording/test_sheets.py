"""Sheets of maps: every layer has a panel, in its place, in the colours of its numbers."""

from __future__ import annotations

import io
from itertools import combinations

import numpy as np
import pytest
from PIL import Image

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.floor import tile_centers
from lcrl_bench.recording.rerun.sheets import DOTS_PER_INCH, Sheet, draw_sheet
from lcrl_bench.recording.reward_plan import OPACITY
from lcrl_bench.recording.storyboard import storyboard_of

INCHES = (8.0, 5.0)


def pixels_of(sheet: Sheet) -> np.ndarray:
    with Image.open(io.BytesIO(sheet.png)) as picture:
        return np.asarray(picture.convert("RGB")).astype(int)


@pytest.fixture(params=["nav_episode", "pick_episode", "policy_episode"])
def episode(request: pytest.FixtureRequest) -> Episode:
    return request.getfixturevalue(request.param)


def test_every_layer_of_every_map_has_a_panel_of_its_own(episode: Episode):
    board = storyboard_of(episode)
    sheet = draw_sheet(board, board.maps, INCHES)
    shown = [(panel.tile_map.key, panel.layer) for panel in sheet.panels]
    assert shown == [
        (each.key, layer) for each in board.maps for layer in range(len(episode.parts))
    ]
    centers = tile_centers(episode.scene.grid)
    boxes = [(p.pixels(centers).min(axis=0), p.pixels(centers).max(axis=0)) for p in sheet.panels]
    for low, high in boxes:
        assert (low > 0).all()
        assert (high < np.array(INCHES) * DOTS_PER_INCH).all()
    for (low, high), (other_low, other_high) in combinations(boxes, 2):
        assert (high < other_low).any() or (other_high < low).any()


def test_a_panel_knows_where_its_tiles_are(episode: Episode):
    board = storyboard_of(episode)
    sheet = draw_sheet(board, board.maps, INCHES)
    picture = pixels_of(sheet)
    # A little south-west of the middle: signs stand there.
    spots = tile_centers(episode.scene.grid) - 0.2 * episode.scene.grid.tile
    right = total = 0
    for panel in sheet.panels:
        columns, rows = panel.pixels(spots).round().astype(int).T
        expected = panel.tile_map.colors[panel.layer] * OPACITY + 255 * (1 - OPACITY)
        away = np.abs(picture[rows, columns] - expected).max(axis=1)
        right, total = right + int((away < 12).sum()), total + len(away)
    # Marks, names and furniture cover some.
    assert right > 0.6 * total


def test_a_sheet_is_as_large_as_asked(pick_episode: Episode):
    board = storyboard_of(pick_episode)
    sheet = draw_sheet(board, board.maps, INCHES, legend=True)
    assert pixels_of(sheet).shape[:2] == (5 * DOTS_PER_INCH, 8 * DOTS_PER_INCH)


def test_visits_of_all_places_of_the_object_are_one_layer(pick_episode: Episode):
    board = storyboard_of(pick_episode)
    visits, expert = board.visits
    assert pick_episode.occupancy is not None
    by_tile = pick_episode.occupancy.reshape(3, -1).sum(axis=0)
    np.testing.assert_allclose(visits.layers, by_tile[None])
    assert visits.limits == expert.limits == (0.0, max(by_tile.max(), expert.layers.max()))
    panels = draw_sheet(board, board.visits, INCHES).panels
    assert all(panel.shows(state) for panel in panels for state in range(3))
    assert [panel.tile_map.titles for panel in panels] == [("",), ("",)]
