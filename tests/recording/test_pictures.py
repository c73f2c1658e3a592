"""Pictures: written whole, the same every time, with what they are about named in them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from house_samples import two_rooms
from PIL import Image

from lcrl_bench.errors import UsageError
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.recording.bird import bird_picture
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import save_figure
from lcrl_bench.recording.palette import AGENT
from lcrl_bench.recording.pictures import house_picture, showcase_figure
from lcrl_bench.recording.reward_plan import reward_map_figure
from lcrl_bench.recording.storyboard import storyboard_of

SMALL = (240, 160)


def test_a_house_picture_says_which_house_it_is(nav_episode: Episode, tmp_path: Path):
    path = tmp_path / "plan.svg"
    house_picture(path, two_rooms(), nav_episode.scene.grid)
    text = path.read_text()
    assert ">two-rooms<" in text
    assert ">2 rooms, 5 objects, 28 tiles of 0.75 m<" in text


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_the_same_house_gives_the_same_file(suffix: str, tmp_path: Path):
    first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
    house_picture(first, two_rooms())
    house_picture(second, two_rooms())
    assert first.read_bytes() == second.read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == [first.name, second.name]


def test_a_picture_of_another_kind_is_refused(tmp_path: Path):
    with pytest.raises(
        UsageError, match=r"'.gif' is not a picture. Valid suffixes: .pdf, .png, .svg"
    ):
        house_picture(tmp_path / "plan.gif", two_rooms())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "titles"),
    [
        ("nav_episode", ["learned reward", "value", "goal: at the bed"]),
        (
            "pick_episode",
            [
                "learned reward, before the cup is taken",
                "value, with the cup in hand",
                "A: cup within reach",
            ],
        ),
        ("policy_episode", ["visits, before the cup is taken", "after the cup is put"]),
    ],
)
def test_a_reward_map_says_what_each_part_shows(
    name: str, titles: list[str], tmp_path: Path, request: pytest.FixtureRequest
):
    path = tmp_path / "map.svg"
    save_figure(path, reward_map_figure(storyboard_of(request.getfixturevalue(name))))
    text = path.read_text().replace("&#x27;", "'")
    for title in titles:
        assert title in text, title


def test_a_showcase_shows_the_house_the_views_and_the_reward(pick_episode: Episode, tmp_path: Path):
    path = tmp_path / "showcase.png"
    save_figure(path, showcase_figure(storyboard_of(pick_episode)))
    with Image.open(path) as picture:
        pixels = np.asarray(picture.convert("RGB")).reshape(-1, 3)
    seen = {tuple(color) for color in np.unique(pixels, axis=0).tolist()}
    bed = next(entry.color for entry in semantic_classes() if entry.name == "bed")
    assert bed in seen
    assert AGENT in seen


def test_a_birds_eye_picture_is_the_same_every_time(nav_episode: Episode):
    board = storyboard_of(nav_episode)
    first = bird_picture(board, 3, SMALL)
    np.testing.assert_array_equal(first, bird_picture(board, 3, SMALL))
    drawn = first[..., 3] > 0
    assert drawn.mean() > 0.4
    assert drawn[: len(drawn) // 8].any()
    later = bird_picture(board, 5, SMALL)
    assert later.shape != first.shape or (later != first).any()


def test_pictures_need_neither_a_screen_nor_rerun():
    code = (
        "import sys; import lcrl_bench.recording.pictures, lcrl_bench.recording.rollout; "
        "print([name for name in ('matplotlib.pyplot', 'rerun', 'mujoco') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
