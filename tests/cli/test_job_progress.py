"""Progress of jobs where there is no terminal: a line as each begins and ends."""

from __future__ import annotations

import pytest

from lcrl_bench.cli.progress import JobBar
from lcrl_bench.evaluation.workers import Ended


def test_a_line_says_what_began_what_ended_and_how_long_is_left(capsys, monkeypatch):
    clock = iter((0.0, 600.0, 600.0))
    monkeypatch.setattr("lcrl_bench.cli.progress.time.perf_counter", lambda: next(clock))
    with JobBar(4) as bar:
        bar.started("a/seed0")
        bar.started("b/seed0")
        bar.advanced("b/seed0", 0.5)
        bar.ended(Ended("a/seed0", None, 12.4))
        bar.ended(Ended("b/seed0", "out of luck", 3.0))
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "a/seed0: started",
        "b/seed0: started",
        # 1.5 of 4 jobs in 10 minutes leave 2.5 jobs: 16.7 minutes.
        "[1/4] a/seed0: 12 s (about 17 min left)",
        "[2/4] b/seed0: failed: out of luck (about 10 min left)",
    ]


def test_nothing_is_left_after_the_last(capsys):
    with JobBar(1) as bar:
        bar.started("a")
        bar.ended(Ended("a", None, 1.0))
    assert capsys.readouterr().err.splitlines()[-1] == "[1/1] a: 1 s"


def test_a_bar_stands_for_jobs_and_shares_of_jobs(monkeypatch):
    monkeypatch.setattr("lcrl_bench.cli.progress.bars_wanted", lambda: True)
    with JobBar(2) as bar:
        bar.started("a")
        bar.advanced("a", 0.25)
        assert bar._bar.n == pytest.approx(0.25)
        bar.ended(Ended("a", None, 1.0))
        assert bar._bar.n == pytest.approx(1.0)
