"""Panoramas by MuJoCo Warp: segmentation cameras of many standing points in one launch.

Each standing point is a world of its own with four cameras; all worlds share the meshes. Worlds
differ in where their cameras are, and whole arrangements are put together from layers: the static
meshes are drawn in all worlds, then each object alone in those whose views may show it. It runs on
the device that Warp prefers: a CUDA device if there is one, else the CPU.

Source: mujoco_warp's `create_render_context`, `refit_bvh` and `render`.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from threading import Lock
from typing import ClassVar, Final

import mujoco_warp  # pyright: ignore[reportMissingImports]
import numpy as np
import warp  # pyright: ignore[reportMissingImports]
from numpy.typing import NDArray

from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.scenes.panoramas.camera import (
    FAR,
    NEAR,
    VIEWS,
    eye_positions,
    half_extents,
    view_axes,
)
from lcrl_bench.scenes.panoramas.drawing_model import drawing_spec
from lcrl_bench.scenes.panoramas.layers import Composition, Layer, StillHouse, joined
from lcrl_bench.scenes.panoramas.merged import MergedMesh, arranged_vertices, moved_pose
from lcrl_bench.scenes.panoramas.renderer import PanoramaRenderer
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import Semantics

WORLDS: Final = {"cpu": 8, "cuda": 256}
"""Standing points per launch, by kind of device. A launch costs as much with fewer."""
_AWAY: Final = (0.0, 0.0, -1e6)
"""Metres: where geoms are that are not drawn, far beyond the far plane."""

_Pose = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Origin [3], metres, and axes [3, 3] of a geom in the house's frame."""


class WarpRenderer(PanoramaRenderer):
    """Renders with MuJoCo Warp's batched ray tracer."""

    backend: ClassVar[str] = "warp"

    def __init__(
        self, surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
    ) -> None:
        """Put the meshes on the device; arguments as in `PanoramaRenderer`."""
        super().__init__(surfaces, semantics, movable)
        self._pixels = VIEWS * semantics.view_height * semantics.view_width
        self._classes = np.array([*(mesh.class_id for mesh in self.meshes), 0], np.uint8)
        # All calls share the device's arrays.
        self._lock = Lock()
        # MuJoCo Warp has no model without geoms.
        if self.meshes:
            self._open()

    def close(self) -> None:
        """Do nothing: only memory is held."""

    def _open(self) -> None:
        """The model, the state of all worlds and the arrays that are drawn to."""
        # What it prints would stand before the JSON of a command.
        warp.config.log_level = max(warp.config.log_level, warp.LOG_WARNING)
        self._device = warp.get_preferred_device()
        self._worlds = WORLDS["cuda" if self._device.is_cuda else "cpu"]
        model = _drawing_model(self.meshes, self.semantics)
        state = mujoco.MjData(model)
        mujoco.mj_kinematics(model, state)
        self._poses = list(zip(state.geom_xpos, state.geom_xmat.reshape(-1, 3, 3), strict=True))
        right, forward, up = view_axes(self.semantics).swapaxes(0, 1)
        axes = np.stack([right, up, -forward], axis=-1)
        with warp.ScopedDevice(self._device):
            self._model = mujoco_warp.put_model(model)
            self._data = mujoco_warp.put_data(model, state, nworld=self._worlds)
            self._drawing = mujoco_warp.create_render_context(
                model,
                nworld=self._worlds,
                cam_res=(self.semantics.view_width, self.semantics.view_height),
                render_rgb=False,
                render_depth=True,
                render_seg=True,
                use_textures=False,
                enable_vertex_normals=False,
                # As the other renderers do it: exact arithmetic, and both sides of a face.
                use_fast_math=False,
                enable_backface_culling=False,
            )
        self._data.cam_xmat.assign(self._in_all_worlds(axes))

    def _draw(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        eyes = eye_positions(points, self.semantics)
        still = self._draw_still(eyes)
        layers = {name: self._draw_layer(name, arrangement, eyes, still) for name in self._objects}
        shape = (-1, VIEWS, self.semantics.view_height, self.semantics.view_width)
        return Composition(still.classes, layers).found.reshape(shape)

    def _draw_still(self, eyes: NDArray[np.float64]) -> StillHouse:
        static = [index for index, mesh in enumerate(self.meshes) if mesh.object is None]
        depths, classes = self._trace(eyes, {index: self._poses[index] for index in static})
        return StillHouse(depths, classes)

    def _draw_layer(
        self,
        name: str,
        arrangement: Arrangement,
        eyes: NDArray[np.float64],
        still: StillHouse,
    ) -> Layer:
        poses, places = {}, []
        for index, mesh in enumerate(self.meshes):
            place = arranged_vertices(mesh, self.movable, arrangement)
            if mesh.object == name and place is not None:
                poses[index] = self._pose(index, arrangement)
                places.append(place)
        if not poses:
            return joined(())
        pixels = self._footprint(places, eyes, still)
        seeing, row = np.unique(pixels // self._pixels, return_inverse=True)
        depths, classes = self._trace(eyes[seeing], poses)
        column = pixels % self._pixels
        depths, classes = depths[row, column], classes[row, column]
        # As with rays, the static meshes win ties.
        front = depths < still.depths.reshape(-1)[pixels]
        return Layer(pixels[front], depths[front], classes[front])

    def _pose(self, index: int, arrangement: Arrangement) -> _Pose:
        """Where the geom of a visible mesh is in an arrangement."""
        name = self.meshes[index].object
        if name is None or name != arrangement.hidden or arrangement.placed is None:
            return self._poses[index]
        return moved_pose(*self._poses[index], self.movable[name], arrangement.placed)

    def _trace(
        self, eyes: NDArray[np.float64], poses: Mapping[int, _Pose]
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """Depths from the near plane and class ids, [eye, pixel] each, of some geoms at poses."""
        depths = np.full((len(eyes), self._pixels), FAR - NEAR, np.float32)
        classes = np.zeros(depths.shape, np.uint8)
        if not poses or not len(eyes):
            return depths, classes
        with self._lock, warp.ScopedDevice(self._device):
            self._place(poses)
            for start in range(0, len(eyes), self._worlds):
                batch = slice(start, start + self._worlds)
                far, geoms = self._launch(eyes[batch])
                depths[batch] = np.where(geoms >= 0, far - np.float32(NEAR), depths[batch])
                classes[batch] = self._classes[geoms]
        return depths, classes

    def _place(self, poses: Mapping[int, _Pose]) -> None:
        """Move these geoms to their poses, and all others out of sight, in every world."""
        positions = np.full((len(self.meshes), 3), _AWAY)
        matrices = np.tile(np.eye(3), (len(self.meshes), 1, 1))
        for index, pose in poses.items():
            positions[index], matrices[index] = pose
        self._data.geom_xpos.assign(self._in_all_worlds(positions))
        self._data.geom_xmat.assign(self._in_all_worlds(matrices))
        mujoco_warp.refit_bvh(self._model, self._data, self._drawing)

    def _launch(self, eyes: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        """Depths from the eye and numbers of geoms, -1 for none: [eye, pixel] each."""
        # The worlds without a standing point draw the first one again.
        origins = np.repeat(eyes[:1], self._worlds, axis=0)
        origins[: len(eyes)] = eyes
        self._data.cam_xpos.assign(np.repeat(origins[:, None], VIEWS, axis=1).astype(np.float32))
        mujoco_warp.render(self._model, self._data, self._drawing)
        depths, segments = self._drawing.depth_data.numpy(), self._drawing.seg_data.numpy()
        return depths[: len(eyes)], segments[: len(eyes), :, 0]

    def _in_all_worlds(self, values: NDArray[np.float64]) -> NDArray[np.float32]:
        return np.broadcast_to(values.astype(np.float32), (self._worlds, *values.shape)).copy()


def _drawing_model(meshes: Sequence[MergedMesh], semantics: Semantics) -> mujoco.MjModel:
    spec = drawing_spec(meshes)
    _, half_height = half_extents(semantics)
    for _ in range(VIEWS):
        spec.worldbody.add_camera(fovy=2 * math.degrees(math.atan(half_height)))
    return spec.compile()
