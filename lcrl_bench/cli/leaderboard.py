"""`lcrl-bench leaderboard`: verify submissions by re-running them, and build the page."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.fan_out import FanOut, command_of, do_jobs, say_part
from lcrl_bench.cli.output import (
    print_json,
    print_table,
    print_text,
    say,
    stdout_kept_clean,
    suggest,
)
from lcrl_bench.cli.progress import working
from lcrl_bench.cli.submit import SUBMISSIONS
from lcrl_bench.errors import ExitCode, NothingSelectedError
from lcrl_bench.interruption import resumable
from lcrl_bench.jobs.engine import Ended
from lcrl_bench.jobs.job import forget

RECORDINGS = Path("leaderboard") / "recordings"

HELP = """usage: lcrl-bench leaderboard VERB [FLAGS]

  verify  re-evaluate submissions' checkpoints, compare every figure, record
  build   build one static page of all submissions, with their recordings
  schema  print the JSON schema of a submission

`lcrl-bench submit` makes submissions.
`lcrl-bench leaderboard verify --help` shows the flags."""

Json = Annotated[bool, tyro.conf.FlagCreatePairsOff]


@dataclass(frozen=True)
class VerifyFlags:
    """Re-evaluate submissions' checkpoints, compare every figure, and record the first seed.

    Loading a checkpoint runs its method's code: only methods registered here are run, or the one
    that you name.
    """

    files: Annotated[tuple[Path, ...], tyro.conf.Positional] = ()
    """The submissions; default: all of leaderboard/submissions. Each result is written beside its
    submission, as <name>.verified.json."""
    runs: Path | None = None
    """Folder of the checkpoints, with seed<k> or <benchmark>/<method>/seed<k>; default: where the
    submission says."""
    retrain: Path | None = None
    """Retrain every seed into RETRAIN/<benchmark>/<method>/seed<k> instead of loading checkpoints.
    The same machine and versions give the same bits; others must give every success rate within
    its interval."""
    method: str | None = None
    """Load with this method or `path/to/file.py:Class`: its code runs on this machine."""
    benchmark: str = ""
    """The folder of your own benchmark; default: the submission's shipped benchmark."""
    recordings: Path = RECORDINGS
    """Where recordings and pictures go: RECORDINGS/<name of the submission's file>."""
    no_record: bool = False
    """Compare the figures only, and record nothing."""
    device: str = "auto"
    """auto, cpu or cuda."""
    renderer: str = "auto"
    """Renders views that are not cached: auto, gl (MuJoCo's cameras), rays (no OpenGL)
    or warp (MuJoCo Warp)."""
    json: Json = False
    """Print only a JSON object on stdout."""
    fan_out: FanOut = field(default_factory=FanOut)


@dataclass(frozen=True)
class BuildFlags:
    """Write one static, self-contained page of all submissions; it makes no network requests."""

    submissions: Path = SUBMISSIONS
    """Folder of submissions, with the results of their verification."""
    out: Path = Path("leaderboard") / "site"
    """Folder to write index.html and its files to."""
    benchmarks: tuple[str, ...] = ()
    """Folders of your own benchmarks; shipped ones are found by name."""
    recordings: Path = RECORDINGS
    """Recordings of verified submissions."""
    no_viewer: bool = False
    """Link to recordings without a player in the page; saves 18 MB."""
    json: Json = False
    """Print only a JSON object on stdout."""


def main(argv: Sequence[str]) -> int:
    """Run one of the leaderboard's verbs."""
    verbs = {"verify": _verify, "build": _build, "schema": _schema}
    return run_verb(argv, verbs, kind="leaderboard verb", help_text=HELP)


def _verify(argv: Sequence[str]) -> int:
    flags = parse_arguments(VerifyFlags, argv, verb="leaderboard verify")
    from lcrl_bench.board.entries import submission_files
    from lcrl_bench.board.verification_jobs import Means, verification_jobs

    files = flags.files or submission_files(SUBMISSIONS)
    if not files:
        raise NothingSelectedError(
            f"No submission in {SUBMISSIONS.resolve()}. Run this in a checkout of the suite, or "
            "name the files. To make one: lcrl-bench submit"
        )
    means = Means(
        runs=_text(flags.runs),
        retrain=_text(flags.retrain),
        method=flags.method,
        benchmark=flags.benchmark,
        recordings=None if flags.no_record else str(flags.recordings),
        device=flags.device,
        renderer=flags.renderer,
    )
    command = command_of("leaderboard", "verify", *argv)
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        jobs = [job for file in dict.fromkeys(files) for job in verification_jobs(file, means)]
        done = do_jobs(jobs, flags.fan_out, share=1)
        if done.part is not None:
            return say_part(done, command)
        forget(jobs)
    ended = {each.key: each for each in done.ended}
    answers = [_answer(file, ended[str(file)]) for file in files]
    if flags.json:
        print_json({"submissions": answers})
    else:
        for answer in answers:
            _print_verdict(answer)
        if any(answer["verdict"] != "refused" for answer in answers):
            suggest(("lcrl-bench", "leaderboard", "build"), "the page")
    codes = [_code(answer, ended[answer["file"]]) for answer in answers]
    return next((code for code in codes if code != ExitCode.DONE), ExitCode.DONE)


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)


def _code(answer: dict[str, Any], ended: Ended) -> int:
    return ExitCode.RED if answer["verdict"] == "disputed" else ended.answer.exit_code


def _answer(file: Path, ended: Ended) -> dict[str, Any]:
    """The result of verifying a submission."""
    if ended.error is not None:
        return {"file": str(file), "verdict": "refused", "reason": ended.error}
    return {"file": str(file), **ended.answer.value}


def _print_verdict(answer: dict[str, Any]) -> None:
    if answer["verdict"] == "refused":
        say(f"refused: {answer['reason']}", style="bold red")
        return
    if answer["differences"]:
        rows = [
            [each["where"], str(each["submitted"]), str(each["found"])]
            for each in answer["differences"]
        ]
        print_table(["differs", "submitted", "found"], rows)
    print_text(f"{answer['verdict']}: {answer['file']}")


def _build(argv: Sequence[str]) -> int:
    flags = parse_arguments(BuildFlags, argv, verb="leaderboard build")
    from lcrl_bench.benchmarks.benchmark import Benchmark
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.board.entries import read_collection, submission_files
    from lcrl_bench.board.player import web_viewer
    from lcrl_bench.board.site import write_site

    if not submission_files(flags.submissions):
        raise NothingSelectedError(
            f"No submission in {flags.submissions.resolve()}. Run this in a checkout of the suite, "
            "or name their folder: --submissions FOLDER."
        )
    own = {each.name: each for each in map(read_benchmark, map(benchmark_folder, flags.benchmarks))}

    def benchmark_of(name: str) -> Benchmark:
        return own[name] if name in own else read_benchmark(benchmark_folder(name))

    with working("page"):
        collection = read_collection(flags.submissions, benchmark_of)
        viewer = None if flags.no_viewer else web_viewer()
        page = write_site(collection, flags.out, recordings=flags.recordings, viewer=viewer)
    rows = [(board, entry) for board in collection.boards for entry in board.entries]
    if flags.json:
        marks = {entry.stem: entry.mark for _, entry in rows}
        print_json({"page": str(page), "rows": marks, "refused": list(collection.refused)})
    else:
        print_table(
            ["submission", "benchmark", "title", "is"],
            [[e.stem, board.benchmark, e.submission.title, e.mark] for board, e in rows],
        )
        say(f"written: {page}   (open it in a browser)")
    for reason in collection.refused:
        say(f"refused: {reason}", style="bold red")
    return ExitCode.RED if collection.refused else ExitCode.DONE


def _schema(argv: Sequence[str]) -> int:
    @dataclass(frozen=True)
    class SchemaFlags:
        """Print the JSON schema of a submission: leaderboard/schema.json."""

    parse_arguments(SchemaFlags, argv, verb="leaderboard schema")
    from lcrl_bench.board.document import Submission

    print_json(Submission.model_json_schema())
    return ExitCode.DONE
