"""`Submission`: one row of the leaderboard as a JSON file, read as if it were hostile.

Everything in it is bounded: texts, lists and numbers. What the models can't say is checked by
`admission.check_submission`. `leaderboard/schema.json` is generated from the models.
"""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Annotated, Final, Literal, TypeVar

from pydantic import AfterValidator, Field

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.documents import Document, Text
from lcrl_bench.evaluation.figure import Column, Figure
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.houses.document import Name

LEAST_SEEDS: Final = 3
"""Fewer are a draft: shown, never ranked."""
CURVE_POINTS: Final = 60

Measure = Literal["success", "final", "path_weighted", "regret"]
Reference = Literal["random", "optimal", "constant", "lexical"]
Percent = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
Number = Annotated[float, Field(ge=-1e12, le=1e12, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=1_000_000)]
Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
Setting = bool | int | Number | Text | None | list[int | Number | Text]


def _inside(path: str) -> str:
    """Refuse a path that leads out of the folder it is relative to."""
    parts = PurePosixPath(path).parts
    if not parts or path.startswith("/") or ".." in parts or "\\" in path:
        raise ValueError("a path inside the checkpoint's folder is wanted")
    return path


class Estimated(Document):
    """Mean success in per cent over seeds and tasks, with its 95 % interval."""

    mean: Percent
    low: Percent
    high: Percent
    n: Count
    """Tasks it is the mean over, times seeds."""

    @property
    def figure(self) -> Figure:
        """The same as a figure of results."""
        return Figure(self.mean, self.low, self.high, self.n)


class Successes(Document):
    """Success in per cent by kind of task; None where there is no such task."""

    pick: Percent | None
    nav: Percent | None
    total: Percent | None
    n: Count


Value = TypeVar("Value")

BySplit = Annotated[dict[Split, Value], Field(min_length=3, max_length=3)]
Measures = BySplit[
    Annotated[dict[Measure, dict[Column, Number | None]], Field(min_length=4, max_length=4)]
]
Failures = BySplit[Annotated[dict[Failure, Percent | None], Field(min_length=6, max_length=6)]]
Language = Annotated[dict[Control, BySplit[Successes]], Field(min_length=4, max_length=4)]
References = Annotated[dict[Reference, BySplit[Successes]], Field(min_length=4, max_length=4)]
Figures = BySplit[Annotated[dict[Column, Estimated | None], Field(min_length=3, max_length=3)]]


class CheckpointFile(Document):
    """A file of a seed's `model/`."""

    path: Annotated[str, Field(min_length=1, max_length=200), AfterValidator(_inside)]
    bytes: Annotated[int, Field(ge=0, le=2**33)]
    sha256: Hash


class Machine(Document):
    """What a seed was trained and evaluated with."""

    lcrl_bench: Text
    python: Text
    device: Text
    machine: Text
    cores: Annotated[int, Field(ge=1, le=100_000)] | None
    threads: Annotated[int, Field(ge=1, le=100_000)]
    versions: Annotated[dict[Text, Text], Field(max_length=32)]


class CurvePoint(Document):
    """The mean of the training loss up to a step, since the point before."""

    step: Annotated[int, Field(ge=0, le=10**12)]
    loss: Number


class SeedDocument(Document):
    """One seed's run."""

    seed: Annotated[int, Field(ge=0, lt=2**63)]
    files: Annotated[list[CheckpointFile], Field(min_length=1, max_length=64)]
    splits: BySplit[Successes]
    measures: Measures
    failures: Failures
    language: Language
    wall_s: Annotated[float, Field(ge=0, le=1e9, allow_inf_nan=False)]
    machine: Machine
    curve: Annotated[list[CurvePoint], Field(max_length=CURVE_POINTS)]


class Submission(Document):
    """One row of the leaderboard."""

    format: Literal["lcrl-submission"] = "lcrl-submission"
    version: Literal[1] = 1
    method: Name
    registered: bool
    """Whether the suite knows the method by its name; otherwise `verify` needs `--method`."""
    title: Annotated[Text, Field(min_length=1, max_length=80)]
    """What the row is called on the page."""
    summary: Text
    author: Text = ""
    code: Text = ""
    """Where the method's code is: a URL with a commit."""
    draft: bool
    """A draft may have fewer seeds, and is never ranked."""
    deterministic: bool = False
    """Whether the training draws nothing: then every seed is the same, and one stands for all."""
    oracle: bool
    expert: bool
    benchmark: Name
    fingerprint: Hash
    image_size: tuple[int, int] | None
    preset: Name
    changed: Annotated[dict[Text, Text], Field(max_length=64)]
    """Settings that were asked for, beside the preset: a reduced budget stands here."""
    settings: Annotated[dict[Text, Setting], Field(max_length=128)]
    """All settings."""
    run: Name
    """The name of the folder of the runs."""
    checkpoints: Annotated[str, Field(max_length=400, pattern=r"^[^/\x00-\x1f\\][^\x00-\x1f\\]*$")]
    """The folder of seed<k>/model, relative to this file."""
    weights: Text = ""
    """Where else the checkpoints can be had, if they don't come with this file: a URL."""
    figures: Figures
    measures: Measures
    failures: Failures
    language: Language
    controls: References
    """Of the benchmark: the same for every method."""
    seeds: Annotated[list[SeedDocument], Field(min_length=1, max_length=100)]
