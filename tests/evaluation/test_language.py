"""Language controls: what is said in place of a command, and what that can do to a method."""

import itertools
from collections import Counter

import pytest
import torch
from benchmark_samples import TrueRewardBySight, tiny_benchmark, tiny_task_sets

from lcrl_bench.benchmarks.grammar import tokens
from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.targets import find_targets
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.evaluation.harness import (
    ConstantReward,
    evaluate,
    evaluate_each,
    own_command,
)
from lcrl_bench.evaluation.language import (
    Control,
    language_controls,
    names_of,
    shuffled_commands,
    wrong_target_commands,
)
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.networks.reward_network import RewardNetwork, RewardNetworkConfig
from lcrl_bench.networks.vocabulary import Vocabulary


@pytest.fixture(scope="module")
def controls():
    return language_controls(tiny_task_sets())


@pytest.fixture(scope="module")
def by_command():
    return {(task.house, task.command): task for task in tiny_benchmark().tasks}


def test_there_is_a_control_of_each_name_in_a_fixed_order(controls):
    assert list(controls) == ["blank", "shuffled", "wrong-target", "paraphrase"]


def test_the_blank_command_has_no_word(controls):
    assert {controls[Control.BLANK](task) for task in tiny_benchmark().tasks} == {""}


def test_a_shuffled_command_is_another_task_s_of_the_same_kind_with_other_names(controls):
    tasks = tiny_benchmark().tasks
    for task in tasks:
        command = controls[Control.SHUFFLED](task)
        if command is None:
            continue
        owners = [
            other
            for other in tasks
            if other.command == command and (other.kind, other.split) == (task.kind, task.split)
        ]
        assert owners
        assert all(names_of(task).isdisjoint(names_of(owner)) for owner in owners)


def test_nearly_every_task_has_a_shuffled_command_and_a_wrong_target(controls):
    tasks = tiny_benchmark().tasks
    for control in (Control.SHUFFLED, Control.WRONG_TARGET):
        assert sum(controls[control](task) is not None for task in tasks) >= 0.9 * len(tasks)


def test_shuffling_does_not_depend_on_the_order_of_the_tasks():
    tasks = tiny_benchmark().tasks
    assert shuffled_commands(tasks) == shuffled_commands(tasks[::-1])


def test_a_task_alone_has_no_other_command():
    assert shuffled_commands(tiny_benchmark().tasks[:1]) == {}


def test_a_wrong_target_is_in_the_house_and_is_nowhere_where_the_right_one_is():
    benchmark = tiny_benchmark()
    for sets in by_house(tiny_task_sets()):
        house = sets[0].scene.house
        targets = find_targets(sets[0].scene)
        said = wrong_target_commands(sets)
        for task in benchmark.select(house=house.id, kind=Kind.NAV):
            wrong = said[task.id].removeprefix("go to the ").replace(" ", "_")
            wrong = wrong if wrong in targets else wrong.replace("_", " ")
            assert not (targets[wrong].tiles & targets[task.target].tiles).any()


def test_an_object_at_its_destination_is_not_at_the_wrong_target():
    benchmark = tiny_benchmark()
    for sets in by_house(tiny_task_sets()):
        house = sets[0].scene.house
        said = wrong_target_commands(sets)
        for task in benchmark.select(house=house.id, kind=Kind.PICK):
            start, _, wrong = said[task.id].partition(" to the ")
            moved, placed = task.carried()
            assert start == task.command.partition(" to the ")[0]
            for thing in (house.object(moved), placed):
                assert wrong != house.room(thing.room).type.value
                if thing.support is not None:
                    assert wrong != house.object(thing.support).label.replace("_", " ")


def test_who_follows_commands_fails_where_they_are_blank_or_wrong(controls):
    learned = TrueRewardBySight(tiny_task_sets())
    found = evaluate_each(learned, tiny_task_sets(), {"command": own_command, **controls})
    means = {name: sum(o.success for o in rows) / len(rows) for name, rows in found.items()}
    assert means["command"] > 0.99
    assert max(means[name] for name in ("blank", "paraphrase")) < 0.05, "no better than chance"
    assert max(means[name] for name in ("shuffled", "wrong-target")) < 0.6, "met on the way only"


def test_a_wrong_nav_target_is_told_in_a_sentence_the_house_knows(controls, by_command):
    for task in tiny_benchmark().tasks:
        if task.kind == Kind.NAV:
            assert (task.house, controls[Control.WRONG_TARGET](task)) in by_command


def test_no_words_change_nothing_for_a_constant_reward(controls):
    constant = evaluate(ConstantReward(), tiny_task_sets())
    for sentences in (controls["blank"], controls["paraphrase"]):
        assert evaluate(ConstantReward(), tiny_task_sets(), commands=sentences) == constant


def test_each_house_is_visited_once_for_all_sentences(controls):
    learned = TrueRewardBySight(tiny_task_sets())
    evaluate_each(learned, tiny_task_sets(), {"command": own_command, **controls})
    visits = [house for house, _ in learned.asked]
    changes = sum(one != other for one, other in itertools.pairwise(visits))
    assert changes == len(tiny_benchmark().houses) - 1
    assert set(Counter(learned.asked).values()) == {1}, "each sentence is asked once per house"
    name = {tasks.scene.house.id: tasks.views.observed.views.house for tasks in tiny_task_sets()}
    asked = set(learned.asked)
    assert all((name[task.house], task.command) in asked for task in tiny_benchmark().tasks)


def test_a_task_without_a_sentence_is_left_out():
    (first, *_) = tiny_benchmark().tasks
    only = evaluate(
        ConstantReward(), tiny_task_sets(), commands=lambda t: "go" if t == first else None
    )
    assert [outcome.task for outcome in only] == [first]
    (same,) = [o for o in evaluate(ConstantReward(), tiny_task_sets()) if o.task == first]
    assert only[0] == same


def test_the_paper_s_network_takes_a_command_without_words():
    vocabulary = Vocabulary.of(tokens("go to the bed"))
    generator = torch.Generator().manual_seed(0)
    network = RewardNetwork(RewardNetworkConfig(), words=len(vocabulary), generator=generator)
    learned = NetworkReward(network, vocabulary)
    views = tiny_task_sets()[0].views
    alone = learned.score(views, ["", ""])
    assert alone.shape == (2, len(views))
    assert torch.equal(alone[0], alone[1])
    beside = learned.score(views, ["", "go to the bed"])
    torch.testing.assert_close(beside[0], alone[0])
    assert not torch.allclose(beside[1], alone[1])
