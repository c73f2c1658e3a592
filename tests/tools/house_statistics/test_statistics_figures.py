"""The figures of a set of houses: what is put into a house is what is counted."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lcrl_bench.errors import UsageError
from lcrl_bench.houses.house import House, OpeningKind, PlacedObject
from lcrl_bench.houses.procedural import generate_house
from tools.house_statistics.reference import reference
from tools.house_statistics.report import judge, measure


@pytest.fixture(scope="module")
def house() -> House:
    return generate_house(3)


def value(house: House, name: str) -> float:
    found = measure([house])[name].value
    assert found is not None
    return found


def without(house: House, *labels: str) -> House:
    gone = {thing.id for thing in house.objects if thing.label in labels}
    kept = [t for t in house.objects if t.id not in gone and t.support not in gone]
    return replace(house, objects=tuple(kept))


def changed(house: House, thing: PlacedObject, **changes: object) -> House:
    objects = [replace(t, **changes) if t.id == thing.id else t for t in house.objects]  # pyright: ignore
    return replace(house, objects=tuple(objects))


def first(house: House, label: str) -> PlacedObject:
    return next(thing for thing in house.objects if thing.label == label)


def test_every_figure_has_a_band_and_every_band_a_figure(house):
    names = [band.name for band in reference().bands]
    assert len(names) == len(set(names))
    assert set(measure([house])) == set(names)


def test_all_25_checks_have_a_figure():
    assert {band.check for band in reference().bands} == set(range(1, 26))


def test_no_houses_have_no_figures():
    with pytest.raises(UsageError, match="no house"):
        measure([])


def test_the_same_houses_give_the_same_figures(house):
    assert measure([house]) == measure([house])


def test_a_figure_is_judged_by_its_band(house):
    figures = measure([house, without(house, "bed")])
    found = {finding.name: finding for finding in judge(figures)}["bed in bedroom"]
    assert found.value == pytest.approx(0.5)
    assert found.band == ">= 0.95"
    assert found.verdict == "differs"


def test_what_is_not_there_is_not_judged(house):
    found = {f.name: f for f in judge(measure([without(house, "sofa")]))}
    assert found["at a wall, sofa"].value is None
    assert found["at a wall, sofa"].verdict == "none"
    assert found["sofa in living room"].value == 0.0


def test_a_walled_up_door_leaves_a_room_unlinked_and_unreached(house):
    wall = next(w for w in house.walls if len(w.rooms) == 2 and w.openings)
    walls = tuple(replace(w, openings=()) if w.id == wall.id else w for w in house.walls)
    figures = measure([replace(house, walls=walls)])
    assert value(house, "houses whose rooms are all linked") == 1.0
    assert figures["houses whose rooms are all linked"].value == 0.0
    assert (figures["rooms not reached"].value or 0) >= 1
    assert (figures["smallest connected share of free tiles"].value or 1) < 0.95


def test_a_second_door_outside_is_counted(house):
    door = next(
        (w, o) for w in house.walls for o in w.openings if o.kind is OpeningKind.CLOSED_DOOR
    )
    other = next(w for w in house.walls if len(w.rooms) == 1 and w.id != door[0].id)
    walls = tuple(replace(w, openings=(door[1],)) if w.id == other.id else w for w in house.walls)
    assert value(house, "exactly one outside door") == 1.0
    assert value(replace(house, walls=walls), "exactly one outside door") == 0.0


def test_a_piece_of_furniture_pushed_into_another_overlaps_it(house):
    bed, sofa = first(house, "bed"), first(house, "sofa")
    moved = changed(house, bed, position=sofa.position, room=sofa.room)
    assert value(house, "overlapping footprints") == 0
    assert value(moved, "overlapping footprints") >= 1


def test_a_bed_in_another_room_is_outside_its_own(house):
    bed, sofa = first(house, "bed"), first(house, "sofa")
    assert value(changed(house, bed, room=sofa.room), "objects outside their room") >= 1


def test_a_bed_that_floats_is_off_the_floor(house):
    bed = first(house, "bed")
    x, y, z = bed.position
    assert value(changed(house, bed, position=(x, y, z + 0.1)), "floor objects off the floor") == 1


def test_a_sofa_turned_to_the_wall_watches_nothing():
    known = (generate_house(seed) for seed in range(20))
    house = next(h for h in known if value(h, "sofa faces a television") == 1.0)
    sofas = [t for t in house.objects if t.label == "sofa"]
    before = value(house, "sofa faces a television")
    turned = house
    for sofa in sofas:
        turned = changed(turned, sofa, yaw=sofa.yaw + 3.14159)
    assert before == 1.0
    assert value(turned, "sofa faces a television") == 0.0


def test_a_bed_turned_by_a_little_is_not_square(house):
    bed = first(house, "bed")
    turned = changed(house, bed, yaw=bed.yaw + 0.2)
    assert value(house, "large furniture square to the house") == 1.0
    assert value(turned, "large furniture square to the house") < 1.0


def test_a_wardrobe_before_a_door_is_found(house):
    door = next((w, o) for w in house.walls for o in w.openings if o.kind is OpeningKind.DOOR)
    x, y = door[0].point((door[1].start + door[1].end) / 2)
    blocker = PlacedObject("blocker", "wardrobe", door[0].rooms[0], (x, y, 1.0), (0.6, 0.6, 2.0), 0)
    blocked = replace(house, objects=(*house.objects, blocker))
    assert value(house, "door sides without 0.5 m free") == 0
    assert value(blocked, "door sides without 0.5 m free") >= 1


def test_an_object_that_stands_alone_is_named_by_its_room():
    houses = [generate_house(seed) for seed in range(4)]
    figures = measure(houses)
    assert (figures["task classes half named by receptacle and room"].value or 0) >= 0.8


def test_a_kettle_on_the_bed_is_on_no_worktop(house):
    bed = first(house, "bed")
    kettle = PlacedObject("kettle-x", "kettle", bed.room, bed.position, (0.2, 0.2, 0.2), 0, bed.id)
    there = replace(house, objects=(*house.objects, kettle))
    assert value(there, "kitchen things on a worktop or table") < 1.0


def test_differences_with_a_reason_are_told_apart():
    reasons = [band.reason for band in reference().bands if band.reason]
    assert all(len(reason) > 20 and "\n" not in reason for reason in reasons)
    assert all(row.reason for row in reference().unmeasured)
