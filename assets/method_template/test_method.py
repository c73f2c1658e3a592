"""MyMethod fulfils the contract of a method, and learns, on a tiny training set."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch

from lcrl_bench.methods.contract import Reward, TrainSet
from lcrl_bench.methods.practice import practice_train_set
from lcrl_bench.methods.registry import resolve_method

METHOD: Any = resolve_method(f"{Path(__file__).with_name('method.py')}:MyMethod")


def fitted(
    train: TrainSet, *, seed: int = 0, passes: int = 2
) -> tuple[Reward, list[dict[str, Any]]]:
    """The reward of a short training, and the rows it logged."""
    method, rows = METHOD(METHOD.Config(passes=passes, least_steps=0)), []
    generator = torch.Generator().manual_seed(seed)
    reward = method.fit(train, generator=generator, device=torch.device("cpu"), log=rows.append)
    return reward, rows


def scores(reward: Reward, train: TrainSet) -> torch.Tensor:
    """The reward of every panorama, for every command."""
    return torch.cat([reward.score(tasks.views, tasks.commands).flatten() for tasks in train.tasks])


def test_training_makes_the_loss_smaller() -> None:
    """It learns, and logs its progress to the last step."""
    _, rows = fitted(practice_train_set(0), passes=40)
    assert rows[-1]["step"] == rows[-1]["steps"]
    assert rows[-1]["loss"] < 0.8 * rows[0]["loss"]


def test_equal_seeds_give_equal_bits() -> None:
    """All randomness comes from the generator."""
    train = practice_train_set(0)
    first, again, other = (scores(fitted(train, seed=seed)[0], train) for seed in (1, 1, 2))
    assert torch.equal(first, again)
    assert not torch.equal(first, other)


def test_what_is_saved_scores_as_what_was_learned(tmp_path: Path) -> None:
    """A finished run can be read back."""
    train = practice_train_set(0)
    reward, _ = fitted(train)
    reward.save(tmp_path)
    assert torch.equal(scores(METHOD.learns.load(tmp_path), train), scores(reward, train))


def test_words_it_never_saw_are_scored() -> None:
    """The harness uses the empty command, and words that don't occur in training."""
    train = practice_train_set(0)
    reward, _ = fitted(train)
    views = train.tasks[0].views
    asked = reward.score(views, ("fetch xylophone", ""))
    assert asked.shape == (2, len(views))
    assert bool(torch.isfinite(asked).all())
