"""The 3-D view of a recording: the house, the marks and maps on its floor, what moves in it."""

from __future__ import annotations

from typing import Final

import numpy as np
import rerun as rr
import shapely
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import episode_floor, every_map
from lcrl_bench.recording.meshes import ColorMesh, agent_mesh, house_meshes, object_mesh
from lcrl_bench.recording.narration import plain, thing_name
from lcrl_bench.recording.palette import GOAL, PATH, TAKE, light

PAINTED: Final = 0.045
"""Height in metres of what is painted on the floor: above rugs."""


def log_house(rec: rr.RecordingStream, episode: Episode) -> None:
    """Log what stays: the house, the agent's body, the moved object's shape, marks on the floor.

    The body and the shape are in frames of their own, which `log_moves` places.
    """
    house, task = episode.scene.house, episode.task
    for mesh in house_meshes(house, without=task.moved, keep=task.target):
        rec.log(["world", "house", mesh.room or "building", mesh.label], _mesh(mesh))
    rec.log("world/agent/body", _mesh(agent_mesh()))
    if task.moved is not None:
        rec.log("world/object/shape", _mesh(object_mesh(house.object(task.moved))))
    _log_marks(rec, episode)


def _mesh(mesh: ColorMesh) -> rr.Mesh3D:
    return rr.Mesh3D(
        vertex_positions=mesh.vertices,
        triangle_indices=mesh.faces,
        vertex_colors=mesh.colors,
    )


def _log_marks(rec: rr.RecordingStream, episode: Episode) -> None:
    """Outline the tiles within reach, and label the places A and B."""
    task, floor = episode.task, episode_floor(episode)
    for name, borders, color in (("take", floor.take, TAKE), ("goal", floor.goal, GOAL)):
        lines = [_lift(line, PAINTED + 0.01) for line in borders]
        if lines:
            rec.log(f"world/marks/{name}", rr.LineStrips3D(lines, colors=color, radii=0.025))
    if task.kind == Kind.PICK and task.moved is not None and task.placement is not None:
        found = episode.scene.house.object(task.moved)
        rec.log(
            "world/marks/places",
            rr.Points3D(
                [(*thing.position[:2], thing.top + 0.25) for thing in (found, task.placement)],
                colors=[light(TAKE), light(GOAL)],
                radii=0.06,
                labels=[plain(f"A: {thing_name(episode)}"), "B"],
                show_labels=True,
            ),
        )


def log_moves(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    """Log the agent, the object and the path so far; the painted maps when the object moves."""
    way = episode.scene.grid.points[episode.tiles[: step + 1]]
    rec.log("world/agent", _pose(np.array([*way[-1], 0.0]), episode.heading_yaw(step)))
    if episode.task.moved is not None:
        rec.log("world/object", _pose(*episode.object_pose(step)))
    rec.log("world/path", rr.LineStrips3D([_lift(way, PAINTED + 0.02)], colors=PATH, radii=0.03))
    if step == 0 or episode.object_states[step] != episode.object_states[step - 1]:
        _paint_floor(rec, episode, int(episode.object_states[step]))


def _paint_floor(rec: rr.RecordingStream, episode: Episode, layer: int) -> None:
    """Log the maps of one object state as tiles painted on the floor."""
    # A seam shows where one tile ends.
    inner = [shape.buffer(-0.02, join_style="mitre") for shape in episode_floor(episode).shapes]
    parts = [shapely.get_parts(shapely.constrained_delaunay_triangles(shape)) for shape in inner]
    corners = [part.exterior.coords[:3] for triangles in parts for part in triangles]
    flat = np.array(corners, np.float64).reshape(-1, 2)
    vertices = [3 * len(triangles) for triangles in parts]
    for tile_map in every_map(episode):
        tiles = rr.Mesh3D(
            vertex_positions=_lift(flat, PAINTED),
            triangle_indices=np.arange(len(flat)).reshape(-1, 3),
            vertex_colors=np.repeat(tile_map.colors(layer), vertices, axis=0),
        )
        rec.log(["world", "tiles", tile_map.key], tiles)


def _pose(position: NDArray[np.float64], yaw: float) -> rr.Transform3D:
    """A position and a rotation about z."""
    turn = rr.RotationAxisAngle(axis=(0, 0, 1), radians=yaw)
    return rr.Transform3D(translation=position, rotation=turn)


def _lift(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Floor points [point, 2] in metres, raised to a height: [point, 3]."""
    return np.column_stack([points, np.full(len(points), height)])
