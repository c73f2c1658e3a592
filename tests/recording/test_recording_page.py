"""The page about recordings: its programs run, and its tables are those of the code."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from episode_samples import NoiseReward, make_episode
from PIL import Image

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.view import ViewFlags
from lcrl_bench.recording.episode import Episode, write_episode
from lcrl_bench.recording.index import FILES, EpisodeIndex, RecordedEpisode
from lcrl_bench.recording.run_recording import SELECTIONS

PAGE = Path(__file__).parents[2] / "docs" / "reading-a-recording.md"
TEXT = PAGE.read_text("utf-8")
TASK = "procedural-1000007.move-the-plate-to-the-sofa"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, flags=re.DOTALL)


def first_column(heading: str) -> list[str]:
    """What is in code letters in the first column of the first table under a heading."""
    section = TEXT.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    cells = [row.split("|")[1] for row in section.splitlines() if row.startswith("|")]
    return [name for cell in cells for name in re.findall(r"`([^`]+)`", cell)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the record that the page reads, of a reward that is noise."""
    whole = read_benchmark(benchmark_folder("mini"))
    (task,) = [task for task in whole.tasks if task.id == TASK]
    house = task.house
    benchmark = replace(
        whole,
        houses={house: whole.houses[house]},
        grids={house: whole.grids[house]},
        tasks=(task,),
    )
    sets = load_task_sets(benchmark, device=torch.device("cpu"), renderer="rays")
    episode = make_episode(NoiseReward(), sets, benchmark, Kind.PICK)
    here = tmp_path_factory.mktemp("page")
    write_episode(here / "runs/mini/lcrl/seed0/episodes", TASK, episode)
    return here


@pytest.mark.parametrize(
    ("number", "made"), [(0, ["reward.png"]), (1, ["map.svg", "map-dark.png", "plate.rrd"])]
)
def test_the_programs_of_the_page_run(number: int, made: list[str], folder: Path):
    programs = blocks("python")
    assert len(programs) == 2
    command = [sys.executable, "-W", "error", "-c", programs[number]]
    environment = {**os.environ, "MPLBACKEND": "agg"}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for name in made:
        assert (folder / name).stat().st_size > 10_000, name
        if name.endswith(".png"):
            with Image.open(folder / name) as picture:
                assert len(np.unique(np.asarray(picture.convert("L")))) > 20


def test_the_commands_of_the_page_are_understood():
    for block in blocks("sh"):
        for line in block.splitlines():
            program, verb, *arguments = line.split()
            assert (program, verb) == ("lcrl-bench", "view")
            assert parse_arguments(ViewFlags, arguments, verb="view")


def test_every_picture_of_the_page_is_there():
    named = re.findall(r"images/[\w-]+\.png", TEXT)
    assert len(named) > 5
    assert [name for name in named if not (PAGE.parent / name).exists()] == []


def test_the_table_of_arrays_is_what_a_record_holds(
    nav_episode: Episode, pick_episode: Episode, tmp_path: Path
):
    held: list[str] = []
    for name, episode in (("nav", nav_episode), ("pick", pick_episode)):
        with np.load(write_episode(tmp_path, name, episode), allow_pickle=False) as file:
            held += file.files
    assert sorted(first_column("The record")) == sorted(set(held))


def test_the_table_of_the_index_is_what_it_holds():
    assert first_column("The index") == list(RecordedEpisode.model_fields)
    for name in (*EpisodeIndex.model_fields, *FILES):
        assert re.search(rf"`\"?{name}\"?`", TEXT), name


def test_the_table_of_selections_is_that_of_the_command():
    listed = [name for name in first_column("Recording more") if not name.startswith("--")]
    assert tuple(listed) == SELECTIONS
