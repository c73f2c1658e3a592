"""`lcrl-bench play --keys`: pages without a terminal."""

from __future__ import annotations

from pathlib import Path

import pytest
from environment_samples import sample_benchmark
from house_samples import two_rooms
from run_samples import write_run

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import write_house


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("play") / "rooms"
    write_benchmark(path, sample_benchmark())
    return path


@pytest.fixture
def play(folder, capsys):
    """Plays keys, and returns the pages and what was said."""

    def pages(keys: str, *more: str) -> tuple[list[str], str]:
        words = ["play", "--benchmark", str(folder), "--renderer", "rays", "--keys", keys, *more]
        code = main(words)
        shown = capsys.readouterr()
        assert code == ExitCode.DONE, shown.err
        lines = shown.out.split("\n")
        return ["\n".join(lines[k : k + 24]) for k in range(0, len(lines) - 1, 25)], shown.err

    return pages


def test_there_is_a_page_before_the_first_key_and_one_after_each(play):
    pages, _ = play("wwda ", "--task", "rooms-a.go-to-the-bed")
    assert len(pages) == 6
    for step, page in enumerate(pages):
        assert page.startswith("go to the bed")
        assert f"step {step} of 30" in page


def test_nothing_comes_after_quitting(play):
    assert len(play("wwqww", "--task", "rooms-a.go-to-the-bed")[0]) == 3


def test_what_was_played_is_said_at_the_end(play):
    pages, said = play("p", "--task", "rooms-a.move-the-cup-to-the-bed")
    assert "goal reached" in pages[-1]
    assert "move the cup to the bed: reached in" in said


def test_a_runs_maps_and_way_are_shown(play, folder, tmp_path):
    run = write_run(tmp_path / "run")
    pages, said = play("vvm", "--run", str(run), "--house", "rooms-a")
    assert "lcrl says: " in pages[2]
    assert "map: reward of lcrl" in pages[3]
    # The run learned on another benchmark, and that is said.
    assert "fingerprint" in said


def test_a_sentence_is_played_in_a_house_of_ones_own(play, tmp_path):
    file = tmp_path / "own.json"
    write_house(file, two_rooms())
    pages, _ = play("p", "--sentence", "move the cup to the bed", "--house", str(file))
    assert pages[0].startswith("move the cup to the bed")
    assert "two-rooms" in pages[0]
    assert "goal reached" in pages[-1]


def test_colours_are_printed_where_they_are_asked_for(play):
    assert "\x1b[" not in play("w")[0][0]
    assert "48;2;" in play("w", "--colors", "full")[0][0]
    assert "48;5;" in play("w", "--colors", "256")[0][0]


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ((), ExitCode.ENVIRONMENT, "--keys"),
        (("--keys", "x"), ExitCode.USAGE, "'x' is no key"),
        (("--keys", "w", "--size", "3x3"), ExitCode.USAGE, "--size 3x3"),
        (("--keys", "w", "--house", "attic"), ExitCode.USAGE, "is no house of rooms"),
        (("--keys", "w", "--task", "attic"), ExitCode.USAGE, "has no task 'attic'"),
    ],
)
def test_mistakes_are_named(folder, words, code, message, capsys):
    assert main(["play", "--benchmark", str(folder), *words]) == code
    assert message in capsys.readouterr().err
