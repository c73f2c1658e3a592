"""Panoramas by ray casting with Embree: no OpenGL, no screen, the same pixels.

One ray goes through the centre of each pixel, where a rasteriser samples it, and hits both sides
of every face. Static surfaces are one Embree scene, built once. Several arrangements are put
together from layers: the static surfaces are cast once, and each object at each of its places only
at the pixels of its box.
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
from lcrl_bench.scenes.panoramas.layers import Layer, StillHouse
from lcrl_bench.scenes.panoramas.merged import MergedMesh, arranged_vertices
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
        directions = ray_directions(semantics)
        self._shape = directions.shape[:3]
        # Starting at the near plane clips exactly what the rasteriser clips.
        self._starts = NEAR * directions.reshape(-1, 3)
        self._rays = directions.reshape(-1, 3).astype(np.float32)
        still = [mesh for mesh in self.meshes if mesh.object is None]
        self._still = _RayScene([(mesh.vertices, mesh.faces, mesh.class_id) for mesh in still])

    def close(self) -> None:
        """Do nothing: only memory is held."""

    def _draw(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        """All objects of the arrangement, then the static surfaces where they are nearer."""
        eyes = eye_positions(points, self.semantics)
        parts = [part for mesh in self.meshes if (part := self._part(mesh, arrangement))]
        _, classes = self._cast(eyes, (_RayScene(parts), self._still))
        return classes.reshape(-1, *self._shape)

    def _part(self, mesh: MergedMesh, arrangement: Arrangement) -> _Part | None:
        """A movable object's mesh in an arrangement; None if it is static or invisible."""
        if mesh.object is None:
            return None
        vertices = arranged_vertices(mesh, self.movable, arrangement)
        return None if vertices is None else (vertices, mesh.faces, mesh.class_id)

    def _cast(
        self, eyes: NDArray[np.float64], scenes: Sequence[_RayScene]
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """Depths from the near plane and class ids: [eye, pixel] each."""
        depths = np.full((len(eyes), len(self._rays)), FAR - NEAR, np.float32)
        classes = np.zeros(depths.shape, np.uint8)
        for start in range(0, len(eyes), _BATCH):
            batch = slice(start, start + _BATCH)
            origins = (eyes[batch, None] + self._starts).astype(np.float32).reshape(-1, 3)
            rays = np.tile(self._rays, (len(eyes[batch]), 1))
            for scene in scenes:
                scene.cast(origins, rays, depths[batch].reshape(-1), classes[batch].reshape(-1))
        return depths, classes

    def _draw_still(self, eyes: NDArray[np.float64]) -> StillHouse:
        return StillHouse(*self._cast(eyes, (self._still,)))

    def _draw_layer(
        self,
        name: str,
        arrangement: Arrangement,
        eyes: NDArray[np.float64],
        still: StillHouse,
    ) -> Layer:
        meshes = [mesh for mesh in self.meshes if mesh.object == name]
        parts = [part for mesh in meshes if (part := self._part(mesh, arrangement))]
        pixels = self._footprint([vertices for vertices, *_ in parts], eyes, still)
        eye, ray = np.divmod(pixels, len(self._rays))
        behind = still.depths.reshape(-1)[pixels]
        depths, classes = behind.copy(), np.zeros(len(pixels), np.uint8)
        origins = (eyes[eye] + self._starts[ray]).astype(np.float32)
        _RayScene(parts).cast(origins, self._rays[ray], depths, classes)
        # Whole arrangements are cast object by object, then the static surfaces: these win ties.
        front = depths < behind
        return Layer(pixels[front], depths[front], classes[front])


_Part = tuple[NDArray[np.float64], NDArray[np.int32], int]
"""Vertices [vertex, 3], faces [triangle, 3] and class id of a mesh."""


class _RayScene:
    """Triangles to cast rays at, and the class of each."""

    def __init__(self, parts: Sequence[_Part]) -> None:
        self._classes = np.repeat(
            np.array([number for *_, number in parts], np.uint8),
            [len(faces) for _, faces, _ in parts],
        )
        self._scene = None
        if parts:
            # Robust: no ray passes through the seam between two triangles.
            self._scene = EmbreeScene(robust=True)
            first = np.cumsum([0, *(len(vertices) for vertices, *_ in parts)])
            faces = [part[1] + start for part, start in zip(parts, first, strict=False)]
            vertices = np.concatenate([part[0] for part in parts]).astype(np.float32)
            TriangleMesh(self._scene, vertices, np.concatenate(faces).astype(np.int32))

    def cast(
        self,
        origins: NDArray[np.float32],
        rays: NDArray[np.float32],
        depths: NDArray[np.float32],
        classes: NDArray[np.uint8],
    ) -> None:
        """Overwrite `depths` and `classes` where a triangle is nearer than the given depth.

        At equal depths, too.
        """
        if self._scene is None or not len(rays):
            return
        found = self._scene.run(origins, rays, dists=depths.copy(), output=True)
        hit = found["primID"] >= 0
        classes[hit] = self._classes[found["primID"][hit]]
        depths[hit] = found["tfar"][hit]
