"""The geometry of walls and boxes, and looking things up."""

from __future__ import annotations

import math

import pytest
from house_samples import make_wall, two_rooms
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.houses.house import PlacedObject

METRES = st.floats(-50, 50)


def box(yaw: float, x: float = 0.0, y: float = 0.0) -> PlacedObject:
    return PlacedObject("box", "desk", "room", (x, y, 0.5), (2.0, 1.0, 1.0), yaw)


def test_an_unknown_room_or_object_is_named_with_the_valid_ones():
    house = two_rooms()
    assert house.room("kitchen") is house.rooms[1]
    with pytest.raises(UnknownNameError, match=r"room 'kitchn'\. Did you mean 'kitchen'"):
        house.room("kitchn")
    with pytest.raises(
        UnknownNameError, match=r"object 'throne'.* Valid: bed, chair, cup, rug, ta"
    ):
        house.object("throne")


def test_a_box_stands_between_its_base_and_its_top():
    assert (box(0).base, box(0).top) == (0.0, 1.0)


def test_a_box_at_yaw_0_has_its_width_along_x_and_its_front_to_the_north():
    assert box(0).footprint() == ((-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5))


@given(st.floats(-10, 10), METRES, METRES)
def test_a_footprint_is_counter_clockwise_and_turns_about_its_centre(
    yaw: float, x: float, y: float
):
    corners = box(yaw, x, y).footprint()
    pairs = list(zip(corners, corners[1:] + corners[:1], strict=True))
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs) / 2
    assert area == pytest.approx(2.0, abs=1e-8)
    assert sum(c[0] for c in corners) / 4 == pytest.approx(x, abs=1e-9)
    front = [(corners[2][i] + corners[3][i]) / 2 for i in (0, 1)]
    assert front == pytest.approx([x - math.sin(yaw) / 2, y + math.cos(yaw) / 2], abs=1e-9)


def test_a_point_of_a_wall_lies_that_far_from_its_start():
    wall = make_wall("wall", (1, 2), (4, 6))
    assert wall.length == 5
    assert wall.point(0) == (1, 2)
    assert wall.point(2.5) == pytest.approx((2.5, 4))
    assert wall.point(5) == pytest.approx((4, 6))
