"""The controls in every table, and their evaluators."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.harness import (
    ConstantReward,
    evaluate,
    evaluate_optimal,
    evaluate_random,
)
from lcrl_bench.evaluation.lexical import LexicalReward
from lcrl_bench.evaluation.outcome import Outcome

Evaluator = Callable[[Sequence[TaskSet]], tuple[Outcome, ...]]

CONTROLS: Final[Mapping[str, Evaluator]] = {
    "random": evaluate_random,
    "optimal": lambda sets: evaluate_optimal(sets, sets[0].scene.semantics.success_reward),
    "constant": lambda sets: evaluate(ConstantReward(), sets),
    "lexical": lambda sets: evaluate(LexicalReward(), sets),
}
"""Maps control name to evaluator."""
