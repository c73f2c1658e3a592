"""The gallery shows every house it is given."""

import re
from pathlib import Path

import numpy as np
import pytest
from benchmark_samples import tiny_benchmark
from house_samples import two_rooms
from matplotlib.colors import to_rgb
from PIL import Image

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.benchmark import GalleryFlags
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.recording.figures import DARK_PAPER
from lcrl_bench.recording.pictures import Exhibit, gallery_picture, most_telling


@pytest.fixture(autouse=True)
def small_houses(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sixteenth of the rays."""
    monkeypatch.setattr("lcrl_bench.recording.pictures.GALLERY_SIZE", (190, 160))


def test_the_panorama_with_the_most_classes_is_chosen():
    panoramas = np.zeros((3, 4, 24, 32), np.uint8)
    panoramas[1, 0, 0, :5] = range(5)
    panoramas[2, 0, 0, :3] = range(3)
    assert most_telling(panoramas) == 1


def test_a_sheet_of_houses_is_drawn_and_an_unknown_house_is_named(tmp_path, capsys):
    write_benchmark(tmp_path / "tiny", tiny_benchmark())
    sheet = tmp_path / "gallery.png"
    words = ["benchmark", "gallery", str(tmp_path / "tiny"), "--out", str(sheet)]
    assert main(words) == ExitCode.DONE
    pixels = np.asarray(Image.open(sheet).convert("RGB"))
    thirds = np.array_split(pixels, 3, axis=1)
    assert all((third < 200).any() for third in thirds), "three houses side by side"
    assert (pixels[:4] == 255).all(), "white paper"
    assert main([*words, "--houses", "attic"]) == ExitCode.USAGE
    assert "attic" in capsys.readouterr().err


def test_a_sheet_for_a_dark_page_is_dark_between_the_houses(tmp_path):
    panorama = np.zeros((4, 24, 32), np.uint8)
    gallery_picture(tmp_path / "dark.png", [Exhibit(two_rooms(), panorama)], "dark")
    pixels = np.asarray(Image.open(tmp_path / "dark.png").convert("RGB")).reshape(-1, 3)
    paper = np.array(to_rgb(DARK_PAPER)) * 255
    assert (pixels == paper.round()).all(axis=1).mean() > 0.2
    assert not (pixels == 255).all(axis=1).any()


def test_the_commands_of_the_page_are_understood():
    page = (Path(__file__).parents[2] / "docs" / "gallery.md").read_text("utf-8")
    (block,) = re.findall(r"```sh\n(.*?)```", page, flags=re.DOTALL)
    for line in block.splitlines():
        program, verb, part, *words = line.split()
        assert (program, verb, part) == ("lcrl-bench", "benchmark", "gallery")
        assert parse_arguments(GalleryFlags, words, verb="benchmark gallery")
