"""Figures are legible on white paper and on a dark page, and to the colour-blind."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from PIL import Image
from sight import SIGHTS, contrast, distance, luminance

from lcrl_bench.errors import UsageError
from lcrl_bench.recording.curves import curves_figure
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import (
    DARK_OF,
    DARK_PAPER,
    PAPER,
    Theme,
    save_figure,
    with_dark_style,
)
from lcrl_bench.recording.maps import diverging
from lcrl_bench.recording.palette import (
    ACTION_COLORS,
    AGENT,
    BLACK,
    BLUE,
    GOAL,
    GREY,
    INK,
    PATH,
    SIGN,
    TAKE,
    Color,
    hex_color,
)
from lcrl_bench.recording.reward_plan import reward_map_figure
from lcrl_bench.recording.storyboard import storyboard_of
from lcrl_bench.recording.success_figure import PARTS
from lcrl_bench.recording.views import strip_figure

LETTERS = (INK, GREY, hex_color(BLUE), hex_color(BLACK), "#000000")
ROWS = [{"step": step, "loss": 1 / step} for step in range(1, 30)]


def rgb(color: str) -> NDArray[np.float64]:
    return np.array(to_rgb(color)) * 255


def in_the_dark(color: Color) -> Color:
    red, green, blue = rgb(DARK_OF.get(hex_color(color), hex_color(color))).round().astype(int)
    return red, green, blue


PARTS_OF_A_TABLE = tuple(color for _, _, color, _ in PARTS.values())
MARKS = {
    "marks": (TAKE, GOAL, AGENT, PATH),
    "actions": ACTION_COLORS,
    "a table": PARTS_OF_A_TABLE,
    "a table in the dark": tuple(map(in_the_dark, PARTS_OF_A_TABLE)),
}


@pytest.mark.parametrize("color", LETTERS)
def test_letters_stand_out_on_either_paper(color: str):
    assert contrast(rgb(color), rgb(PAPER)) > 4.5
    assert contrast(rgb(DARK_OF[color]), rgb(DARK_PAPER)) > 4.5


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("name", MARKS)
def test_marks_of_one_picture_differ_whatever_one_sees(name: str, sight: str):
    for one, other in combinations(MARKS[name], 2):
        assert distance(np.array(one), np.array(other), SIGHTS[sight]) > 12, (one, other)


def test_signs_stand_out_on_the_tiles_they_are_on():
    ends = diverging(np.array([0.0, 0.1, 0.2, 0.8, 0.9, 1.0]))
    assert min(contrast(color, np.array(SIGN)) for color in ends) > 3.0


def pixels_of(path: Path) -> NDArray:
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def draw_map(path: Path, episode: Episode, theme: Theme | None) -> None:
    save_figure(path, reward_map_figure(storyboard_of(episode)), theme)


def draw_strip(path: Path, episode: Episode, theme: Theme | None) -> None:
    save_figure(path, strip_figure(storyboard_of(episode)), theme)


def draw_curves(path: Path, _: Episode, theme: Theme | None) -> None:
    save_figure(path, curves_figure(ROWS, title="a run"), theme)


DRAWN = pytest.mark.parametrize("draw", [draw_map, draw_strip, draw_curves])


@DRAWN
def test_a_dark_picture_has_the_same_lines_on_dark_paper(draw, nav_episode, tmp_path: Path):
    for theme in ("light", "dark"):
        draw(tmp_path / f"{theme}.png", nav_episode, theme)
    light, dark = (pixels_of(tmp_path / f"{theme}.png") for theme in ("light", "dark"))
    assert light.shape == dark.shape
    paper = (light == rgb(PAPER)).all(axis=2)
    assert paper.mean() > 0.1
    assert (dark[paper] == rgb(DARK_PAPER).round()).all(axis=1).mean() > 0.98
    # Nothing that was there vanishes: what was darker than the paper is lighter than it now.
    ink = luminance(light) < 0.03
    assert (luminance(dark[ink]) > 0.3).mean() > 0.95


def test_data_keep_their_colours_in_the_dark(pick_episode: Episode, tmp_path: Path):
    draw_map(tmp_path / "dark.png", pick_episode, "dark")
    seen = {
        tuple(color) for color in np.unique(pixels_of(tmp_path / "dark.png").reshape(-1, 3), axis=0)
    }
    for color in (TAKE, GOAL, AGENT):
        assert color in seen


@DRAWN
def test_an_svg_follows_its_reader_and_is_else_the_light_one(draw, nav_episode, tmp_path: Path):
    draw(tmp_path / "light.svg", nav_episode, "light")
    draw(tmp_path / "auto.svg", nav_episode, None)
    light, auto = ((tmp_path / name).read_text() for name in ("light.svg", "auto.svg"))
    assert "prefers-color-scheme" not in light
    assert auto.count("prefers-color-scheme: dark") == 1
    assert auto == with_dark_style(light)
    assert ElementTree.fromstring(auto).tag.endswith("svg")
    # Every neutral colour that occurs has a rule.
    for color in (INK, PAPER):
        assert f": {color}" in light
        assert f'[style*="fill: {color}"] {{ fill: {DARK_OF[color]} !important }}' in auto


def test_only_an_svg_can_follow_its_reader(nav_episode: Episode, tmp_path: Path):
    with pytest.raises(UsageError, match=r"one\.png: only an \.svg follows .* light, dark"):
        draw_curves(tmp_path / "one.png", nav_episode, "auto")
    assert list(tmp_path.iterdir()) == []
