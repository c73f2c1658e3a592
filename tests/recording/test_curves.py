"""Learning curves: every number that was logged is drawn, and smoothing is a plain mean."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.recording.curves import curves_figure, read_metrics, series, smoothed
from lcrl_bench.recording.figures import save_figure


@given(st.lists(st.floats(-100, 100), min_size=1, max_size=30), st.integers(1, 40))
def test_smoothing_is_the_mean_of_the_last_ones(values: list[float], window: int):
    expected = [np.mean(values[max(k - window, 0) : k]) for k in range(1, len(values) + 1)]
    np.testing.assert_allclose(smoothed(np.array(values), window), expected, atol=1e-9)


def test_the_loss_comes_first_and_what_is_no_finite_number_is_left_out():
    rows = [
        {"step": 1, "steps": 3, "accepted": 0.5, "loss": 2.0, "note": "begun"},
        {"step": 2, "steps": 3, "loss": float("nan")},
        {"step": 3, "steps": 3, "loss": 1.0},
    ]
    found = series(rows)
    assert list(found) == ["loss", "accepted"]
    np.testing.assert_array_equal(found["loss"], [[1, 3], [2.0, 1.0]])
    np.testing.assert_array_equal(found["accepted"], [[1], [0.5]])


def test_a_line_that_a_kill_cut_off_is_left_out(tmp_path: Path):
    path = tmp_path / "metrics.jsonl"
    path.write_text('{"step": 1, "loss": 2.0}\n[3]\n{"step": 2, "lo')
    assert read_metrics(path) == [{"step": 1, "loss": 2.0}]


@pytest.mark.parametrize(
    ("pass_steps", "words"),
    [(3, "pass over the training houses"), (None, "step (bold: mean over the last 1 steps)")],
)
def test_a_picture_names_its_curves_and_what_they_are_drawn_over(
    pass_steps: int | None, words: str, tmp_path: Path
):
    rows = [{"step": k, "steps": 9, "loss": 9 - k, "policy_loss": 0.5} for k in range(1, 10)]
    path = tmp_path / "curves.svg"
    save_figure(path, curves_figure(rows, title="lcrl on mini", pass_steps=pass_steps))
    text = path.read_text()
    for shown in ("lcrl on mini", ">loss<", ">policy loss<", words):
        assert shown in text, shown


def test_there_is_no_picture_of_nothing():
    with pytest.raises(ValueError, match="no number to draw"):
        curves_figure([{"step": 1}], title="nothing")
