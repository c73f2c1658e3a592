"""Panoramas by ray casting with Embree: no OpenGL, no screen, the same pixels.

One ray goes through the centre of each pixel, where a rasteriser samples it, and hits both sides
of every face. Static surfaces are one Embree scene, built once; the few movable objects are
another, rebuilt for each arrangement.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Final

import numpy as np
from embreex.mesh_construction import TriangleMesh  # pyright: ignore[reportMissingImports]
from embreex.rtcore_scene import EmbreeScene  # pyright: ignore[reportMissingImports]
from numpy.typing import NDArray

from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.panoramas.camera import FAR, NEAR, eye_positions, ray_directions
from lcrl_bench.scenes.panoramas.merged import arranged_vertices
from lcrl_bench.scenes.panoramas.renderer import PanoramaRenderer
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import Semantics

_BATCH: Final = 32
"""Panoramas per batch of rays; limits memory to a few tens of megabytes."""


class RayRenderer(PanoramaRenderer):
    """Renders by casting one ray per pixel."""

    backend: ClassVar[str] = "rays"

    def __init__(
        self, surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
    ) -> None:
        """Build the static scene; arguments as in `PanoramaRenderer`."""
        super().__init__(surfaces, semantics, movable)
        self._directions = ray_directions(semantics)
        still = [mesh for mesh in self.meshes if mesh.object is None]
        self._still = _RayScene([(mesh.vertices, mesh.faces, mesh.class_id) for mesh in still])

    def close(self) -> None:
        """Do nothing: only memory is held."""

    def _draw(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        eyes = eye_positions(points, self.semantics)
        views = np.empty((len(points), *self._directions.shape[:3]), np.uint8)
        movable = self._movable_scene(arrangement)
        for start in range(0, len(points), _BATCH):
            batch = slice(start, start + _BATCH)
            views[batch] = self._cast(eyes[batch], movable)
        return views

    def _movable_scene(self, arrangement: Arrangement) -> _RayScene:
        parts = []
        for mesh in self.meshes:
            if mesh.object is not None:
                vertices = arranged_vertices(mesh, self.movable, arrangement)
                if vertices is not None:
                    parts.append((vertices, mesh.faces, mesh.class_id))
        return _RayScene(parts)

    def _cast(self, eyes: NDArray[np.float64], movable: _RayScene) -> NDArray[np.uint8]:
        """[point, 4, height, width] class ids seen from `eyes` [point, 3]."""
        shape = (len(eyes), *self._directions.shape)
        directions = np.broadcast_to(self._directions, shape)
        # Starting at the near plane clips exactly what the rasteriser clips.
        origins = (eyes[:, None, None, None, :] + NEAR * directions).reshape(-1, 3)
        origins = origins.astype(np.float32)
        rays = directions.reshape(-1, 3).astype(np.float32)
        depths = np.full(len(rays), FAR - NEAR, np.float32)
        classes = np.zeros(len(rays), np.uint8)
        for scene in (movable, self._still):
            scene.cast(origins, rays, depths, classes)
        return classes.reshape(shape[:-1])


class _RayScene:
    """Triangles to cast rays at, and the class of each."""

    def __init__(self, parts: Sequence[tuple[NDArray[np.float64], NDArray[np.int32], int]]) -> None:
        """Take (vertices, faces, class id) of each mesh."""
        corners = [vertices[faces] for vertices, faces, _ in parts]
        self._classes = np.repeat(
            np.array([number for *_, number in parts], np.uint8), [len(part) for part in corners]
        )
        self._scene = None
        if corners:
            # Robust: no ray passes through the seam between two triangles.
            self._scene = EmbreeScene(robust=True)
            TriangleMesh(self._scene, np.concatenate(corners).astype(np.float32))

    def cast(
        self,
        origins: NDArray[np.float32],
        rays: NDArray[np.float32],
        depths: NDArray[np.float32],
        classes: NDArray[np.uint8],
    ) -> None:
        """Overwrite `depths` and `classes` where a triangle is nearer than the given depth."""
        if self._scene is None:
            return
        found = self._scene.run(origins, rays, dists=depths.copy(), output=True)
        hit = found["primID"] >= 0
        classes[hit] = self._classes[found["primID"][hit]]
        depths[hit] = found["tfar"][hit]
