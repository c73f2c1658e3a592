"""What an agent is told is what there is to see, and says where it is."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from environment_samples import sample_benchmark

from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.envs.environment import HouseEnvironment
from lcrl_bench.envs.observation import most_tiles
from lcrl_bench.mdp.task_batch import Action, ObjectState
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement

CUP = "rooms-a.move-the-cup-to-the-bed"


def make(**settings) -> HouseEnvironment:
    return HouseEnvironment(
        **{"benchmark": sample_benchmark(), "renderer": "rays", "split": None} | settings
    )


def observed(environment: HouseEnvironment, state: int):
    """The observation of any state of the current task."""
    assert environment._current is not None
    return environment._current.observe(state)


def states_of(environment: HouseEnvironment, count: int = 300) -> list[int]:
    """States all over a task."""
    environment.reset(options={"task": CUP})
    rng = np.random.default_rng(1)
    return rng.integers(environment.played.states, size=count).tolist()


def test_the_panorama_is_what_the_store_shows_in_the_cell():
    environment = make()
    for state in states_of(environment):
        one = environment.played
        seen = observed(environment, state)
        tile, heading, held = one.place(state)
        number = int(one.panoramas[0, state // 4])
        assert (seen["panorama"] == one.views.pixels(number)).all()
        arrangement, seen_from = divmod(number, one.tiles)
        assert seen_from == tile
        every = arrangements_of(sample_benchmark().select(house=one.task.house))
        moved = one.task.moved
        places = (AS_FOUND, Arrangement(moved), Arrangement(moved, one.task.placement))
        assert every[arrangement] == places[held]
        assert seen["heading"] == heading == state % 4
        assert seen["held"] == (held == ObjectState.HELD)


def test_a_one_hot_panorama_is_the_panorama():
    plain, one_hot = make(), make(one_hot=True)
    for state in states_of(plain, 20):
        one_hot.reset(options={"task": CUP})
        ids = observed(plain, state)["panorama"]
        hot = observed(one_hot, state)["panorama"]
        assert (hot.shape, hot.dtype) == ((4, 61, 24, 32), np.uint8)
        assert (hot.sum(axis=1) == 1).all()
        assert (hot.argmax(axis=1) == ids).all()


def test_the_words_of_a_command_are_numbers_of_the_vocabulary():
    words = ("", *sample_benchmark().vocabulary)
    environment = make()
    for task in sample_benchmark().tasks:
        seen, _ = environment.reset(options={"task": task.id})
        read = " ".join(words[number] for number in seen["command"]).strip()
        known = " ".join(word if word in words else "" for word in task.command.split())
        assert read == known.strip()
        assert seen["text"] == task.command


def test_text_is_left_out_and_the_tile_put_in_on_demand():
    environment = make(text=False, position=True)
    space = environment.observation_space
    assert isinstance(space, gymnasium.spaces.Dict)
    assert set(space) == {"panorama", "heading", "held", "command", "tile"}
    for state in states_of(environment, 20):
        seen = observed(environment, state)
        assert seen in space
        assert seen["tile"] == state // 4 % environment.played.tiles


def test_a_vector_tells_states_apart_and_nothing_else():
    environment = make(observation="tabular")
    states = states_of(environment)
    vectors = [observed(environment, state) for state in states]
    assert all((vector.sum(), len(vector)) == (3, 28 + 4 + 3) for vector in vectors)
    assert len({vector.tobytes() for vector in vectors}) == len(set(states))
    tile, heading, held = environment.played.place(states[0])
    assert np.flatnonzero(vectors[0]).tolist() == [tile, 28 + heading, 32 + held]


def test_spaces_are_those_of_the_benchmark_whatever_is_played():
    splits = ("train", "test-task", "test-house")
    for observation in ("panorama", "tabular", "state"):
        spaces = [make(split=split, observation=observation).observation_space for split in splits]
        assert spaces[0] == spaces[1] == spaces[2]
    assert most_tiles(sample_benchmark()) == 28


def test_what_is_held_is_told_while_it_is_held():
    environment = make(tasks=["rooms-a.move-the-cup-to-the-dining-table"])
    environment.reset()
    one = environment.played
    place = int(np.flatnonzero(one.object_tiles[0].numpy())[0])
    environment._states = [place * 4]
    seen, *_ = environment.step(Action.INTERACT)
    assert seen["held"] == 1
    (away,) = np.flatnonzero(~one.object_tiles[0].numpy() & ~one.target_tiles[0].numpy())[:1]
    environment._states = [(ObjectState.HELD * one.tiles + int(away)) * 4]
    assert environment.step(Action.INTERACT)[0]["held"] == 1


@pytest.mark.parametrize("observation", ["panorama", "tabular"])
def test_an_observation_is_the_agents_own_to_write_in(observation):
    environment = make(observation=observation)
    seen, _ = environment.reset(options={"task": CUP})
    again, _ = environment.reset(options={"task": CUP})
    array = seen["panorama"] if isinstance(seen, dict) else seen
    array += 1
    fresh, _ = environment.reset(options={"task": CUP})
    assert gymnasium.utils.env_checker.data_equivalence(again, fresh)
