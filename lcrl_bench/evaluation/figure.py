"""`Figure`: a number in a table; and the names of columns and values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, get_args

from lcrl_bench.evaluation.outcome import Failure

Column = Literal["pick", "nav", "total"]
COLUMNS: Final[tuple[Column, ...]] = get_args(Column)
"""The columns of a split."""
MEASURES: Final = {
    "success": "success",
    "final": "final_success",
    "path_weighted": "path_weighted",
    "regret": "regret",
}
"""Measures of every task: name in tables -> value."""
FAILURES: Final = {failure.value: f"failure_{failure.value}" for failure in Failure}
"""Failures of PICK tasks: name in tables -> value."""


@dataclass(frozen=True)
class Figure:
    """A mean in percent, with its 95 % interval if it has one."""

    mean: float
    low: float | None = None
    high: float | None = None
    n: int = 0
    """Tasks it is the mean over, times seeds."""

    @property
    def bounds(self) -> tuple[float, float] | None:
        """The ends of its interval; None if it has none."""
        return None if self.low is None or self.high is None else (self.low, self.high)


def language_value(control: str) -> str:
    """The value that holds success under a language control: `"success_wrong_target"`."""
    return f"success_{control.replace('-', '_')}"
