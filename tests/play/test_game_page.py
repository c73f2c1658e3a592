"""The page as a person sees it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from game_samples import COUNTING, NAV, PICK, make_game, press
from rich.cells import cell_len

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import HEADINGS, ObjectState
from lcrl_bench.play.colors import Colors
from lcrl_bench.play.house_map import POINTERS, HouseMap
from lcrl_bench.play.page import Page

CODES = re.compile(r"\x1b\[[0-9;]*m")
SIZES = [(80, 24), (140, 50), (60, 20), (40, 12), (20, 8), (300, 100)]


def page(game, size=(80, 24), colors=Colors.PLAIN) -> list[str]:
    return Page(colors).lines(game, *size)


@pytest.mark.parametrize("colors", Colors)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("keys", ["", "vmw", "p"])
def test_no_line_is_wider_and_no_page_longer_than_the_terminal(size, colors, keys):
    lines = page(press(make_game(PICK, model=COUNTING), keys), size, colors)
    assert len(lines) == size[1]
    assert max(cell_len(CODES.sub("", line)) for line in lines) <= size[0]


def test_a_usual_terminal_shows_everything():
    game = make_game(PICK)
    text = "\n".join(page(game))
    for words in (
        "move the cup to the bed",
        "step 0 of 30",
        "in the kitchen, facing south",
        "the cup is at A",
        "[   ahead: south   ]",
        "left: east",
        "right: west",
        f"the shortest way takes {game.shortest} steps",
        "q quit",
    ):
        assert words in text
    assert "is small" not in text
    assert "40 x 12 is small" in "\n".join(page(game, (40, 12)))


def test_plain_pages_are_of_ascii_letters_alone():
    game = make_game(PICK, model=COUNTING)
    for keys in ("", "v", "m", "ww", "p", "n"):
        text = "\n".join(page(press(game, keys)))
        assert text.isascii()
        assert "\x1b" not in text


def test_what_comes_of_it_is_said():
    game = press(make_game(NAV), "p")
    assert f"goal reached in {game.shortest} steps, the shortest way" in "\n".join(page(game))
    late = press(make_game(NAV), "ddddp")
    assert f"the shortest way takes {late.shortest}" in "\n".join(page(late, (140, 40)))
    lost = press(make_game(PICK), "d" * 30)
    assert "no steps left" in "\n".join(page(lost))


def test_the_guide_says_the_next_action_and_the_hand_is_shown():
    game = make_game(PICK)
    assert "optimum says" not in "\n".join(page(game))
    assert "optimum says: " in "\n".join(page(press(game, "v")))
    while game.walk.object_state == ObjectState.AT_A:
        game.step()
    assert "the cup is in your hand" in "\n".join(page(game))


def test_everything_in_sight_has_its_colour_and_its_name():
    game = make_game(PICK)
    seen = np.unique(game.walk.played.panorama(game.walk.state))
    text = "\n".join(page(game, (140, 50), Colors.FULL))
    for number in seen.tolist():
        entry = semantic_classes()[number]
        red, green, blue = entry.color
        assert re.search(rf"48;2;{red};{green};{blue}m  \x1b\[0m {entry.words}", text)


def test_the_maps_colours_are_those_of_the_reward_if_it_is_asked_for():
    game = make_game(PICK, model=COUNTING)
    rooms = page(game, colors=Colors.FULL)
    reward = page(press(game, "m"), colors=Colors.FULL)
    assert rooms[12] != reward[12]
    assert "map: reward of counting" in "\n".join(reward)


@pytest.mark.parametrize("scale", [1, 2])
def test_the_map_shows_the_agent_where_it_is_and_faces(scale):
    walk = make_game(PICK).walk
    one = walk.played
    house = HouseMap(one, scale=scale)
    cells = one.scene.grid.cells
    places = set()
    for state in range(one.tiles * HEADINGS):
        lines = house.draw([state], colors=Colors.FULL, marks=False).lines(Colors.PLAIN)
        pointer = POINTERS[state % HEADINGS]
        (row,) = [k for k, line in enumerate(lines) if pointer in line]
        places.add((row, lines[row].index(pointer)))
        column, north = cells[state // HEADINGS] - cells.min(axis=0)
        assert row // scale == cells[:, 1].max() - cells[:, 1].min() - north
        assert lines[row].index(pointer) // (2 * scale) == column
    assert len(places) == one.tiles


def test_a_wall_is_drawn_wherever_a_step_east_or_south_is_impossible():
    one = make_game(NAV).walk.played
    grid = one.scene.grid
    start = int(one.start[0])
    lines = HouseMap(one).draw([start], colors=Colors.PLAIN, marks=False)
    text = [line.ljust(200) for line in lines.lines(Colors.PLAIN)]
    north, west = grid.cells[:, 1].max(), grid.cells[:, 0].min()
    for tile, (column, row) in enumerate(grid.cells.tolist()):
        letters = text[north - row][2 * (column - west) :][:2]
        assert (letters[1] == "|") == (grid.neighbours[tile, 1] < 0)
        if tile != start // HEADINGS and letters[1] != "|":
            assert (letters[1] == "_") == (grid.neighbours[tile, 2] < 0)


def test_the_goal_is_marked_unless_it_is_hidden():
    game = make_game(PICK)
    shown = "\n".join(page(game))
    hidden = "\n".join(page(press(game, "g")))
    tiles = int(game.walk.played.object_tiles.sum())
    assert shown.count("a") - hidden.count("a") >= tiles - 1
    assert page(press(game, "g")) == shown.split("\n")


def test_a_map_of_too_many_rows_follows_the_agent():
    one = make_game(NAV).walk.played
    house = HouseMap(one, scale=2)
    for tile in range(one.tiles):
        first = house.window([tile * HEADINGS], 4)
        lines = house.draw([tile * HEADINGS], colors=Colors.FULL).lines(Colors.PLAIN)
        assert 0 <= first <= house.rows - 4
        assert any(POINTERS[0] in line for line in lines[first : first + 4])
