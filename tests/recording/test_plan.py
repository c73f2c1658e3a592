"""The plan of a house: rooms and objects are named, and names keep off each other."""

from __future__ import annotations

import pytest
import shapely
from house_samples import two_rooms
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from lcrl_bench.recording.floor import house_plan
from lcrl_bench.recording.plan import LabelLayout, PlanStyle, draw_plan


def blank_axes():
    axes = Figure(figsize=(4, 4)).add_axes((0, 0, 1, 1))
    axes.set_xlim(0, 4)
    axes.set_ylim(0, 4)
    return axes


@settings(max_examples=25)
@given(
    st.lists(st.tuples(st.floats(0.2, 3.8), st.floats(0.2, 3.8)), min_size=1, max_size=12),
    st.integers(1, 10),
)
def test_names_keep_off_each_other(places: list[tuple[float, float]], length: int):
    axes = blank_axes()
    labels = LabelLayout(axes)
    written = sum(labels.place("m" * length, place, size=8, color="black") for place in places)
    assert len(axes.texts) == written
    figure = axes.get_figure(root=True)
    assert figure is not None
    renderer = FigureCanvasAgg(figure).get_renderer()
    boxes = [shapely.box(*text.get_window_extent(renderer).extents) for text in axes.texts]
    spots = {text.get_position() for text in axes.texts}
    assert len(spots) == len(boxes)
    overlaps = [
        first.intersection(second).area / min(first.area, second.area)
        for number, first in enumerate(boxes)
        for second in boxes[:number]
    ]
    # "m" is the widest letter; a mean letter is what the layout reckons with.
    assert all(overlap < 0.5 for overlap in overlaps)


def test_a_forced_name_is_written_even_without_room():
    axes = blank_axes()
    labels = LabelLayout(axes)
    for _ in range(60):
        assert labels.place("sofa", (2, 2), size=30, color="black", force=True)
    assert not labels.place("sofa", (2, 2), size=30, color="black")


def test_a_plan_names_every_room_and_the_task_objects():
    axes = Figure(figsize=(6, 3)).add_axes((0, 0, 1, 1))
    draw_plan(axes, house_plan(two_rooms()))
    words = [text.get_text() for text in axes.texts]
    assert {"bedroom", "kitchen", "cup", "bed"} <= set(words)


@pytest.mark.parametrize("furnished", [True, False])
def test_a_plan_needs_no_furniture(furnished: bool):
    axes = Figure(figsize=(6, 3)).add_axes((0, 0, 1, 1))
    draw_plan(axes, house_plan(two_rooms(furnished=furnished)))
    assert ("dining table" in [text.get_text() for text in axes.texts]) is furnished


def test_names_of_rooms_keep_off_the_way_and_stay_on_the_paper():
    house = two_rooms()
    way = shapely.LineString([(0.5, 1.5), (5.5, 1.5)]).buffer(0.4)
    figure = Figure(figsize=(6, 4))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    draw_plan(axes, house_plan(house), PlanStyle(object_names=False), way)
    figure.canvas.draw()
    names = {text.get_text(): text for text in axes.texts}
    assert set(names) == {room.type.value for room in house.rooms}
    for text in names.values():
        assert not way.contains(shapely.Point(text.get_position()))
        box = text.get_window_extent()
        assert box.x0 >= axes.bbox.x0
        assert box.x1 <= axes.bbox.x1
