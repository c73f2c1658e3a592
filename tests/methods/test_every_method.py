"""The contract, over every registered method."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import torch
from task_samples import sample_train_set

from lcrl_bench.evaluation.independence import dependence_of
from lcrl_bench.methods.contract import Method, Panoramas, Policy, Reward, TrainSet
from lcrl_bench.methods.registry import method_registry, resolve_method
from lcrl_bench.panoramas import ObservedHouse

CPU = torch.device("cpu")
METHODS = [entry.name for entry in method_registry()]
Row = dict[str, Any]


def train_set(name: str) -> TrainSet:
    return sample_train_set(0, houses=2, oracle=resolve_method(name).oracle)


def make(name: str) -> Method:
    """The method, told to do little where it has a setting for that."""
    method_class: Any = resolve_method(name)
    config_class = method_class.Config
    fields = getattr(config_class, "__dataclass_fields__", {})
    little = {"passes": 2, "least_steps": 0}
    chosen = {name: value for name, value in little.items() if name in fields}
    return method_class(config_class(**chosen)) if chosen else method_class()


def fit(name: str, seed: int = 0) -> tuple[Method, Reward | Policy, list[Row]]:
    method, rows = make(name), []
    generator = torch.Generator().manual_seed(seed)
    learned = method.fit(train_set(name), generator=generator, device=CPU, log=rows.append)
    return method, learned, rows


def outputs(learned: Reward | Policy, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
    if isinstance(learned, Reward):
        return learned.score(views, commands)
    return learned.logits(views, commands)


def all_outputs(name: str, learned: Reward | Policy) -> list[torch.Tensor]:
    return [outputs(learned, tasks.views, tasks.commands) for tasks in train_set(name).tasks]


@pytest.mark.parametrize("name", METHODS)
def test_fitting_reports_finite_progress_to_the_last_step(name):
    _, _, rows = fit(name)
    assert rows
    assert all(math.isfinite(row["loss"]) for row in rows)
    assert [row["step"] for row in rows] == sorted(row["step"] for row in rows)
    assert rows[-1]["step"] == rows[-1]["steps"]


@pytest.mark.parametrize("name", METHODS)
def test_scores_are_finite_and_shaped_as_the_contract_says(name):
    _, learned, _ = fit(name)
    for tasks in train_set(name).tasks:
        values = outputs(learned, tasks.views, tasks.commands)
        shape = (len(tasks.commands), len(tasks.views))
        answer = shape if isinstance(learned, Reward) else (*shape, 2, 4, 4)
        assert tuple(values.shape) == answer
        assert bool(torch.isfinite(values).all())
        assert not values.requires_grad


@pytest.mark.parametrize("name", METHODS)
def test_equal_seeds_give_equal_bits_and_others_do_not(name):
    first, again, other = (all_outputs(name, fit(name, seed)[1]) for seed in (3, 3, 4))
    assert all(torch.equal(a, b) for a, b in zip(first, again, strict=True))
    assert not all(torch.equal(a, b) for a, b in zip(first, other, strict=True))


@pytest.mark.parametrize("name", METHODS)
def test_what_is_saved_scores_as_what_was_learned(name, tmp_path: Path):
    method, learned, _ = fit(name)
    learned.save(tmp_path)
    assert (tmp_path / "config.json").exists()
    assert {path.suffix for path in tmp_path.iterdir()} <= {".json", ".safetensors"}
    loaded = method.learns.load(tmp_path)
    pairs = zip(all_outputs(name, learned), all_outputs(name, loaded), strict=True)
    assert all(torch.equal(a, b) for a, b in pairs)


@pytest.mark.parametrize("name", METHODS)
def test_fitting_changes_neither_its_inputs_nor_the_global_generator(name):
    train = train_set(name)
    before, state = copy.deepcopy(train), torch.get_rng_state()
    make(name).fit(train, generator=torch.Generator(), device=CPU, log=lambda _row: None)
    assert torch.equal(torch.get_rng_state(), state)
    for tasks, kept in zip(train.tasks, before.tasks, strict=True):
        assert torch.equal(tasks.views.views, kept.views.views)
        assert torch.equal(tasks.views.panorama_views, kept.views.panorama_views)
        assert torch.equal(tasks.panoramas, kept.panoramas)
        assert torch.equal(tasks.demonstrations, kept.demonstrations)
        assert torch.equal(tasks.next_state, kept.next_state)


@pytest.mark.parametrize("name", METHODS)
def test_a_command_with_words_it_never_saw_is_scored(name):
    _, learned, _ = fit(name)
    views = train_set(name).tasks[0].views
    said = ("fetch xylophone", "")
    assert bool(torch.isfinite(outputs(learned, views, said)).all())


@pytest.mark.parametrize("name", METHODS)
def test_answers_depend_on_what_is_seen_and_said_alone(name):
    _, learned, _ = fit(name)
    for house in train_set(name).houses:
        said = [command for tasks in house for command in tasks.commands]
        observed = ObservedHouse.of(house[0].views)
        generator = torch.Generator().manual_seed(1)
        assert dependence_of(learned, observed, said, generator=generator) == ""
