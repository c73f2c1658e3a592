"""A question to a run's model: everything needed to answer a sentence in a house."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.evaluation.finished_runs import read_run
from lcrl_bench.evaluation.identity import edited_since
from lcrl_bench.evaluation.posed_sentence import PosedSentence, pose_sentence
from lcrl_bench.evaluation.sentences import known_words, nothing_known, unknown_words
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.storage import read_json


@dataclass(frozen=True, eq=False)
class Model:
    """What a run learned, and on which benchmark."""

    learned: Reward | Policy
    method: str
    seed: int
    benchmark: Benchmark
    notes: tuple[str, ...]
    """Notes on it, one sentence each."""


@dataclass(frozen=True, eq=False)
class Question:
    """A sentence in a house, and the model to answer it."""

    model: Model
    posed: PosedSentence
    unknown: dict[str, str | None]
    """Words unknown to the model, each with the nearest known one, or None."""
    meaningless: bool
    """Whether the model knows none of the words."""

    @property
    def own_house(self) -> bool:
        """Whether the house is outside the model's benchmark."""
        return self.posed.home is not self.model.benchmark

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes to the answer, one sentence each."""
        empty = "the command means nothing to this model; the map is noise"
        return (
            *self.model.notes,
            *([empty] if self.meaningless else []),
            *filter(None, [self.posed.asked.note]),
        )


def open_model(run: Path, *, benchmark: str | None = None) -> Model:
    """Load what a run learned, and the benchmark it learned on.

    Args:
        run: `runs/<benchmark>/<method>/seed<k>`.
        benchmark: A shipped benchmark's name or a folder; None means the one the run names.

    Raises:
        InvalidFileError: If the folder has no run, or its model is damaged.
        UnknownNameError: If its method or the benchmark is unknown here.
        UsageError: If it learned from views of another size than its benchmark's, or on a benchmark
            that is not shipped, and `benchmark` is None.
    """
    spec, learned = read_run(run)
    config = read_json(run / "config.json")
    found = read_benchmark(_folder(run, benchmark, str(config.get("benchmark"))))
    trained = str(config.get("fingerprint"))
    notes: tuple[str, ...] = ()
    if trained != found.fingerprint:
        notes = (
            f"the run learned on a benchmark with the fingerprint {trained[:12]}; that of"
            f" {found.name} is {found.fingerprint[:12]}",
        )
    if edited := edited_since(config, spec.method_class()):
        notes += (f"since the run was made, {' and '.join(edited)} changed",)
    return Model(learned, spec.method, spec.seed, found, notes)


def _folder(run: Path, benchmark: str | None, learned_on: str) -> Path:
    if benchmark is not None:
        return benchmark_folder(benchmark)
    try:
        return benchmark_folder(learned_on)
    except UnknownNameError as error:
        raise UsageError(
            f"{run} learned on a benchmark '{learned_on}', which is not shipped"
            f" ({', '.join(error.valid)}). Name its folder: --benchmark FOLDER."
        ) from error


def pose_question(
    model: Model,
    sentence: str,
    *,
    house: str | None = None,
    start: int | None = None,
    renderer: str = "auto",
) -> Question:
    """Ask a model a sentence; arguments and errors as in `pose_sentence`."""
    posed = pose_sentence(model.benchmark, sentence, house=house, start=start, renderer=renderer)
    words = known_words(model.learned, model.benchmark.vocabulary)
    command = posed.asked.task.command
    return Question(model, posed, unknown_words(command, words), nothing_known(command, words))
