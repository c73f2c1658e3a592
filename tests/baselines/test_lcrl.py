"""LC-RL: its gradient is the paper's, it learns, and a kill does not change a bit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import torch
from lcrl_bench.baselines.lcrl.method import LcRl, LcRlConfig
from task_samples import SUCCESS_REWARD, cell_rewards, sample_train_set, with_goals

from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.planning import q_iteration, soft_q_iteration
from lcrl_bench.mdp.success import success_probability, uniform_policy
from lcrl_bench.methods.contract import TrainSet
from lcrl_bench.methods.network_reward import NetworkReward

CPU = torch.device("cpu")
SHORT = LcRlConfig(least_steps=0, passes=6, checkpoint_passes=2)


class KilledError(Exception):
    """Stands for a kill in the middle of a training."""


def fit(train: TrainSet, config: LcRlConfig, *, seed: int = 0, **others) -> NetworkReward:
    generator = torch.Generator().manual_seed(seed)
    others.setdefault("log", lambda _row: None)
    return LcRl(config).fit(train, generator=generator, device=CPU, **others)


def weights(reward: NetworkReward) -> dict[str, torch.Tensor]:
    return reward.network.state_dict()


def mean_success(reward: NetworkReward, seed: int, *, commands=lambda texts: texts) -> float:
    """Success of the greedy policy of the learned reward on the true goals of training tasks."""
    train, truth = sample_train_set(seed), sample_train_set(seed, oracle=True)
    rates = []
    for tasks, batch in with_goals(train, truth):
        scores = cell_rewards(reward, tasks, commands(tasks.commands))
        rates.append(success_probability(batch, q_iteration(batch, scores.double()).policy))
    return float(torch.cat(rates).mean())


def log_likelihood(reward: NetworkReward, train: TrainSet, temperature: float) -> float:
    """Mean over tasks and demonstrations of sum_t gamma^t log pi_t(a_t | s_t)."""
    totals = []
    for tasks in train.tasks:
        scores = cell_rewards(reward, tasks)
        policy = soft_q_iteration(tasks, scores, temperature=temperature).policy
        for task, demos in enumerate(tasks.demonstrations):
            total = 0.0
            for t in range(tasks.horizon):
                here, onward = demos[:, t], demos[:, t + 1]
                # Several actions may lead to one state; each is as likely, and any will do.
                leads = tasks.next_state[task, here] == onward[:, None]
                chosen = policy[task, t, here, leads.int().argmax(-1)]
                total += tasks.discount**t * float(chosen.log().mean())
            totals.append(total)
    return sum(totals) / len(totals)


@pytest.fixture(scope="module")
def trained() -> NetworkReward:
    return fit(sample_train_set(0), LcRlConfig(least_steps=0, passes=100))


def test_the_reoptimised_reward_solves_the_training_tasks(trained):
    truth = sample_train_set(0, oracle=True)
    batches = truth.tasks
    chance = torch.cat([success_probability(b, uniform_policy(b)) for b in batches]).mean()
    best = torch.cat([success_probability(b, expert_policy(b, SUCCESS_REWARD)) for b in batches])
    assert float(best.min()) == 1.0
    assert float(chance) < 0.2
    assert mean_success(trained, 0) >= 0.9


def test_the_learned_reward_listens_to_the_command(trained):
    assert mean_success(trained, 0, commands=lambda texts: [""] * len(texts)) < 0.6
    assert mean_success(trained, 0, commands=lambda texts: [*texts[1:], texts[0]]) < 0.6


def test_the_reported_loss_is_the_likelihood_of_the_demonstrations():
    train = sample_train_set(2, houses=1)
    rows = []
    # A step too small to move a weight: what is reported is the loss of what is returned.
    config = LcRlConfig(least_steps=0, passes=1, learning_rate=1e-12, temperature=0.7)
    reward = fit(train, config, log=rows.append)
    batch = train.tasks[0]
    mass = sum(batch.discount**t for t in range(batch.horizon + 1))
    expected = -log_likelihood(reward, train, 0.7) / mass
    assert rows[0]["loss"] == pytest.approx(expected, rel=1e-4)


def test_training_raises_the_likelihood_of_the_demonstrations():
    train = sample_train_set(2, houses=1)
    before = fit(train, LcRlConfig(least_steps=0, passes=1, learning_rate=1e-12))
    after = fit(train, LcRlConfig(least_steps=0, passes=40))
    assert log_likelihood(after, train, 1.0) > log_likelihood(before, train, 1.0) + 1.0


def test_true_goals_are_never_looked_at():
    blind, seeing = sample_train_set(3), sample_train_set(3, oracle=True)
    first, second = weights(fit(blind, SHORT)), weights(fit(seeing, SHORT))
    assert all(torch.equal(first[name], second[name]) for name in first)


@pytest.mark.parametrize("killed_at", [3, 5, 8, 12])
def test_a_killed_training_goes_on_to_the_same_bits(tmp_path: Path, killed_at: int):
    train = sample_train_set(4)
    whole_rows, rows = [], []
    whole = weights(fit(train, SHORT, log=whole_rows.append))

    def die(row):
        rows.append(row)
        if row["step"] == killed_at:
            raise KilledError

    with pytest.raises(KilledError):
        fit(train, SHORT, log=die, checkpoint=tmp_path)
    resumed_rows = []
    resumed = weights(fit(train, SHORT, log=resumed_rows.append, checkpoint=tmp_path))
    assert all(torch.equal(whole[name], resumed[name]) for name in whole)
    # Two houses: a checkpoint every fourth step.
    assert resumed_rows == whole_rows[(killed_at - 1) // 4 * 4 :]


def test_a_training_that_is_done_is_not_repeated(tmp_path: Path):
    train = sample_train_set(4)
    first = weights(fit(train, SHORT, checkpoint=tmp_path))
    rows = []
    second = weights(fit(train, SHORT, checkpoint=tmp_path, log=rows.append))
    assert rows == []
    assert all(torch.equal(first[name], second[name]) for name in first)


def test_a_checkpoint_of_another_training_is_refused(tmp_path: Path):
    train = sample_train_set(4)
    fit(train, SHORT, checkpoint=tmp_path)
    message = "a checkpoint of other code, data, settings or seed. Delete it"
    with pytest.raises(InvalidFileError, match=message):
        fit(train, SHORT, seed=1, checkpoint=tmp_path)
    with pytest.raises(InvalidFileError, match=message):
        fit(train, replace(SHORT, temperature=0.5), checkpoint=tmp_path)
    with pytest.raises(InvalidFileError, match=message):
        fit(sample_train_set(5), SHORT, checkpoint=tmp_path)


def test_a_damaged_checkpoint_is_refused(tmp_path: Path):
    train = sample_train_set(4)
    fit(train, SHORT, checkpoint=tmp_path)
    path = tmp_path / "state.safetensors"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InvalidFileError, match="not a usable checkpoint"):
        fit(train, SHORT, checkpoint=tmp_path)


def test_damaged_weights_are_refused(tmp_path: Path):
    fit(sample_train_set(4, houses=1), LcRlConfig(least_steps=0, passes=1)).save(tmp_path)
    path = tmp_path / "reward.safetensors"
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(InvalidFileError, match="can't be read as the weights"):
        LcRl.learns.load(tmp_path)
    with pytest.raises(InvalidFileError, match="no such file"):
        LcRl.learns.load(tmp_path / "nowhere")


def test_where_houses_are_few_passes_are_added():
    train = sample_train_set(0, houses=2)
    rows = []
    LcRl(LcRlConfig(passes=2, least_steps=7)).fit(
        train, generator=torch.Generator().manual_seed(0), device=CPU, log=rows.append
    )
    assert [row["step"] for row in rows] == list(range(1, 9)), "four whole passes of two houses"


@pytest.mark.parametrize("bad", [{"passes": 0}, {"temperature": 0.0}, {"learning_rate": -1.0}])
def test_settings_that_can_not_be_trained_with_are_refused(bad):
    with pytest.raises(UsageError, match=r"start at 1|must be positive"):
        LcRlConfig(**bad)


def test_scores_follow_the_weights_and_the_views_not_an_old_cache():
    train = sample_train_set(6)
    reward = fit(train, LcRlConfig(least_steps=0, passes=1))
    (first, *_), (second, *_) = train.houses
    before = reward.score(first.views, first.commands)
    renamed = replace(second.views, house=first.views.house)
    changed = reward.score(renamed, first.commands)
    assert not torch.equal(before, changed)
    assert torch.equal(before, reward.score(first.views, first.commands))
    with torch.no_grad():
        reward.network.image.second_bias.add_(1.0)
    assert not torch.equal(before, reward.score(first.views, first.commands))
