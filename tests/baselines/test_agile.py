"""AGILE: the filter keeps the lowest, goals are recognised, a killed run goes on to equal bits."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets
from hypothesis import given
from hypothesis import strategies as st
from lcrl_bench.baselines.agile.method import Agile, AgileConfig, keep_lowest
from task_samples import cell_rewards, sample_train_set, with_goals

from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.harness import evaluate
from lcrl_bench.methods.train_set import train_set

CPU = torch.device("cpu")
BRIEF = AgileConfig(passes=4, least_steps=0, acting=5, episodes=4, agent_hidden=8, replay=200)


def fit(train, config, *, log=lambda _: None, checkpoint=None):
    generator = torch.Generator().manual_seed(0)
    return Agile(config).fit(train, generator=generator, device=CPU, log=log, checkpoint=checkpoint)


@given(
    logits=st.lists(st.floats(-9, 9, width=32), min_size=1, max_size=40),
    fraction=st.floats(0.01, 1.0),
)
def test_the_filter_keeps_the_lowest_share(logits, fraction):
    kept = sorted(keep_lowest(torch.tensor(logits), fraction).tolist())
    assert kept == sorted(logits)[: len(kept)]
    assert len(kept) == max(1, int(fraction * len(logits)))


def test_what_is_dropped_has_no_gradient():
    logits = torch.tensor([3.0, -1.0, 2.0, 0.0], requires_grad=True)
    keep_lowest(logits, 0.5).sum().backward()
    assert logits.grad is not None
    assert logits.grad.tolist() == [0.0, 1.0, 0.0, 1.0]


def test_goals_are_told_from_most_of_what_is_seen():
    train, truth = sample_train_set(0), sample_train_set(0, oracle=True)
    config = AgileConfig(passes=100, least_steps=0, acting=4, agent_hidden=8, keep_fraction=0.75)
    rows = []
    learned = fit(train, config, log=rows.append)
    assert sum(row["recognised"] for row in rows[-20:]) / 20 > 0.7
    assert rows[-1]["loss"] < rows[0]["loss"]
    ranks = []
    for tasks, batch in with_goals(train, truth):
        scores = cell_rewards(learned, tasks)
        goals = torch.where(batch.goal, scores, torch.nan).nanmean(1, keepdim=True)
        ranks.append(((scores < goals) & ~batch.goal).sum(1) / (~batch.goal).sum(1))
    assert float(torch.cat(ranks).mean()) > 0.8


def test_a_benchmark_is_learned_from_and_evaluated():
    sets = tiny_task_sets()
    train = train_set(tiny_benchmark(), sets, oracle=False)
    rows = []
    learned = fit(train, BRIEF, log=rows.append)
    assert {"loss", "accepted", "recognised", "policy_loss"} <= set(rows[-1])
    assert all(0.0 <= row["accepted"] <= 1.0 for row in rows)
    assert len(evaluate(learned, sets)) == len(tiny_benchmark().tasks)


class KilledError(Exception):
    """Stands in for a kill."""


def test_a_killed_run_goes_on_to_the_same_bits(tmp_path: Path):
    train = sample_train_set(1)
    config = replace(BRIEF, checkpoint_passes=1)
    whole = fit(train, config)

    def kill(row):
        if row["step"] == 6:
            raise KilledError

    with pytest.raises(KilledError):
        fit(train, config, log=kill, checkpoint=tmp_path)
    rows = []
    resumed = fit(train, config, log=rows.append, checkpoint=tmp_path)
    assert rows[0]["step"] == 5, "two of four passes of two houses were done"
    expected = whole.network.state_dict()
    assert all(torch.equal(v, expected[name]) for name, v in resumed.network.state_dict().items())


@pytest.mark.parametrize(
    "bad", [{"keep_fraction": 0.0}, {"keep_fraction": 1.5}, {"negatives": 0}, {"acting": 0}]
)
def test_settings_that_can_not_be_trained_with_are_refused(bad):
    with pytest.raises(UsageError, match=r"keep_fraction lies in|start at 1"):
        AgileConfig(**bad)
