"""The words of a source, and the 61 classes."""

from __future__ import annotations

import csv
from importlib import resources

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.houses.classes import class_id, class_names, semantic_classes, task_objects
from lcrl_bench.houses.house import RoomType
from lcrl_bench.houses.procthor.models import models, typical_size
from lcrl_bench.houses.taxonomy import load_taxonomy
from lcrl_bench.names import Identifiers, check_name

PROCTHOR = load_taxonomy("procthor")


def test_there_are_61_classes_numbered_in_order_and_14_task_objects():
    assert [entry.id for entry in semantic_classes()] == list(range(61))
    assert len(class_names()) == len({entry.color for entry in semantic_classes()}) == 61
    assert len(task_objects()) == 14


def test_an_unknown_class_is_named_with_the_nearest():
    assert class_id("dining_table") == 18
    with pytest.raises(UnknownNameError, match=r"class 'fruitbowl'\. Did you mean 'fruit_bowl'"):
        class_id("fruitbowl")


def test_every_type_of_the_asset_index_has_a_class_and_every_label_a_type():
    assert {model.type for model in models().values()} == set(PROCTHOR.labels)
    assert set(PROCTHOR.labels.values()) <= set(class_names())


def test_every_task_object_can_come_from_procthor():
    assert set(task_objects()) <= set(PROCTHOR.labels.values())


def test_the_asset_index_is_sorted_and_complete():
    file = resources.files("lcrl_bench.assets").joinpath("taxonomies", "procthor_assets.csv")
    rows = list(csv.DictReader(file.read_text("utf-8").splitlines()))
    keys = [(row["objectType"], row["assetId"]) for row in rows]
    assert keys == sorted(keys)
    assert len({row["assetId"] for row in rows}) == len(rows) == len(models()) == 1653


def test_every_model_is_a_box_of_household_size():
    for name, model in models().items():
        assert 0.001 < min(model.size) <= max(model.size) < 4, name


def test_the_axes_of_the_asset_index_are_width_depth_height():
    for kind, upright in (("FloorLamp", True), ("Fridge", True), ("Bed", False), ("Plate", False)):
        for width, depth, height in (m.size for m in models().values() if m.type == kind):
            assert (height > max(width, depth)) == upright or kind == "Bed"
    beds = [m.size for m in models().values() if m.type == "Bed"]
    assert sum(depth > width for width, depth, _ in beds) > 0.9 * len(beds)


def test_a_class_without_models_has_a_typical_size_too():
    assert min(typical_size("wardrobe")) > 0
    assert typical_size("bed")[1] > 1.5


@pytest.mark.parametrize(
    ("label", "known"),
    [
        ("DiningTable", "dining_table"),
        ("dining table", "dining_table"),
        ("DINING_TABLE", "dining_table"),
        ("FloorLamp", "lamp"),
        ("fruit bowl", "fruit_bowl"),
        ("wardrobe", "wardrobe"),
        ("Pot", "small_object"),
        ("Astrolabe", None),
        ("", None),
    ],
)
def test_a_label_is_known_however_it_is_written(label: str, known: str | None):
    assert PROCTHOR.classify(label) == known


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("Kitchen", RoomType.KITCHEN),
        ("LivingRoom", RoomType.LIVING_ROOM),
        ("Bedroom", RoomType.BEDROOM),
        ("Bathroom", RoomType.BATHROOM),
        ("cosy living room", RoomType.LIVING_ROOM),
        ("master bedroom", RoomType.BEDROOM),
        ("bedroom closet", RoomType.OTHER),
        ("home office", RoomType.OFFICE),
        ("dining_room", RoomType.DINING_ROOM),
        ("baby food storage", RoomType.OTHER),
        ("kichen", RoomType.KITCHEN),
        ("corridors", RoomType.HALLWAY),
        ("throne room", RoomType.OTHER),
        ("", RoomType.OTHER),
        ("浴室", RoomType.OTHER),
    ],
)
def test_free_text_means_the_nearest_known_room(text: str, kind: RoomType):
    assert PROCTHOR.room_type(text) == kind


@given(st.text())
def test_any_text_is_some_room(text: str):
    assert PROCTHOR.room_type(text) in RoomType


@given(st.lists(st.text(st.sampled_from("aB|-.é "), max_size=90), max_size=30))
def test_identifiers_are_valid_and_never_given_twice(texts: list[str]):
    names = Identifiers()
    given_out = [names.unique(text) for text in texts]
    assert len(set(given_out)) == len(given_out)
    for name in given_out:
        check_name("object", name)
