"""The lexical floor: which classes a command names, and how much of them is seen."""

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets

from lcrl_bench.evaluation.harness import evaluate, evaluate_random
from lcrl_bench.evaluation.lexical import LexicalReward, named_in
from lcrl_bench.houses.classes import class_id
from lcrl_bench.methods.contract import Panoramas


@pytest.mark.parametrize(
    ("command", "names"),
    [
        ("go to the bed", ("bed",)),
        ("go to the coffee table", ("coffee_table",)),
        ("Move the fruit bowl to the TV stand!", ("tv_stand", "fruit_bowl")),
        ("go to the bedroom", ()),
        ("move the cup to the kitchen", ("cup",)),
        ("", ()),
    ],
)
def test_the_names_in_a_command_are_found(command, names):
    assert set(named_in(command)) == set(names)


def test_a_panorama_is_worth_the_share_of_what_is_named():
    views = torch.zeros(3, 2, 4, dtype=torch.uint8)
    views[1, 0] = class_id("bed")
    views[2] = class_id("cup")
    house = Panoramas(views, torch.tensor([[0, 0, 0, 0], [1, 1, 0, 0], [1, 2, 0, 0]]))
    commands = ["go to the bed", "move the cup to the bed", "go to the bedroom", ""]
    scores = LexicalReward().score(house, commands)
    expected = [[0, 0.25, 0.125], [0, 0, 0.25 * 0.125], [0, 0, 0], [0, 0, 0]]
    torch.testing.assert_close(scores, torch.tensor(expected))


def test_a_command_that_names_no_class_is_done_at_random():
    sets = tiny_task_sets()
    lexical, random = evaluate(LexicalReward(), sets), evaluate_random(sets)
    nameless = [
        (one, other)
        for one, other in zip(lexical, random, strict=True)
        if not named_in(one.task.command)
    ]
    for one, other in nameless:
        assert one.success == pytest.approx(other.success)


def test_looking_words_up_beats_chance_where_they_name_a_class():
    rows = [o for o in evaluate(LexicalReward(), tiny_task_sets()) if named_in(o.task.command)]
    assert len(rows) > len(tiny_benchmark().tasks) / 2
    assert sum(row.success for row in rows) / len(rows) > 0.1
