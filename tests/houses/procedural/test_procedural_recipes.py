"""Laws of the recipe files: every name they use exists, every range is one."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.houses.classes import class_names, task_objects
from lcrl_bench.houses.house import RoomType
from lcrl_bench.houses.procedural.recipes import (
    Furniture,
    draw_size,
    kinds,
    room_recipes,
    surfaces,
)
from lcrl_bench.houses.receptacles import receptacle_labels


def every(items: tuple[Furniture, ...]) -> list[Furniture]:
    return [found for item in items for found in (item, *every(item.companions))]


def test_kinds_are_of_known_classes_with_rising_ranges():
    for name, kind in kinds().items():
        assert kind.label in class_names(), name
        for spread in (kind.width, kind.depth, kind.height, kind.base):
            assert spread[0] <= spread[1] <= spread[2], name
        assert min(kind.width[0], kind.depth[0], kind.height[0]) > 0


def test_rooms_are_furnished_with_known_kinds():
    for room_type, recipe in room_recipes().items():
        for item in every(recipe.furniture):
            assert item.kind in kinds(), (room_type, item.kind)
            assert not item.instead or item.instead in kinds()
        for item in recipe.hanging:
            assert item.kind in kinds(), (room_type, item.kind)
            assert max(kinds()[item.kind].base) > 0
        assert abs(sum(recipe.windows) - 1) < 1e-9


def test_companions_need_a_parent_and_others_none():
    alone = {"wall", "corner", "middle"}
    for recipe in room_recipes().values():
        for item in recipe.furniture:
            assert item.place in alone
            assert all(companion.place not in alone for companion in every(item.companions))


def test_things_are_put_on_what_things_can_stand_on():
    recipe = surfaces()
    for entry in (*recipe.dressing, *recipe.clutter):
        assert entry.kind in kinds()
        assert set(entry.on) <= set(receptacle_labels()), entry.kind


def test_every_task_object_has_a_recipe():
    recipe = surfaces()
    assert set(recipe.task) == set(task_objects())
    for name, entry in recipe.task.items():
        assert kinds()[name].label == name
        assert set(entry.on) <= set(receptacle_labels())
        assert RoomType.OTHER not in entry.rooms
        assert abs(sum(entry.counts) - 1) < 1e-9


@settings(derandomize=True, deadline=None, max_examples=50)
@given(name=st.sampled_from(sorted(kinds())), seed=st.integers(0, 2**32))
def test_sizes_are_drawn_from_their_ranges(name, seed):
    kind = kinds()[name]
    for value, spread in zip(
        draw_size(kind, np.random.default_rng(seed)),
        (kind.width, kind.depth, kind.height),
        strict=True,
    ):
        assert spread[0] - 1e-3 <= value <= spread[2] + 1e-3
