"""What of an episode stands in the 3-D view: the house, and the marks on its floor."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.recording.bird import heading_yaw, object_pose
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import goal_tiles, outline, take_tiles, tile_shapes
from lcrl_bench.recording.meshes import ColorMesh, agent_mesh, house_meshes, object_mesh
from lcrl_bench.recording.narration import plain, thing_name
from lcrl_bench.recording.palette import GOAL, PATH, TAKE, light
from lcrl_bench.recording.rerun_maps import PAINTED, lift


def log_house(rec: rr.RecordingStream, episode: Episode) -> None:
    """Log the house, the agent's body and the object that is moved, each in its own frame."""
    house, task = episode.scene.house, episode.task
    for mesh in house_meshes(house, without=task.moved, keep=task.target):
        rec.log(["world", "house", mesh.room or "building", mesh.label], _mesh(mesh))
    rec.log("world/agent/body", _mesh(agent_mesh()))
    if task.moved is not None:
        rec.log("world/object/shape", _mesh(object_mesh(house.object(task.moved))))


def _mesh(mesh: ColorMesh) -> rr.Mesh3D:
    return rr.Mesh3D(
        vertex_positions=mesh.vertices,
        triangle_indices=mesh.faces,
        vertex_colors=mesh.colors,
    )


def log_marks(rec: rr.RecordingStream, episode: Episode) -> None:
    """What stays on the floor: borders of the tiles in reach, and the places A and B."""
    grid, task = episode.scene.grid, episode.task
    shapes = tile_shapes(episode.scene.house, grid)
    for name, tiles, color, inset in (
        ("take", take_tiles(episode), TAKE, 0.07),
        ("goal", goal_tiles(episode), GOAL, 0.03),
    ):
        lines = [lift(line, PAINTED + 0.01) for line in outline(shapes, tiles, inset)]
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
    """Log where the agent and the object are at a step, and the way until then."""
    way = episode.scene.grid.points[episode.tiles[: step + 1]]
    rec.log("world/agent", _pose(np.array([*way[-1], 0.0]), heading_yaw(episode, step)))
    if episode.task.moved is not None:
        rec.log("world/object", _pose(*object_pose(episode, step)))
    rec.log("world/path", rr.LineStrips3D([lift(way, PAINTED + 0.02)], colors=PATH, radii=0.03))


def _pose(position: NDArray[np.float64], yaw: float) -> rr.Transform3D:
    """A place and a turn about z."""
    turn = rr.RotationAxisAngle(axis=(0, 0, 1), radians=yaw)
    return rr.Transform3D(translation=position, rotation=turn)
