"""What `assets/receptacles.toml` promises is what the meshes are: flat, level and free faces."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

from lcrl_bench.houses import receptacles
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.houses.receptacles import Face, faces, receptacle_labels
from lcrl_bench.scenes.shapes import object_parts, shape_count

SIZES = {
    "bed": [(1.01, 1.87, 0.67), (1.38, 2.08, 0.92), (2.05, 2.43, 1.21)],
    "sofa": [(1.56, 0.79, 0.72), (2.08, 0.93, 0.96), (2.72, 1.12, 1.15)],
    "armchair": [(0.76, 0.7, 0.73), (1.0, 0.91, 0.91), (1.41, 1.07, 1.1)],
    "chair": [(0.39, 0.47, 0.77), (0.48, 0.55, 0.88), (0.63, 0.63, 1.04)],
    "stool": [(0.31, 0.23, 0.45), (0.46, 0.46, 0.46), (0.54, 0.38, 0.76)],
    "shelf": [(0.67, 0.3, 1.28), (0.67, 0.3, 2.07), (0.87, 0.54, 2.2)],
}
"""Small, usual and large boxes, from statistics of real houses."""
ANY = [(0.5, 0.4, 0.4), (1.2, 0.6, 0.75), (2.4, 1.1, 0.95), (0.1, 0.1, 0.1), (3.0, 3.0, 1.5)]
CASES = [
    (label, shape, size)
    for label in receptacle_labels()
    for shape in range(shape_count(label))
    for size in SIZES.get(label, []) + ANY
]


def placed(label: str, size: tuple[float, float, float], shape: int) -> PlacedObject:
    """An object standing on the floor at the origin."""
    center = (0.0, 0.0, size[2] / 2)
    return PlacedObject("thing", label, "room", center, size, yaw=0.0, shape=shape)


def first_hits(thing: PlacedObject, face: Face, start: float) -> np.ndarray:
    """Heights at which rays dropped from `start` metres onto a grid over the face first hit."""
    parts = object_parts(thing.label, thing.size, thing.shape)
    mesh = trimesh.util.concatenate(
        [trimesh.Trimesh(part.vertices, part.faces, process=False) for part in parts]
    )
    # Shares that fall on no seam in particular, and close to the corners.
    shares = np.concatenate([[-0.999], np.linspace(-0.97, 0.96, 12), [0.999]])
    points = [(*face.point(u, v), start - thing.position[2]) for u in shares for v in shares]
    origins = np.array(points)
    down = np.tile([0.0, 0.0, -1.0], (len(origins), 1))
    where, rays, _ = RayMeshIntersector(mesh).intersects_location(
        origins, down, multiple_hits=False
    )
    hits = np.full(len(origins), -np.inf)
    hits[rays] = where[:, 2] + thing.position[2]
    return hits


@pytest.mark.parametrize(("label", "shape", "size"), CASES)
def test_a_promised_face_is_there_and_nothing_sticks_through_it(
    label: str, shape: int, size: tuple[float, float, float]
):
    thing = placed(label, size, shape)
    promised = faces(thing)
    for k, face in enumerate(promised):
        # From above the object, or from the lower part of the room under the next board.
        last = k + 1 == len(promised)
        above = size[2] + 0.1 if last else 0.3 * face.height + 0.7 * promised[k + 1].height
        hits = first_hits(thing, face, above)
        assert np.abs(hits - face.height).max() <= 0.005


@pytest.mark.parametrize("label", receptacle_labels())
def test_the_round_shapes_are_counted_as_the_shapes_are(label: str):
    rounded = receptacles._table()[label].get("round")
    assert rounded is None or rounded["of"] == shape_count(label)


def test_less_of_a_round_table_can_be_used():
    square, rounded = (
        faces(placed("dining_table", (1.2, 1.2, 0.75), shape))[0] for shape in (0, 2)
    )
    assert rounded.half[0] < square.half[0]
    corner = np.hypot(*rounded.half)
    assert corner < 0.6
