"""The building is closed, its holes are where its openings are, and its classes stay apart."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
import trimesh
from house_samples import DOOR, HEIGHT, WINDOW, make_wall, rectangle, two_rooms, without_wall
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.houses.house import House, Opening, OpeningKind, Room, RoomType
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.scenes.building import (
    OVERLAP,
    building_boxes,
    building_panels,
    building_surfaces,
    is_framed,
)

CLOSED = Opening(OpeningKind.CLOSED_DOOR, 1.0, 2.0, 0.0, 2.05)
OPEN_PLAN = Opening(OpeningKind.DOORWAY, 0.2, 2.8, 0.0, HEIGHT)


def hits(house: House, origins, directions) -> tuple[list[str | None], np.ndarray]:
    """Class of what each ray from [ray, 3] hits first (None: nothing), and how far it is."""
    surfaces = building_surfaces(house)
    mesh = trimesh.Trimesh(
        *trimesh.util.append_faces([s.vertices for s in surfaces], [s.faces for s in surfaces]),
        process=False,
    )
    owner = np.repeat(np.arange(len(surfaces)), [len(s.faces) for s in surfaces])
    origins, directions = np.atleast_2d(origins), np.atleast_2d(directions)
    places, rays, triangles = mesh.ray.intersects_location(origins, directions, multiple_hits=False)
    labels: list[str | None] = [None] * len(origins)
    distance = np.full(len(origins), np.inf)
    for place, ray, triangle in zip(places, rays, triangles, strict=True):
        labels[ray] = surfaces[owner[triangle]].label
        distance[ray] = np.linalg.norm(place - origins[ray])
    return labels, distance


def mesh_of(surface) -> trimesh.Trimesh:
    return trimesh.Trimesh(surface.vertices, surface.faces, process=False)


def turned(house: House, yaw: float) -> House:
    """The house turned about its origin."""
    cos, sin = math.cos(yaw), math.sin(yaw)

    def turn(point):
        return cos * point[0] - sin * point[1], sin * point[0] + cos * point[1]

    rooms = [replace(room, polygon=tuple(map(turn, room.polygon))) for room in house.rooms]
    walls = [replace(wall, start=turn(wall.start), end=turn(wall.end)) for wall in house.walls]
    return replace(house, rooms=tuple(rooms), walls=tuple(walls), objects=())


@st.composite
def openings(draw, length: float) -> tuple[Opening, ...]:
    """Disjoint openings of a wall of some length."""
    count = draw(st.integers(0, 3))
    shares = sorted(draw(st.floats(0.02, 0.98)) for _ in range(2 * count))
    found = []
    for near, far in zip(shares[::2], shares[1::2], strict=True):
        kind = draw(st.sampled_from(sorted(OpeningKind)))
        bottom = draw(st.floats(0.3, 1.2)) if kind is OpeningKind.WINDOW else 0.0
        top = draw(st.floats(1.9, HEIGHT))
        if (far - near) * length > 0.15:
            found.append(Opening(kind, near * length, far * length, bottom, top))
    return tuple(found)


@st.composite
def row_of_rooms(draw) -> House:
    """One to four rooms side by side, with any openings between them and panes outward."""
    edges = np.cumsum([0.0, *(draw(st.floats(1.5, 5.0)) for _ in range(draw(st.integers(1, 4))))])
    depth, thickness = draw(st.floats(1.5, 5.0)), draw(st.floats(0.03, 0.35))
    rooms, walls = [], []
    for number, (west, east) in enumerate(pairwise(edges.tolist())):
        name = f"room-{number}"
        rooms.append(Room(name, RoomType.OTHER, rectangle(west, 0, east, depth)))
        for side, y in (("south", 0.0), ("north", depth)):
            walls.append(make_wall(f"{side}-{number}", (west, y), (east, y), rooms=(name,)))
    inner = range(1, len(edges) - 1)
    for number, x in enumerate(edges.tolist()):
        holes = draw(openings(depth)) if number in inner else ()
        walls.append(make_wall(f"across-{number}", (x, 0), (x, depth), *holes))
    walls = [replace(wall, thickness=thickness) for wall in walls]
    return House("row", "sample", tuple(rooms), tuple(walls), (), HEIGHT)


def test_what_is_upright_is_closed_and_faces_outward():
    for house in (two_rooms(DOOR), two_rooms(CLOSED), two_rooms(OPEN_PLAN)):
        surfaces = {surface.name: surface for surface in building_surfaces(house)}
        for panel in building_panels(house):
            mesh = mesh_of(surfaces[panel.name])
            assert mesh.is_watertight
            assert mesh.is_winding_consistent
            assert mesh.volume == pytest.approx(panel.area() * panel.thickness)


@settings(max_examples=40)
@given(row_of_rooms())
def test_a_wall_is_its_outline_less_its_openings(house):
    validate_house(house)
    panels = {panel.name: panel for panel in building_panels(house)}
    for wall in house.walls:
        panel = panels[f"wall:{wall.id}"]
        outline = (panel.along[-1] - panel.along[0]) * (wall.height + 2 * OVERLAP)
        # A hole that meets the floor or the ceiling takes what the wall reaches into it.
        taken = sum(
            (hole.end - hole.start)
            * (
                hole.top
                - hole.bottom
                + OVERLAP * (hole.bottom <= 0)
                + OVERLAP * (hole.top >= wall.height)
            )
            for hole in wall.openings
        )
        assert panel.area() == pytest.approx(outline - taken)


@settings(max_examples=40)
@given(row_of_rooms(), st.floats(0, 6.3))
def test_the_boxes_that_collide_fill_the_meshes_that_are_seen(house, yaw):
    house = turned(house, yaw)
    boxes = building_boxes(house)
    assert len({box.name for box in boxes}) == len(boxes)
    for panel in building_panels(house):
        own = [box for box in boxes if box.name.startswith(f"{panel.name}.box-")]
        vertices, faces = panel.mesh()
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        assert sum(8 * math.prod(box.half) for box in own) == pytest.approx(mesh.volume)
        corners = np.concatenate([corners_of(box) for box in own])
        assert corners.min(axis=0) == pytest.approx(vertices.min(axis=0))
        assert corners.max(axis=0) == pytest.approx(vertices.max(axis=0))


def corners_of(box) -> np.ndarray:
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T * box.half
    cos, sin = math.cos(box.yaw), math.sin(box.yaw)
    return signs @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]]) + box.center


@settings(max_examples=30)
@given(row_of_rooms(), st.floats(0, 6.3), st.integers(0, 2**32 - 1))
def test_no_ray_that_starts_in_a_room_leaves_the_house(house, yaw, seed):
    generator = np.random.default_rng(seed)
    house = turned(house, yaw)
    origins = np.array(
        [
            (*np.mean(room.polygon, axis=0), height)
            for room in house.rooms
            for height in (0.05, 1.25, HEIGHT - 0.05)
        ]
    )
    directions = generator.normal(size=(len(origins), 500, 3))
    # Also straight at the seams: corners, the ends of walls, and where floors meet.
    seams = np.array(
        [(*end, z) for wall in house.walls for end in (wall.start, wall.end) for z in (0, HEIGHT)]
    )
    aimed = seams[None] - origins[:, None]
    every = np.concatenate([directions, aimed], axis=1)
    labels, _ = hits(house, np.repeat(origins, every.shape[1], axis=0), every.reshape(-1, 3))
    assert None not in labels


def test_floor_and_ceiling_go_through_a_door_where_rooms_end_at_the_faces_of_walls():
    house = two_rooms(OPEN_PLAN)
    bedroom = replace(house.rooms[0], polygon=rectangle(0.05, 0.05, 2.95, 2.95))
    kitchen = replace(house.rooms[1], polygon=rectangle(3.05, 0.05, 5.95, 2.95))
    house = replace(house, rooms=(bedroom, kitchen))
    in_the_doorway = (3.0, 1.5, 1.0)
    labels, distance = hits(house, [in_the_doorway] * 2, [(0, 0, -1), (0, 0, 1)])
    assert labels == ["floor", "ceiling"]
    assert distance == pytest.approx([1.0, HEIGHT - 1.0], abs=0.02)


def test_walls_reach_into_floor_and_ceiling_and_fill_their_corners():
    panels = [panel for panel in building_panels(two_rooms()) if panel.label == "wall"]
    for panel in panels:
        assert (panel.up[0], panel.up[-1]) == pytest.approx((-OVERLAP, HEIGHT + OVERLAP))
    corner, outer = np.array([0.0, 0.0]), np.array([-0.049, -0.049])
    covered = [
        box
        for box in building_boxes(two_rooms())
        if (np.abs(outer - box.center[:2]) < np.abs(turn(box.yaw) @ box.half[:2])).all()
        and np.linalg.norm(corner - box.center[:2]) < box.half[0]
    ]
    assert covered


def turn(yaw: float) -> np.ndarray:
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([[cos, -sin], [sin, cos]])


def test_without_an_outer_wall_rays_leave_the_house():
    origin, east = (4.5, 1.5, 1.2), (1, 0, 0)
    assert hits(two_rooms(), origin, east)[0] == ["wall"]
    assert hits(without_wall(two_rooms(), "east"), origin, east)[0] == [None]


def test_a_ray_passes_the_door_and_hits_the_wall_beside_it():
    house = two_rooms(DOOR)
    origins = [(1.5, y, 1.2) for y in (1.5, 1.05, 0.9, 2.1)]
    _, distance = hits(house, origins, [(1, 0, 0)] * 4)
    assert distance[:2] == pytest.approx(4.45, abs=0.01)
    assert distance[2:] == pytest.approx(1.45, abs=0.02)
    labels, _ = hits(house, [(1.5, 1.5, 2.04), (1.5, 1.5, 2.2)], [(1, 0, 0)] * 2)
    assert labels == ["door_frame", "wall"]


def test_each_opening_shows_its_own_class():
    ahead = (1, 0, 0)
    assert hits(two_rooms(CLOSED), (1.5, 1.5, 1.2), ahead)[0] == ["door"]
    assert hits(two_rooms(WINDOW), (1.5, 1.5, 1.2), ahead)[0] == ["window"]
    assert hits(two_rooms(WINDOW), (1.5, 1.5, 0.5), ahead)[0] == ["wall"]
    assert hits(two_rooms(DOOR), (1.5, 1.005, 1.2), ahead)[0] == ["door_frame"]


def test_an_open_plan_doorway_has_no_lining():
    wall = two_rooms(OPEN_PLAN).walls[-1]
    assert not is_framed(wall, OPEN_PLAN)
    assert is_framed(wall, replace(OPEN_PLAN, start=0.9, end=2.1, top=2.05))
    labels = {surface.label for surface in building_surfaces(two_rooms(OPEN_PLAN))}
    assert labels == {"floor", "ceiling", "wall", "window"}
    origin = (1.5, 1.5, HEIGHT - 0.01)
    assert hits(two_rooms(OPEN_PLAN), origin, (1, 0, 0))[1][0] == pytest.approx(4.45, abs=0.01)


def test_floor_is_below_ceiling_above_and_rooms_own_theirs():
    house = two_rooms()
    labels, distance = hits(house, [(1.5, 1.5, 1.0)] * 2, [(0, 0, -1), (0, 0, 1)])
    assert labels == ["floor", "ceiling"]
    assert distance == pytest.approx([1.0, HEIGHT - 1.0])
    owned = {(s.label, s.room) for s in building_surfaces(house) if s.room is not None}
    assert owned == {(label, room.id) for label in ("floor", "ceiling") for room in house.rooms}


@pytest.mark.parametrize("opening", [DOOR, CLOSED, WINDOW, OPEN_PLAN], ids=lambda o: o.kind.value)
@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_faces_of_different_classes_never_share_a_plane(opening, yaw):
    planes: dict[tuple, list] = {}
    for surface in building_surfaces(turned(two_rooms(opening), yaw)):
        for triangle in surface.vertices[surface.faces]:
            normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
            normal /= np.linalg.norm(normal)
            key = (*np.round(normal, 4) + 0.0, round(float(normal @ triangle[0]), 4) + 0.0)
            planes.setdefault(key, []).append((surface.label, triangle))
    shared = 0
    for (*normal, _), triangles in planes.items():
        axes = [axis for axis in range(3) if axis != int(np.abs(normal).argmax())]
        areas = {
            label: shapely.union_all(
                [shapely.Polygon(t[:, axes]) for other, t in triangles if other == label]
            )
            for label in {label for label, _ in triangles}
        }
        for one, area in areas.items():
            for other, beside in areas.items():
                shared += one < other and area.intersection(beside).area > 1e-6
    assert shared == 0
