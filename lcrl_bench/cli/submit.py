"""`lcrl-bench submit`: finished runs of a method as one JSON, a row of the leaderboard."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, say, suggest
from lcrl_bench.cli.progress import working
from lcrl_bench.errors import ExitCode

SUBMISSIONS = Path("leaderboard") / "submissions"


@dataclass(frozen=True)
class SubmitFlags:
    """Make one JSON of a method's finished runs: a row of the leaderboard."""

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """runs/<benchmark>/<method>: all its finished seeds; or the seed folders themselves."""
    out: Path | None = None
    """The file; by default leaderboard/submissions/<benchmark>-<method>.json."""
    pack: bool = False
    """Copy the checkpoints to leaderboard/checkpoints/<name of the file>/seed<k>/model, for a pull
    request: at most 4 MB."""
    checkpoints: Path | None = None
    """Where the checkpoints will be found, as seed<k>/model; by default where the runs are. It is
    written relative to the file."""
    weights: str = ""
    """Where checkpoints can be downloaded that are too large to pack: a URL."""
    benchmark: str = ""
    """The folder of a benchmark of your own; by default the shipped one that the runs name."""
    title: str = ""
    """What the row is called; by default as the folder of the runs."""
    summary: str = ""
    """A line about the method; by default the method's own."""
    author: str = ""
    """Who submits it; may be left out."""
    code: str = ""
    """Where the method's code is, with a commit; may be left out."""
    draft: bool = False
    """Take fewer than 3 seeds: the row is shown as a draft and never ranked."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(SubmitFlags, argv, verb="submit")
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.board.checkpoints import check_packable, pack
    from lcrl_bench.board.collection import Statement, benchmark_of, collect, seed_folders
    from lcrl_bench.storage import write_json

    folders = seed_folders(flags.runs)
    benchmark = read_benchmark(benchmark_folder(flags.benchmark or benchmark_of(folders[0])))
    default = SUBMISSIONS / f"{benchmark.name}-{folders[0].parent.name}.json"
    out = flags.out or default
    packed = out.parent.parent / "checkpoints" / out.stem if flags.pack else None
    if packed is not None:
        check_packable(folders)
    statement = Statement(
        title=flags.title,
        summary=flags.summary,
        author=flags.author,
        code=flags.code,
        weights=flags.weights,
        draft=flags.draft,
        checkpoints=flags.checkpoints,
        packed=packed,
    )
    with working("intervals"):
        submission = collect(folders, benchmark, statement, out=out)
    # Last, when nothing can be refused any more: checkpoints, then the file that names them.
    if packed is not None:
        pack(folders, packed)
    write_json(out, submission.model_dump(mode="json"))
    if flags.json:
        print_json({"submission": str(out), **submission.model_dump(mode="json")})
        return ExitCode.DONE
    print_table(["success, %", "mean", "95 % interval"], _rows(submission), right=["mean"])
    changed = ", ".join(f"{key}={value}" for key, value in submission.changed.items())
    say(f"settings: {changed or 'the defaults'} (preset {submission.preset})")
    if submission.deterministic:
        say("the method draws nothing: one seed counts for all of them")
    say(f"written: {out}{' (a draft: never ranked)' if submission.draft else ''}")
    suggest(_verify_command(submission, out, flags.runs[0]), "evaluate its checkpoints again")
    return ExitCode.DONE


def _verify_command(submission: Any, out: Path, run: Path) -> list[str]:  # noqa: ANN401
    """How to verify it: a method that is not registered has to be named."""
    from lcrl_bench.storage import read_json

    words = ["lcrl-bench", "leaderboard", "verify", str(out)]
    if submission.registered:
        return words
    (first, *_) = sorted(run.rglob("config.json"))
    return [*words, "--method", str(read_json(first)["method"])]


def _rows(submission: Any) -> list[list[str]]:  # noqa: ANN401 - pydantic is imported late
    from lcrl_bench.evaluation.table import cell, interval_cell

    rows = []
    for split, columns in submission.figures.items():
        figure = columns["total"]
        mean = None if figure is None else figure.mean
        rows.append([split.value, cell(mean), interval_cell(figure and figure.figure)])
    return rows
