"""The commands of the paper's grammar."""

from lcrl_bench.benchmarks.grammar import (
    NAMED_ROOMS,
    named_classes,
    nav_command,
    pick_command,
    tokens,
    words_of,
)
from lcrl_bench.houses.classes import task_objects


def test_commands_read_as_in_the_paper():
    assert nav_command(words_of("fruit_bowl")) == "go to the fruit bowl"
    assert pick_command("cup", "living room") == "move the cup to the living room"


def test_every_task_object_can_be_named_and_no_part_of_the_building_can():
    named = set(named_classes())
    assert named.issuperset(task_objects())
    assert named.isdisjoint({"void", "wall", "floor", "ceiling", "door", "small_object"})


def test_names_of_rooms_and_things_never_coincide():
    assert {room.value for room in NAMED_ROOMS}.isdisjoint(map(words_of, named_classes()))


def test_tokens_ignore_case_and_punctuation():
    assert tokens("Go to the Fruit Bowl!") == ("go", "to", "the", "fruit", "bowl")
