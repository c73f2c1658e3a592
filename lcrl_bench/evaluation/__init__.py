"""Evaluation of fitted methods on all splits: harness, controls, tables and run folders."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.evaluation.figure import Figure as Figure
    from lcrl_bench.evaluation.outcome import Failure as Failure
    from lcrl_bench.evaluation.outcome import Outcome as Outcome
    from lcrl_bench.evaluation.results import Results as Results
    from lcrl_bench.evaluation.run import Run as Run
    from lcrl_bench.evaluation.run import RunSpec as RunSpec
    from lcrl_bench.evaluation.runs import evaluate as evaluate
    from lcrl_bench.evaluation.session import Session as Session
    from lcrl_bench.evaluation.session import Workplace as Workplace
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "Figure": ".figure",
            "Failure": ".outcome",
            "Outcome": ".outcome",
            "Results": ".results",
            "Run": ".run",
            "RunSpec": ".run",
            "evaluate": ".runs",
            "Session": ".session",
            "Workplace": ".session",
        },
    )
