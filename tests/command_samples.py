"""Commands as forks of this process: started, killed, and what they make compared.

The process has imported what the commands need, so that a moment of a command falls into its work.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from collections.abc import Callable
from pathlib import Path

import lcrl_bench.benchmarks.build
import lcrl_bench.benchmarks.house_jobs
import lcrl_bench.cli.benchmark
import lcrl_bench.cli.house
import lcrl_bench.cli.reproduce
import lcrl_bench.cli.run
import lcrl_bench.evaluation.run_jobs
import lcrl_bench.methods.training
import lcrl_bench.recording.pictures
import lcrl_bench.scenes.report  # noqa: F401
from lcrl_bench.cli.main import main
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.storage import canonical_json, sha256_of

TIMED = {"wall_s", "since"}
"""Keys of what differs between equal runs."""
PASSING = {"DONE", "environment.json"}
"""Files that say when and where."""
PASSES = ("--set", "passes=6", "least_steps=6")
TICK_S = 0.005


def prepare(folder: Path, name: str) -> None:
    """Make what a command starts from: houses, a benchmark of them, its views, a trained run."""
    for seed in (11, 12):
        write_house(folder / "houses" / f"{seed}.json", generate_house(seed, rooms=4))
    for before in BEFORE[name]:
        _, code = finish(folder, COMMANDS[before](folder, folder))
        assert code == 0, folder.with_suffix(".log").read_text()


def _build(folder: Path, home: Path) -> list[str]:
    few = ("--name", "tiny", "--nav", "3", "--pick", "2", "--test-houses", "0.5")
    where = ("--houses", f"{folder}/houses", "--out", f"{home}/tiny", "--workers", "1")
    return ["benchmark", "build", *few, *where, "--renderer", "rays"]


def _train(folder: Path, home: Path) -> list[str]:
    where = ("--benchmark", f"{folder}/tiny", "--out", f"{home}/runs", "--no-record")
    return ["run", "--method", "lcrl", *where, *PASSES, "--renderer", "rays"]


def _reproduce(folder: Path, home: Path) -> list[str]:
    where = ("--benchmark", f"{folder}/tiny", "--out", f"{home}/runs", "--workers", "2")
    what = ("image-size", "--budget", "0.001", "--results", f"{home}/results")
    return ["reproduce", *what, *where, "--renderer", "rays"]


def _import(folder: Path, home: Path) -> list[str]:
    files = [str(path) for path in sorted((folder / "houses").glob("*.json"))]
    return ["house", "import", *files, "--out", f"{home}/imported", "--workers", "1"]


COMMANDS: dict[str, Callable[[Path, Path], list[str]]] = {
    "import": _import,
    "build": _build,
    "train": _train,
    "evaluate": _train,
    "reproduce": _reproduce,
}


BEFORE = {
    "import": (),
    "build": (),
    "train": ("build",),
    "evaluate": ("build", "train"),
    "reproduce": ("build", "train"),
}
"""What is done before a command, for it to start from."""


def begin(name: str, folder: Path, home: Path) -> None:
    """Lay out what a command finds: for `evaluate` a model that is trained and not evaluated."""
    home.mkdir()
    if name in ("train", "evaluate", "reproduce"):
        shutil.copytree(folder / "cache", home / "cache")
    if name == "evaluate":
        shutil.copytree(folder / "runs", home / "runs")
        for made in ("DONE", "summary.json", "episodes.parquet"):
            for path in (home / "runs").rglob(made):
                path.unlink()


def start(home: Path, words: list[str]) -> int:
    """Fork a command into a session of its own; returns its process."""
    child = os.fork()
    if child:
        return child
    os.setsid()
    os.environ["LCRL_BENCH_HOME"] = str(home / "cache")
    log = os.open(home.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os._exit(main(words))


def used(session: int) -> float:
    """Seconds of CPU time of the processes of a session, waited-for ones included."""
    total = 0
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = file.read_text().rpartition(") ")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session:
            total += sum(map(int, fields[11:15]))
    return total / os.sysconf("SC_CLK_TCK")


def finish(home: Path, words: list[str], limit: float | None = None) -> tuple[float, int]:
    """Run a command to its end, or kill it and its workers after `limit` seconds of CPU time.

    Returns:
        The CPU time used, and the exit status: negative if it was killed.
    """
    child = start(home, words)
    spent = 0.0
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return spent, os.waitstatus_to_exitcode(status)
        spent = max(spent, used(child))
        if limit is not None and spent >= limit:
            os.killpg(child, signal.SIGKILL)
            limit = None
        time.sleep(TICK_S)


def digests(home: Path) -> dict[str, str]:
    """SHA-256 of every file that a command made, without what says when and where."""
    found = {}
    for path in sorted(path for path in home.rglob("*") if path.is_file()):
        name = path.relative_to(home)
        if path.name in PASSING or name.parts[0] == "cache":
            continue
        data = path.read_bytes().replace(str(home).encode(), b"HOME")
        if path.suffix == ".json":
            data = canonical_json(timeless(json.loads(data)))
        if path.suffix == ".md":
            data = b"".join(line for line in data.splitlines() if b" s |" not in line)
        found[str(name)] = sha256_of(data)
    return found


def timeless(value: object) -> object:
    """A JSON value without the keys of times."""
    if isinstance(value, dict):
        return {key: timeless(each) for key, each in value.items() if key not in TIMED}
    return [timeless(each) for each in value] if isinstance(value, list) else value


def left(home: Path) -> list[str]:
    """Temporary files and locks that are still there."""
    found = [*home.rglob(".*"), *home.rglob("*.lock")]
    return [str(path.relative_to(home)) for path in found]
