"""Results written by hand: of outcomes, or of a table of successes."""

from __future__ import annotations

import numpy as np

from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.evaluation.results import Results, TaskRow


def outcome(
    success: float, *, kind: Kind = Kind.NAV, split: Split = Split.TRAIN, task: str = "t"
) -> Outcome:
    """What came of a task; where a PICK task fails, its object stays where it was."""
    named = Task(
        id=task,
        kind=kind,
        split=split,
        house="h",
        command="go to the bed",
        target="bed",
        start_tile=0,
        start_heading=0,
        proof=Proof(1, 1.0, 0.0),
    )
    lost = {Failure.WAITS_AT_A: 1 - success} if kind == Kind.PICK else {}
    failures = {failure: lost.get(failure, 0.0) for failure in Failure} if lost else {}
    return Outcome(named, success, success / 2, success / 4, 1 - success, failures)


def results_of(*outcomes: Outcome, method: str = "lcrl", seed: int = 0) -> Results:
    """The results of a run with these outcomes."""
    return Results.of(method, seed, outcomes)


def success_results(success: list[list[float]], *, ids: str = "abcd") -> Results:
    """Results of up to four tasks in three houses, success alone: one row of numbers per seed."""
    rows = tuple(
        TaskRow(name, split, kind, house, "go to the bed", 1, 0.0)
        for name, split, kind, house in zip(
            ids,
            ("train", "train", "test-house", "test-house"),
            ("pick", "nav", "pick", "nav"),
            ("h1", "h1", "h2", "h3"),
            strict=False,
        )
    )
    values = {"success": np.array(success, dtype=np.float64)}
    return Results("lcrl", tuple(range(len(success))), rows, values)
