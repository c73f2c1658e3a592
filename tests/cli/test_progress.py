"""Where no bar is drawn, long work says how far it is every ten seconds: by a clock of the test.

Of jobs a line says which began and which ended.
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from lcrl_bench.cli.progress import (
    PERIOD_S,
    JobBar,
    Pulse,
    beat,
    counting,
    pulsing,
    working,
)
from lcrl_bench.jobs.engine import Ended

CLI = Path(__file__).parents[2] / "lcrl_bench" / "cli"


class Clock:
    """Seconds that pass when they are told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def spoken(pulse: Pulse, clock: Clock, seconds: int) -> list[str]:
    """What is said while so many seconds pass, looked at as often as the thread does."""
    lines: list[str] = []

    def ended(wait: float) -> bool:
        clock.now += wait
        return clock.now > 100 + seconds

    beat(pulse, ended, lines.append)
    return lines


def test_a_line_is_said_every_ten_seconds_and_says_how_far_it_is():
    clock = Clock()
    pulse = Pulse("houses", 76, clock=clock)
    pulse.done, pulse.note = 12, "last h12"
    assert PERIOD_S == 10
    assert spoken(pulse, clock, 35) == [
        "houses: 12 of 76, last h12 (10 s)",
        "houses: 12 of 76, last h12 (20 s)",
        "houses: 12 of 76, last h12 (30 s)",
    ]


def test_short_work_says_nothing():
    clock = Clock()
    assert spoken(Pulse("houses", 76, clock=clock), clock, 9) == []


def test_work_that_can_not_be_counted_says_that_it_goes_on():
    clock = Clock()
    assert spoken(Pulse("intervals", clock=clock), clock, 12) == ["intervals: at work (10 s)"]


def test_a_reader_that_left_stops_no_work():
    clock = Clock()

    def gone(_line: str) -> None:
        raise BrokenPipeError

    beat(Pulse("houses", clock=clock), lambda wait: _pass(clock, wait) > 130, gone)


def _pass(clock: Clock, wait: float) -> float:
    clock.now += wait
    return clock.now


def said_by(pulse: Pulse) -> str | None:
    """What a pulse would say if its ten seconds were over."""
    pulse.clock = lambda: pulse._began + PERIOD_S
    return pulse.due()


def test_jobs_say_which_are_at_work_and_how_far():
    with JobBar(4) as bar:
        bar.started("a/seed0")
        bar.started("b/seed0")
        bar.advanced("b/seed0", 0.5)
        bar.ended(Ended("a/seed0", None, 1.0))
        assert said_by(bar.pulse) == "jobs: 1 of 4, b/seed0 50 % (10 s)"


def test_a_job_says_what_else_it_tells():
    with JobBar(1) as bar:
        bar.started("lcrl/seed0")
        bar.advanced("lcrl/seed0", 0.2267, "loss 0.123")
        assert said_by(bar.pulse) == "jobs: 0 of 1, lcrl/seed0 23 % loss 0.123 (10 s)"


def test_a_thread_ends_with_its_work_and_with_an_error_of_it():
    import threading

    before = threading.active_count()
    with pytest.raises(ValueError, match="out of luck"), pulsing(Pulse("houses")):
        raise ValueError("out of luck")
    with counting("houses", 3) as advance, working("page"):
        advance("h")
    assert threading.active_count() == before


def test_where_there_is_a_terminal_a_bar_is_drawn_and_no_line(monkeypatch):
    import threading

    monkeypatch.setattr("lcrl_bench.cli.progress.bars_wanted", lambda: True)
    before = threading.active_count()
    with pulsing(Pulse("houses")):
        assert threading.active_count() == before


def test_no_verb_draws_a_bar_past_these():
    drawing = [
        file.name
        for file in sorted(CLI.glob("*.py"))
        for node in ast.walk(ast.parse(file.read_text("utf-8")))
        if isinstance(node, ast.ImportFrom) and node.module == "tqdm"
    ]
    assert drawing == ["progress.py"]


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
