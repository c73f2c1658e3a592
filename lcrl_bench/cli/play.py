"""`lcrl-bench play`: walk the agent by keyboard, in the terminal."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_text, say
from lcrl_bench.cli.progress import working
from lcrl_bench.errors import ExitCode, UsageError

if TYPE_CHECKING:
    from lcrl_bench.play.game import Game


@dataclass(frozen=True)
class PlayFlags:
    """Walk the agent through a task by keyboard, with its four views in colour and a map.

    Keys: w or up forward, a d or left right turn, space take or put, r again, n next task, v show
    the way, p let it walk, m another map, g hide the goal, q quit.
    Examples: `lcrl-bench play`, `lcrl-bench play --sentence "move the cup to the bedroom"`.
    """

    benchmark: str | None = None
    """A shipped benchmark's name, or a folder; default: the run's benchmark, or mini."""
    house: str | None = None
    """A house of the benchmark to play in; with a sentence, also a house file."""
    task: str | None = None
    """Task of the benchmark to start with."""
    sentence: str | None = None
    """Sentence to start with; its goal is known for "go to X" and "move X to Y"."""
    run: Path | None = None
    """A run whose path and reward to show: its folder, or one of several runs, of which the last
    finished one is used."""
    seed: int = 0
    """Seed for the order of tasks."""
    keys: str | None = None
    """Play these keys and print a page after each: `--keys "wwda q"`."""
    size: str = "80x24"
    """Columns and rows of the pages that `--keys` prints."""
    colors: Literal["auto", "full", "256", "none"] = "auto"
    """24-bit colours, 256, or letters; auto follows the terminal and NO_COLOR."""
    renderer: str = "auto"
    """Renders views that are not cached: auto, gl (MuJoCo's cameras), rays (no OpenGL)
    or warp (MuJoCo Warp)."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(PlayFlags, argv, verb="play")
    from lcrl_bench.play.colors import Colors, colors_wanted
    from lcrl_bench.play.keys import commands_of
    from lcrl_bench.play.session import play_keys, play_live
    from lcrl_bench.play.terminal import Terminal

    commands = None if flags.keys is None else commands_of(flags.keys)
    size = _size(flags.size)
    terminal = Terminal() if commands is None else None
    wanted = colors_wanted(
        os.environ, terminal=sys.stdout.isatty(), encoding=sys.stdout.encoding or ""
    )
    colors = wanted if flags.colors == "auto" else Colors(flags.colors)
    game = _game(flags)
    try:
        if terminal is not None:
            play_live(game, terminal, colors)
        else:
            play_keys(game, commands or (), _print_page, colors=colors, size=size)
    finally:
        for row in game.played:
            best = f"; the shortest path takes {row.shortest}" if row.shortest >= 0 else ""
            came = f"reached in {row.steps} steps" if row.reached else "not reached"
            say(f"{row.command}: {came}{best}")
    return ExitCode.DONE


def _game(flags: PlayFlags) -> Game:
    import numpy as np

    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.finished_runs import find_run
    from lcrl_bench.evaluation.question import open_model
    from lcrl_bench.play.game import Game
    from lcrl_bench.play.playlist import choose_tasks

    model = None
    if flags.run is not None:
        run = find_run(flags.run)
        if run != flags.run:
            say(f"run: {run}")
        model = open_model(run, benchmark=flags.benchmark)
        for note in model.notes:
            say(f"note: {note}")
        benchmark = model.benchmark
    else:
        benchmark = read_benchmark(benchmark_folder(flags.benchmark or "mini"))
    with working("houses"):
        playlist = choose_tasks(
            benchmark,
            generator=np.random.default_rng(flags.seed),
            house=flags.house,
            task=flags.task,
            sentence=flags.sentence,
            renderer=flags.renderer,
        )
    return Game(playlist, model=model)


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text)
    columns, rows = (int(found[1]), int(found[2])) if found else (0, 0)
    if columns < 20 or rows < 8:
        raise UsageError(f"--size {text} is not a page size. Example: --size 100x30.")
    return columns, rows


def _print_page(lines: list[str]) -> None:
    print_text("\n".join([*lines, ""]))
