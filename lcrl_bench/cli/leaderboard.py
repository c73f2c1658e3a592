"""`lcrl-bench leaderboard`: verify submissions by running them again, and build the page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.output import (
    print_json,
    print_table,
    print_text,
    say,
    stdout_kept_clean,
    suggest,
)
from lcrl_bench.cli.progress import counting
from lcrl_bench.cli.submit import SUBMISSIONS
from lcrl_bench.errors import ExitCode

HELP = """usage: lcrl-bench leaderboard VERB [FLAGS]

  verify  evaluate a submission's checkpoints again, and compare every figure
  build   one static page of all submissions
  schema  the JSON schema of a submission

`lcrl-bench submit` makes submissions.
`lcrl-bench leaderboard verify --help` shows the flags."""

Json = Annotated[bool, tyro.conf.FlagCreatePairsOff]


@dataclass(frozen=True)
class VerifyFlags:
    """Evaluate a submission's checkpoints again, and compare every figure.

    To load a checkpoint is to run its method's code: only methods that are registered here are
    run, or the one that you name.
    """

    file: Annotated[Path, tyro.conf.Positional]
    """The submission. What is found is written beside it, as <name>.verified.json."""
    runs: Path | None = None
    """Where the checkpoints are: a folder of seed<k>, or of <benchmark>/<method>/seed<k>; by
    default where the submission says."""
    method: str | None = None
    """Load with this method or `path/to/file.py:Class`: its code runs on this machine."""
    benchmark: str = ""
    """The folder of a benchmark of your own; by default the shipped one of the submission."""
    device: str = "auto"
    """auto, cpu or cuda."""
    renderer: str = "auto"
    """For views that are not in the cache: auto, gl (MuJoCo's cameras) or rays (no OpenGL)."""
    json: Json = False
    """Print one JSON object on stdout, and nothing else there."""


@dataclass(frozen=True)
class BuildFlags:
    """Write one static page of all submissions: it opens from a file, and asks nobody anything."""

    submissions: Path = SUBMISSIONS
    """Folder of submissions, with what came of their verification beside them."""
    out: Path = Path("leaderboard") / "site"
    """Folder to write index.html to."""
    benchmark: str = "lcrl-v1"
    """Rows of another benchmark or fingerprint are refused."""
    artifacts: Path | None = None
    """Folder of pictures (.png) and recordings (.rrd), ARTIFACTS/<name of the submission's file>/;
    the page links to them where they are."""
    json: Json = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run one of the leaderboard's verbs."""
    verbs = {"verify": _verify, "build": _build, "schema": _schema}
    return run_verb(argv, verbs, kind="leaderboard verb", help_text=HELP)


def _verify(argv: Sequence[str]) -> int:
    flags = parse_arguments(VerifyFlags, argv, verb="leaderboard verify")
    from lcrl_bench.board.verification import verification_file
    from lcrl_bench.storage import write_json

    with stdout_kept_clean(flags.json):
        found = _run_again(flags)
    beside = verification_file(flags.file)
    write_json(beside, found.model_dump(mode="json"))
    if flags.json:
        print_json({"file": str(beside), **found.model_dump(mode="json")})
    else:
        _print_differences(found.differences)
        print_text(found.verdict)
        say(f"written: {beside}")
        suggest("lcrl-bench leaderboard build", "the page")
    return ExitCode.DONE if found.verdict == "verified" else ExitCode.RED


def _run_again(flags: VerifyFlags):  # noqa: ANN202 - the type imports torch
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.board.document import read_submission
    from lcrl_bench.board.verification import Claim, trusted_method, verify
    from lcrl_bench.evaluation.problems import Problem, compile_problems
    from lcrl_bench.evaluation.run import resolve_device

    submission = read_submission(flags.file)
    benchmark = read_benchmark(benchmark_folder(flags.benchmark or submission.benchmark))
    method = trusted_method(submission, flags.method, flags.file)
    device = resolve_device(flags.device)

    def problems() -> tuple[Problem, ...]:
        with counting("houses", len(benchmark.houses)) as advance:
            return compile_problems(
                benchmark,
                device=device,
                renderer=flags.renderer,
                image_size=submission.image_size,
                progress=advance,
            )

    claim = Claim(submission, flags.file, method, flags.runs)
    with counting("seeds", len(submission.seeds)) as advance:
        return verify(claim, benchmark, problems, device=device, progress=advance)


def _print_differences(differences: Sequence) -> None:
    if not differences:
        return
    rows = [[each.where, str(each.submitted), str(each.found)] for each in differences]
    print_table(["differs", "submitted", "found"], rows)


def _build(argv: Sequence[str]) -> int:
    flags = parse_arguments(BuildFlags, argv, verb="leaderboard build")
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.board.entries import read_board
    from lcrl_bench.board.page import write_page

    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    board = read_board(flags.submissions, benchmark)
    page = write_page(board, flags.out, artifacts=flags.artifacts)
    if flags.json:
        rows = {entry.stem: entry.mark for entry in board.entries}
        print_json({"page": str(page), "rows": rows, "refused": list(board.refused)})
    else:
        print_table(
            ["submission", "title", "is"],
            [[entry.stem, entry.submission.title, entry.mark] for entry in board.entries],
        )
        say(f"written: {page}")
    for reason in board.refused:
        say(f"refused: {reason}", style="bold red")
    return ExitCode.RED if board.refused else ExitCode.DONE


def _schema(argv: Sequence[str]) -> int:
    @dataclass(frozen=True)
    class SchemaFlags:
        """Print the JSON schema of a submission: leaderboard/schema.json."""

    parse_arguments(SchemaFlags, argv, verb="leaderboard schema")
    from lcrl_bench.board.document import Submission

    print_json(Submission.model_json_schema())
    return ExitCode.DONE
