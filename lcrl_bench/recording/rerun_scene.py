"""What of an episode has a place: the house, the marks on its floor, and the maps over it."""

from __future__ import annotations

from typing import Final

import numpy as np
import rerun as rr
import shapely
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import (
    TileMap,
    every_map,
    goal_tiles,
    layer_titles,
    outline,
    take_tiles,
    tile_centers,
    tile_shapes,
)
from lcrl_bench.recording.meshes import ColorMesh, agent_mesh, house_meshes, object_mesh
from lcrl_bench.recording.narration import plain, thing_name
from lcrl_bench.recording.palette import GOAL, TAKE, WHITE
from lcrl_bench.recording.plan import MARGIN, extent
from lcrl_bench.recording.reward_plan import map_png

PIXELS_A_METRE: Final = 80
"""Of the maps; their overlays are in the same pixels."""
PAINTED: Final = 0.045
"""Metres above the floor of what is painted on it: over rugs."""


def log_house(rec: rr.RecordingStream, episode: Episode) -> None:
    """Log the house, the agent's body and the object that is moved, each in its own frame."""
    house, task = episode.compiled.house, episode.task
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
    """What stays on the floor and on the maps: borders of tiles in reach, start, places A and B."""
    grid, task = episode.compiled.grid, episode.task
    shapes = tile_shapes(episode.compiled.house, grid)
    for name, tiles, color, inset in (
        ("take", take_tiles(episode), TAKE, 0.07),
        ("goal", goal_tiles(episode), GOAL, 0.03),
    ):
        lines = [lift(line, PAINTED + 0.01) for line in outline(shapes, tiles, inset)]
        if lines:
            rec.log(f"world/marks/{name}", rr.LineStrips3D(lines, colors=color, radii=0.025))
    if task.kind == Kind.PICK and task.moved is not None and task.placement is not None:
        found = episode.compiled.house.object(task.moved)
        rec.log(
            "world/marks/places",
            rr.Points3D(
                [(*thing.position[:2], thing.top + 0.25) for thing in (found, task.placement)],
                colors=[TAKE, GOAL],
                radii=0.06,
                labels=[plain(f"A: {thing_name(episode)}"), "B"],
                show_labels=True,
            ),
        )
    labels = _tile_labels(episode)
    rec.log(
        "map/over/tiles",
        rr.Points2D(
            pixels(episode, tile_centers(grid)),
            radii=PIXELS_A_METRE * 0.03,
            colors=WHITE,
            labels=labels,
            show_labels=False,
        ),
    )


def _tile_labels(episode: Episode) -> list[str]:
    """What hovering over a tile tells."""
    maps, titles = every_map(episode), layer_titles(episode)
    labels = []
    for tile in range(episode.compiled.grid.tiles):
        lines = [f"tile {tile}"]
        for tile_map in maps:
            for layer, title in enumerate(titles):
                place = f" {title}" if title else ""
                lines.append(f"{tile_map.name}{place}: {tile_map.layers[layer, tile]:.3f}")
        labels.append("\n".join(lines))
    return labels


def log_maps(rec: rr.RecordingStream, episode: Episode, layer: int) -> None:
    """The maps for one place of the object, painted on the floor and over the plan."""
    for tile_map in every_map(episode):
        rec.log(["world", "tiles", tile_map.key], _tile_mesh(episode, tile_map, layer))
        png = map_png(episode, tile_map, layer, PIXELS_A_METRE)
        rec.log(["map", tile_map.key], rr.EncodedImage(contents=png, media_type="image/png"))


def _tile_mesh(episode: Episode, tile_map: TileMap, layer: int) -> rr.Mesh3D:
    shapes = tile_shapes(episode.compiled.house, episode.compiled.grid)
    colors = tile_map.colors(layer)
    corners, shades = [np.empty((0, 3, 2))], []
    for shape, color in zip(shapes, colors, strict=True):
        # A seam shows where one tile ends.
        inner = shape.buffer(-0.02, join_style="mitre")
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(inner))
        corners.append(np.array([part.exterior.coords[:3] for part in triangles]).reshape(-1, 3, 2))
        shades += [color] * 3 * len(triangles)
    flat = np.concatenate(corners)
    return rr.Mesh3D(
        vertex_positions=lift(flat.reshape(-1, 2), PAINTED),
        triangle_indices=np.arange(3 * len(flat)).reshape(-1, 3),
        vertex_colors=np.array(shades),
    )


def lift(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Points of the floor, [point, 2] metres, at a height: [point, 3]."""
    return np.column_stack([points, np.full(len(points), height)])


def pose(position: NDArray[np.float64], yaw: float) -> rr.Transform3D:
    """A place and a turn about z."""
    turn = rr.RotationAxisAngle(axis=(0, 0, 1), radians=yaw)
    return rr.Transform3D(translation=position, rotation=turn)


def pixels(episode: Episode, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Metres to pixels of the maps."""
    (x0, _), (_, y1) = extent(episode.compiled.house)
    return (points - (x0 - MARGIN, y1 + MARGIN)) * (PIXELS_A_METRE, -PIXELS_A_METRE)
