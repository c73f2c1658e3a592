"""`lcrl-bench ask`: give a run's model any sentence, in any house."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_text, say, stdout_kept_clean, suggest, warn
from lcrl_bench.cli.progress import working
from lcrl_bench.errors import ExitCode


@dataclass(frozen=True)
class AskFlags:
    """Give a run's model a sentence: its reward map, path and outcome.

    Example: `lcrl-bench ask "move the cup to the bedroom"`.
    """

    sentence: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="SENTENCE")]
    """Any sentence."""
    run: Path = Path("runs")
    """The folder of a run, runs/<benchmark>/<method>/seed<k>, or one of several runs: the last one
    finished is used."""
    house: str | None = None
    """A house of the run's benchmark, or a house file of any known format; default: the first test
    house in which the sentence is unambiguous."""
    start: int | None = None
    """Tile to start on, facing north."""
    out: Path = Path("ask")
    """Folder for ask.png (reward, value and path) and ask.rrd (to scrub through)."""
    benchmark: str | None = None
    """Folder of the run's benchmark, if it isn't a shipped one."""
    renderer: str = "auto"
    """Renders views that are not cached: auto, gl (MuJoCo's cameras), rays (no OpenGL)
    or warp (MuJoCo Warp)."""
    json: bool = False
    """Print only a JSON object on stdout."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(AskFlags, argv, verb="ask")
    with stdout_kept_clean(flags.json):
        document = _ask(flags)
    for word, near in document["unknown_words"].items():
        hint = f" Did you mean '{near}'?" if near else ""
        warn(f"unknown word '{word}'.{hint}")
    for note in document["notes"]:
        say(f"note: {note}")
    if flags.json:
        print_json(document)
    else:
        print_text("\n".join(_lines(document)))
        say(f"picture: {document['picture']}, recording: {document['recording']}")
        suggest(("lcrl-bench", "view", document["recording"]), "scrub through it")
    return ExitCode.DONE


def _ask(flags: AskFlags) -> dict[str, Any]:
    from lcrl_bench.evaluation.finished_runs import find_run
    from lcrl_bench.evaluation.question import open_model, pose_question
    from lcrl_bench.recording.answer import PICTURE, RECORDING, answer_question, write_answer

    run = find_run(flags.run)
    if run != flags.run:
        say(f"run: {run}")
    model = open_model(run, benchmark=flags.benchmark)
    with working("answer"):
        question = pose_question(
            model, flags.sentence, house=flags.house, start=flags.start, renderer=flags.renderer
        )
        answer = answer_question(question)
        write_answer(flags.out, answer)
    files = {"picture": str(flags.out / PICTURE), "recording": str(flags.out / RECORDING)}
    return {**answer.document(), **files}


def _lines(document: dict[str, Any]) -> list[str]:
    """The answer as text."""
    start = document["start"]
    asked = f'"{document["sentence"]}" in {document["house"]} of {document["benchmark"]}'
    word = "best" if document["score"] == "reward" else "most visited"
    return [
        f"{asked}, by {document['method']}, seed {document['seed']}",
        f"start: tile {start['tile']}, {start['room']}, facing {start['heading']}",
        f"{word} places ({document['score']}):",
        *([f"  {_place(place)}" for place in document["best"]] or ["  no place stands out"]),
        f"path: {' > '.join(document['rooms'])}",
        *(f"  {_leg(leg)}" for leg in document["plan"]),
        _outcome(document),
    ]


def _place(place: dict[str, Any]) -> str:
    when = f", {place['when']}" if place["when"] else ""
    return f"{place['score']:8.2f}  tile {place['tile']}, {place['room']}{when}"


def _leg(leg: dict[str, Any]) -> str:
    words = []
    for action, same in itertools.groupby(leg["actions"]):
        count = len(list(same))
        words.append(action if count == 1 else f"{action} x{count}")
    steps = f"{leg['first']}-{leg['last']}"
    return f"{steps:>6}  {leg['room']}: {', '.join(words)}"


def _outcome(document: dict[str, Any]) -> str:
    if document["success"] is None:
        return 'goal: success can\'t be checked; use "go to X" or "move X to Y"'
    reached, shortest = document["reached_at"], document["optimal_length"]
    came = "not reached" if reached is None else f"reached at step {reached}"
    best = "it can't be reached" if shortest is None else f"the shortest path takes {shortest}"
    return f"goal: {came}; {best} (within {document['horizon']} steps)"
