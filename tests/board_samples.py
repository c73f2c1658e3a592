"""A desk with finished runs of three seeds on the tiny benchmark, and their submission."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from benchmark_samples import tiny_benchmark, tiny_session

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.board.admission import read_submission
from lcrl_bench.board.checkpoints import pack
from lcrl_bench.board.collection import Statement, collect, seed_folders
from lcrl_bench.board.entries import Collection, read_collection
from lcrl_bench.board.verdict import Verification, verification_file
from lcrl_bench.board.verification import Claim, trusted_method, verify
from lcrl_bench.errors import UnknownNameError
from lcrl_bench.evaluation.run import Run, RunSpec, run
from lcrl_bench.evaluation.session import Session
from lcrl_bench.storage import write_json

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'&"
SETTINGS = {"passes": "1", "least_steps": "1"}
RUN = "lcrl-least_steps-1-passes-1"
"""The folder of a method with these settings."""
Show = Callable[[Run, Session], None]


@dataclass(frozen=True)
class Desk:
    """A folder with the benchmark, the runs, and a submission that goes with its checkpoints."""

    home: Path

    @property
    def benchmark(self) -> Path:
        return self.home / "tiny"

    @property
    def runs(self) -> Path:
        return self.home / "runs" / "tiny" / RUN

    @property
    def file(self) -> Path:
        return self.home / "leaderboard" / "submissions" / "tiny-lcrl.json"

    @property
    def again(self) -> Path:
        """Where seeds are trained again."""
        return self.home / "again"

    def document(self) -> dict[str, Any]:
        return json.loads(self.file.read_text())

    def rewrite(self, document: dict[str, Any]) -> Path:
        write_json(self.file, document)
        return self.file

    def copy(self, home: Path) -> Desk:
        """A desk of one's own, to spoil."""
        shutil.copytree(self.home, home, dirs_exist_ok=True)
        return Desk(home)

    def verify(
        self, *, show: Show = lambda *_: None, method: str | None = None, **changes: Any
    ) -> Verification:
        submission = read_submission(self.file)
        trusted = trusted_method(submission, method, self.file)
        claim = Claim(submission, self.file, trusted, **changes)
        session = tiny_session(self.again)
        return verify(claim, session, show=lambda run: show(run, session))

    def verify_and_keep(self, *, show: Show = lambda *_: None) -> None:
        found = self.verify(show=show)
        write_json(verification_file(self.file), found.model_dump(mode="json"))

    def collection(self) -> Collection:
        return read_collection(self.file.parent, benchmark_of)


def benchmark_of(name: str) -> Benchmark:
    """The benchmarks that are known on a desk: the tiny one, under two names."""
    if name not in ("tiny", "twin"):
        raise UnknownNameError("benchmark", name, ("tiny", "twin"))
    return replace(tiny_benchmark(), name=name)


def make_desk(
    home: Path, name: str = "lcrl", settings: Mapping[str, str] = MappingProxyType(SETTINGS)
) -> Desk:
    """Train and evaluate three seeds of a method, and submit them: LC-RL for one pass each."""
    desk = Desk(home)
    benchmark, session = tiny_benchmark(), tiny_session(home / "runs")
    write_benchmark(desk.benchmark, benchmark)
    runs = [run(RunSpec.of(name, settings, seed=seed), session) for seed in range(3)]
    folders = seed_folders([runs[0].folder.path.parent])
    packed = pack(folders, home / "leaderboard" / "checkpoints" / desk.file.stem)
    said = Statement(title="LC-RL", author="A. Newcomer", checkpoints=packed)
    submission = collect(folders, benchmark, said, out=desk.file)
    desk.rewrite(submission.model_dump(mode="json"))
    return desk
