"""The gallery shows every house it is given."""

import numpy as np
from benchmark_samples import tiny_benchmark
from PIL import Image

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.recording.gallery import most_telling


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
    assert main([*words, "--houses", "attic"]) == ExitCode.USAGE
    assert "attic" in capsys.readouterr().err
