"""Maps over tiles: their numbers, colours and signs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from sight import DEUTERANOPIA, PROTANOPIA, linear

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import TileMap, diverging, layer_titles, tile_maps, unit_interval


def test_low_is_red_middle_is_pale_and_high_is_blue():
    low, middle, high = diverging(np.array([0.0, 0.5, 1.0])).astype(int)
    assert low[0] > low[2] + 80
    assert high[2] > high[0] + 80
    assert middle.min() > 220


@pytest.mark.parametrize("sight", [DEUTERANOPIA, PROTANOPIA], ids=["no green", "no red"])
def test_low_and_high_differ_to_the_colour_blind(sight: NDArray):
    shares = np.linspace(0, 1, 21)
    seen = linear(diverging(shares)) @ sight.T
    warmth = (seen[:, 0] - seen[:, 2]) / seen.sum(axis=1)
    assert (warmth[shares < 0.4] > 0.1).all()
    assert (warmth[shares > 0.6] < -0.08).all()
    light = seen @ (0.213, 0.715, 0.072)
    assert (np.diff(light[shares <= 0.5]) > 0).all()
    assert (np.diff(light[shares >= 0.5]) < 0).all()


@given(st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=20))
def test_higher_numbers_are_never_redder(numbers: list[float]):
    values = np.sort(np.array(numbers))
    shares = unit_interval(values, (values[0], values[-1]))
    assert (np.diff(shares) >= 0).all()
    assert shares.min() >= 0
    assert shares.max() <= 1


@given(st.lists(st.floats(-10, 10), min_size=2, max_size=20))
def test_a_sign_tells_the_two_dark_ends_apart(numbers: list[float]):
    layers = np.array([numbers, numbers[::-1]])
    tile_map = TileMap.of("reward", "learned reward", layers)
    for layer in (0, 1):
        light = linear(tile_map.colors[layer]) @ (0.213, 0.715, 0.072)
        signs = {sign: tiles[layer] for sign, tiles in tile_map.signs.items()}
        assert not (signs["+"] & signs["-"]).any()
        # Printed in grey, what is darkest has one.
        assert (signs["+"] | signs["-"])[light < 0.26].all()
        low, high = tile_map.limits
        if high > low:
            assert signs["+"][layers[layer] == high].all()
            assert signs["-"][layers[layer] == low].all()


def test_counts_of_visits_need_no_sign(policy_episode: Episode):
    assert [tile_map.signs for tile_map in tile_maps(policy_episode)] == [{}, {}]


def test_a_constant_map_is_pale_everywhere():
    np.testing.assert_array_equal(unit_interval(np.full(4, 7.0), (7.0, 7.0)), 0.5)


def test_a_reward_has_maps_of_reward_and_best_value(pick_episode: Episode):
    reward, value = tile_maps(pick_episode)
    assert pick_episode.reward is not None
    assert pick_episode.value is not None
    assert (reward.key, value.key) == ("reward", "value")
    np.testing.assert_array_equal(reward.layers.reshape(-1), pick_episode.reward)
    by_heading = pick_episode.value.reshape(3, -1, 4)
    np.testing.assert_array_equal(value.layers, by_heading.max(axis=2))
    assert reward.limits == (pick_episode.reward.min(), pick_episode.reward.max())


def test_a_policy_has_maps_of_its_visits_and_the_experts(policy_episode: Episode):
    visits, expert = tile_maps(policy_episode)
    assert (visits.key, expert.key) == ("visits", "expert_visits")
    np.testing.assert_array_equal(visits.layers.reshape(-1), policy_episode.occupancy)
    np.testing.assert_array_equal(expert.layers.reshape(-1), policy_episode.expert_occupancy)


def test_a_map_has_a_layer_for_each_place_of_the_object(
    nav_episode: Episode, pick_episode: Episode
):
    assert layer_titles(nav_episode) == ("",)
    assert layer_titles(pick_episode) == (
        "before the cup is taken",
        "with the cup in hand",
        "after the cup is put",
    )
