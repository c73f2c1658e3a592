"""What keys do to a game."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from environment_samples import sample_benchmark
from game_samples import COUNTING, NAV, PICK, make_game, press

from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.evaluation.question import Model
from lcrl_bench.mdp.task_batch import ACTIONS, Action
from lcrl_bench.methods.tensors import TensorPolicy
from lcrl_bench.play.playlist import choose_tasks

TASKS = {task.id: task for task in sample_benchmark().tasks}
LETTERS = dict(zip("wad ", Action, strict=True))


@pytest.mark.parametrize("key", LETTERS)
def test_a_key_leads_where_the_action_of_the_environment_leads(key):
    game = make_game(PICK)
    one = game.walk.played
    press(game, key)
    start = int(one.start[0])
    assert game.walk.states == [start, int(one.next_state[0, start, LETTERS[key]])]


@pytest.mark.parametrize("task", [NAV, PICK, "rooms-a.move-the-cup-to-the-dining-table"])
def test_the_optimum_reaches_the_goal_in_as_many_steps_as_are_proved(task):
    game = press(make_game(task), "p")
    assert game.walk.reached
    assert game.walk.steps == TASKS[task].proof.optimal_length == game.shortest
    (row,) = game.played
    assert (row.command, row.reached, row.steps) == (TASKS[task].command, True, game.shortest)


def test_a_walk_ends_at_the_goal_and_no_key_goes_on_from_there():
    game = press(make_game(NAV), "p")
    states = list(game.walk.states)
    press(game, "wad ")
    assert game.walk.states == states
    assert "n next task" in game.message
    assert len(game.played) == 1


def test_a_walk_ends_after_thirty_steps():
    game = press(make_game(PICK), "d" * 40)
    assert game.walk.steps == 30
    assert game.walk.over
    assert not game.walk.reached
    assert [row.reached for row in game.played] == [False]


def test_again_is_the_same_task_and_next_is_another_until_it_comes_round():
    game = press(make_game(NAV), "ww")
    assert game.walk.steps == 2
    first = game.walk.played.task
    press(game, "r")
    assert (game.walk.played.task, game.walk.steps) == (first, 0)
    seen = [first.id]
    for _ in range(len(game.playlist) - 1):
        seen.append(press(game, "n").walk.played.task.id)
    assert sorted(seen) == sorted(each for each in TASKS if each.startswith("rooms-a"))
    assert press(game, "n").walk.played.task == first


def test_taking_and_putting_are_said_and_so_is_what_is_in_the_way():
    game = make_game(PICK)
    press(game, "v")
    said = []
    while not game.walk.over:
        game.step()
        said.append(game.walk.object_state)
    assert ObjectState.HELD in said
    game = make_game(PICK)
    while not game.walk.in_reach:
        press(game, "p") if game.autoplay else game.step()
    assert game.walk.in_reach == "take the cup"
    press(game, " ")
    assert game.message == "you take the cup"
    assert game.walk.object_state == ObjectState.HELD
    press(game, "w" * 8)
    assert game.message == "something is in the way"


def test_the_way_is_shown_by_the_optimum_then_by_the_run_then_by_nobody():
    game = make_game(PICK, model=COUNTING)
    names = []
    for _ in range(3):
        press(game, "v")
        names.append(game.guide.name if game.guide else None)
    assert names == ["optimum", "counting", None]


def test_a_runs_maps_are_its_reward_and_its_value_and_without_a_run_there_are_none():
    game = make_game(PICK, model=COUNTING)
    one = game.walk.played
    press(game, "m")
    assert game.layer is not None
    assert game.layer.name == "reward of counting"
    assert game.layer.layers.shape == (3, one.tiles)
    press(game, "m")
    assert game.layer.name == "value by counting"
    assert press(game, "m").layer is None
    bare = press(make_game(PICK), "m")
    assert bare.layer is None
    assert "--run" in bare.message


def test_a_policy_shows_its_likeliest_action_and_has_no_maps():
    class Left(TensorPolicy):
        def logits(self, views, commands):
            logits = torch.zeros(len(commands), len(views), 2, 4, ACTIONS)
            logits[..., Action.LEFT] = 3.0
            return logits

    game = make_game(PICK, model=Model(Left(), "left", 0, sample_benchmark(), ()))
    press(game, "vv")
    assert game.guide is not None
    assert game.guide.advice(game.walk) == Action.LEFT
    assert press(game, "m").layer is None


def test_a_sentence_comes_first_and_the_houses_tasks_after_it():
    game = make_game(sentence="go to the bed")
    assert game.walk.played.task.command == "go to the bed"
    assert game.walk.played.task.id not in TASKS
    assert len(game.playlist) == 5
    assert press(game, "n").walk.played.task.id in TASKS


def test_what_fulfils_a_sentence_may_not_be_known():
    game = make_game(sentence="fetch my slippers")
    assert not game.walk.goal_known
    assert game.shortest == -1
    assert 'neither "go to X" nor "move X to Y"' in game.message
    assert press(game, "p").message == "nobody knows the way: the goal is unknown"
    assert press(game, "w").walk.steps == 1


@pytest.mark.parametrize(
    ("wanted", "error", "message"),
    [
        ({"task": "rooms-a.go-to-the-bet"}, UsageError, "Did you mean 'rooms-a.go-to-the-bed'"),
        ({"house": "rooms-c"}, UsageError, "is no house of rooms. Did you mean"),
        ({"task": NAV, "sentence": "go"}, UsageError, "not both"),
        ({"sentence": ""}, UsageError, "1 to 200 characters"),
    ],
)
def test_mistakes_are_named(wanted, error, message):
    with pytest.raises(error, match=message):
        choose_tasks(sample_benchmark(), generator=np.random.default_rng(0), **wanted)


def test_a_house_without_a_task_is_played_by_a_sentence_only():
    bare = replace(sample_benchmark(), tasks=())
    with pytest.raises(NothingSelectedError, match="Give a --sentence"):
        choose_tasks(bare, generator=np.random.default_rng(0), house="rooms-a")
