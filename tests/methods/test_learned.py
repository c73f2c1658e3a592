"""What a learned reward or policy is shown, and how its answers come back to the cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
import torch
from benchmark_samples import tiny_task_sets

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.errors import UsageError
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.learned import ask
from lcrl_bench.methods.tensors import TensorPolicy, TensorReward
from lcrl_bench.panoramas import ObservedHouse


class Pixels(TensorReward):
    """The mean class number of a panorama, times the length of what is said."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        seen = views.views.flatten(1).double().mean(1)[views.panorama_views].mean(1)
        return torch.tensor([float(len(c)) for c in commands])[:, None] * seen


class Answering(TensorReward):
    """Answers whatever it was made with."""

    def __init__(self, answer) -> None:
        self.answer = answer

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        return self.answer


class Held(TensorPolicy):
    """Goes forward with an empty hand and left with a full one, by how much is seen."""

    def logits(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        seen = views.views.flatten(1).double().mean(1)[views.panorama_views].mean(1)
        logits = torch.zeros(len(commands), len(seen), 2, 4, 4, dtype=torch.float64)
        logits[:, :, 0, :, 0] = seen[:, None]
        logits[:, :, 1, :, 1] = seen[:, None]
        return logits


def numbered_anew(views: Panoramas, seed: int) -> tuple[Panoramas, torch.Tensor]:
    """The same house under other numbers, and the new number of each panorama."""
    generator = torch.Generator().manual_seed(seed)
    views_order = torch.randperm(len(views.views), generator=generator)
    order = torch.randperm(len(views), generator=generator)
    sides = torch.argsort(views_order)[views.panorama_views[order]]
    renumbered = replace(
        views, house="another", views=views.views[views_order], panorama_views=sides
    )
    return renumbered, torch.argsort(order)


HOUSES = [house[0].views for house in by_house(tiny_task_sets())]


@pytest.mark.parametrize("views", HOUSES, ids=lambda each: each.house)
def test_each_distinct_panorama_is_shown_once(views):
    shown = views.observed.views
    pixels = shown.views[shown.panorama_views].flatten(1)
    assert len(torch.unique(pixels, dim=0)) == len(pixels)
    own = views.views[views.panorama_views].flatten(1)
    assert torch.equal(pixels[views.observed.place], own)


@pytest.mark.parametrize("seed", range(3))
def test_what_is_shown_does_not_depend_on_how_a_house_is_numbered(seed):
    views = tiny_task_sets()[0].views
    renumbered, number = numbered_anew(views, seed)
    one, other = ObservedHouse.of(views), ObservedHouse.of(renumbered)
    assert one.views.house == other.views.house
    assert torch.equal(one.views.views, other.views.views)
    assert torch.equal(one.views.panorama_views, other.views.panorama_views)
    assert torch.equal(one.place, other.place[number])


def test_only_what_is_chosen_is_shown_and_views_of_nothing_else():
    views = tiny_task_sets()[0].views
    chosen = torch.tensor([5, 2, 9])
    some = ObservedHouse.of(views, chosen)
    assert (some.place >= 0).nonzero().flatten().tolist() == [2, 5, 9]
    pixels = some.views.views[some.views.panorama_views[some.place[chosen]]]
    assert torch.equal(pixels, views.views[views.panorama_views[chosen]])
    assert set(some.views.panorama_views.flatten().tolist()) == set(range(len(some.views.views)))


def test_a_reward_comes_back_to_the_cells_it_is_seen_in():
    for tasks in by_house(tiny_task_sets())[0]:
        commands = [task.command for task in tasks.tasks]
        answers = ask(Pixels(), tasks.views.observed, commands)
        found = answers.reward(tasks.panoramas, commands)
        assert torch.equal(answers.reward_of(tasks), found)
        views = tasks.views.views[tasks.views.panorama_views[tasks.panoramas]]
        seen = views.flatten(2).double().mean(-1)
        lengths = torch.tensor([float(len(command)) for command in commands])
        torch.testing.assert_close(found, lengths[:, None].double() * seen)


def test_cells_in_another_order_are_paid_the_same_bits_in_that_order():
    tasks = by_house(tiny_task_sets())[0][-1]
    commands = [task.command for task in tasks.tasks]
    renumbered, number = numbered_anew(tasks.views, 7)
    order = torch.randperm(tasks.cells, generator=torch.Generator().manual_seed(0))
    usual = ask(Pixels(), tasks.views.observed, commands).reward(tasks.panoramas, commands)
    again = ask(Pixels(), ObservedHouse.of(renumbered), commands).reward(
        number[tasks.panoramas[:, order]], commands
    )
    assert torch.equal(again, usual[:, order])


def test_a_policy_is_told_whether_the_object_is_held_and_nothing_else_of_the_state():
    tasks = by_house(tiny_task_sets())[0][-1]
    commands = [task.command for task in tasks.tasks]
    answers = ask(Held(), tasks.views.observed, commands)
    policy = answers.policy(tasks.panoramas, tasks.held, commands)
    assert policy.shape == (len(commands), tasks.states, 4)
    torch.testing.assert_close(policy.sum(-1), torch.ones(policy.shape[:2], dtype=torch.float64))
    held = tasks.held.repeat_interleave(4, 1)
    assert torch.equal(policy[..., 0] > policy[..., 1], ~held)


def test_each_sentence_is_asked_once_in_an_order_of_its_own():
    views, said = HOUSES[0], []

    class Listening(Pixels):
        def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
            said.extend(commands)
            return super().score(views, commands)

    ask(Listening(), views.observed, ["b", "", "a", "b"])
    assert said == ["", "a", "b"]


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (torch.zeros(2, 5), r"answered \[2, 5\]; wanted is \[command, panorama\] = \[2, \d+\]"),
        (None, "answered NoneType; wanted is"),
        ("nan", "answered 'b' with a number that is not finite"),
        ("inf", "answered 'b' with a number that is not finite"),
    ],
)
def test_an_answer_of_another_shape_or_no_number_is_refused(answer, words):
    house = HOUSES[0].observed
    if isinstance(answer, str):
        value = float(answer)
        answer = torch.zeros(2, len(house.views))
        answer[1, 3] = value
    with pytest.raises(UsageError, match=words):
        ask(Answering(answer), house, ["a", "b"])
