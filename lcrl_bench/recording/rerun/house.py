"""The 3-D view of a recording: the house, the marks and maps on its floor, what moves in it."""

from __future__ import annotations

from typing import Final

import numpy as np
import rerun as rr
import shapely
from numpy.typing import NDArray

from lcrl_bench.recording.meshes import ColorMesh
from lcrl_bench.recording.palette import GOAL, PATH, TAKE, light
from lcrl_bench.recording.storyboard import Pose, Storyboard

PAINTED: Final = 0.045
"""Height in metres of what is painted on the floor: above rugs."""


def log_house(rec: rr.RecordingStream, board: Storyboard, step: int) -> None:
    """Log the house at the first step; then what has moved or changed colour in it."""
    if step == 0:
        _log_still(rec, board)
    shown, state = board.steps[step], board.episode.object_states
    rec.log("world/agent", _transform(shown.agent))
    if shown.thing is not None:
        rec.log("world/object", _transform(shown.thing))
    way = _lift(board.points[: step + 1], PAINTED + 0.02)
    rec.log("world/path", rr.LineStrips3D([way], colors=PATH, radii=0.03))
    if step == 0 or state[step] != state[step - 1]:
        _paint_floor(rec, board, int(state[step]))


def _log_still(rec: rr.RecordingStream, board: Storyboard) -> None:
    """Log what stays: the house, marks on its floor, the shapes of agent and moved object.

    The shapes are in frames of their own.
    """
    for mesh in board.scenery:
        rec.log(["world", "house", mesh.room or "building", mesh.label], _mesh(mesh))
    rec.log("world/agent/body", _mesh(board.agent))
    if board.thing is not None:
        rec.log("world/object/shape", _mesh(board.thing))
    floor = board.floor
    for name, borders, color in (("take", floor.take, TAKE), ("goal", floor.goal, GOAL)):
        lines = [_lift(line, PAINTED + 0.01) for line in borders]
        if lines:
            rec.log(f"world/marks/{name}", rr.LineStrips3D(lines, colors=color, radii=0.025))
    if floor.places:
        rec.log(
            "world/marks/places",
            rr.Points3D(
                [(*place.at, place.top + 0.25) for place in floor.places],
                colors=[light(TAKE), light(GOAL)],
                radii=0.06,
                labels=[place.label for place in floor.places],
                show_labels=True,
            ),
        )


def _mesh(mesh: ColorMesh) -> rr.Mesh3D:
    return rr.Mesh3D(
        vertex_positions=mesh.vertices,
        triangle_indices=mesh.faces,
        vertex_colors=mesh.colors,
    )


def _paint_floor(rec: rr.RecordingStream, board: Storyboard, layer: int) -> None:
    """Log the maps of one object state as tiles painted on the floor."""
    # A seam shows where one tile ends.
    inner = [shape.buffer(-0.02, join_style="mitre") for shape in board.floor.shapes]
    parts = [shapely.get_parts(shapely.constrained_delaunay_triangles(shape)) for shape in inner]
    corners = [part.exterior.coords[:3] for triangles in parts for part in triangles]
    flat = np.array(corners, np.float64).reshape(-1, 2)
    vertices = [3 * len(triangles) for triangles in parts]
    for tile_map in board.painted:
        tiles = rr.Mesh3D(
            vertex_positions=_lift(flat, PAINTED),
            triangle_indices=np.arange(len(flat)).reshape(-1, 3),
            vertex_colors=np.repeat(tile_map.colors[layer], vertices, axis=0),
        )
        rec.log(["world", "tiles", tile_map.key], tiles)


def _transform(pose: Pose) -> rr.Transform3D:
    turn = rr.RotationAxisAngle(axis=(0, 0, 1), radians=pose.yaw)
    return rr.Transform3D(translation=pose.position, rotation=turn)


def _lift(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Floor points [point, 2] in metres, raised to a height: [point, 3]."""
    return np.column_stack([points, np.full(len(points), height)])
