"""Panoramas by MuJoCo's segmentation cameras: the reference renderer.

The model is only for drawing: one mesh geom per merged mesh, nothing that moves or collides. The
abstract scene is filled once; after that, only the camera changes, a geom's segment id sets its
pixel value (or that it is not drawn), and the geoms of a movable object are moved to where an
arrangement places it. The four views are drawn side by side into one buffer and read at once. All
OpenGL calls happen in a thread of the renderer's own, so any thread may use it.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import atexit
import weakref
from collections.abc import Sequence
from functools import partial
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import UsageError
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
from lcrl_bench.scenes.panoramas.context import Context, open_context
from lcrl_bench.scenes.panoramas.drawing_thread import DrawingThread
from lcrl_bench.scenes.panoramas.merged import MergedMesh, arranged_vertices, moved_pose
from lcrl_bench.scenes.panoramas.occlusion import occluded
from lcrl_bench.scenes.panoramas.renderer import PanoramaRenderer
from lcrl_bench.scenes.panoramas.visibility import bounding_boxes, in_frustum
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import Semantics

CLOSED: Final = "This renderer is closed: open another."
"""Error message for use after `close`."""
_BATCH: Final = 16
"""Panoramas per batch of visibility tests."""
_NOT_DRAWN: Final = -1
"""Segment id of a geom that MuJoCo skips."""


class GlRenderer(PanoramaRenderer):
    """Renders with OpenGL, offscreen."""

    backend: ClassVar[str] = "gl"

    def __init__(
        self, surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
    ) -> None:
        """Compile the model and start a context; arguments as in `PanoramaRenderer`.

        Raises:
            EnvironmentMissingError: If no OpenGL context can be started.
        """
        self._context: Context | None = None
        super().__init__(surfaces, semantics, movable)
        width, height = VIEWS * semantics.view_width, semantics.view_height
        model = _drawing_model(self.meshes, width, height)
        self._scene = _filled_scene(model)
        self._geoms = list(self._scene.geoms[: self._scene.ngeom])
        self._poses = [(geom.pos.copy(), geom.mat.copy()) for geom in self._geoms]
        self._segments = [_segment(mesh.class_id) for mesh in self.meshes]
        self._buffer = np.empty((height, width, 3), np.uint8)
        self._shown = np.zeros(len(self.meshes), np.bool_)
        self._axes = view_axes(semantics)
        self._aim_cameras()
        self._thread = DrawingThread()
        try:
            self._thread.run(self._open, model, width, height)
        except BaseException:
            self._thread.stop()
            raise
        # The display is closed at exit; a context that outlives it can't be freed.
        self._at_exit = partial(_close, weakref.ref(self))
        atexit.register(self._at_exit)

    def close(self) -> None:
        """Free the context; a no-op the second time, or in a forked process."""
        if self._context is None or not self._thread.is_here:
            return
        atexit.unregister(self._at_exit)
        self._thread.run(self._free)
        self._thread.stop()

    def __del__(self) -> None:
        self.close()

    def _open(self, model: mujoco.MjModel, width: int, height: int) -> None:
        context = open_context(width, height)
        self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawing)
        self._context = context

    def _free(self) -> None:
        if self._context is None:
            return
        # Freeing deletes by number in the current context, which must be this one.
        self._context.make_current()
        self._drawing.free()
        self._context.free()
        self._context = None

    def _draw(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        if self._context is None:
            raise UsageError(CLOSED)
        return self._thread.run(self._draw_here, points, arrangement)

    def _draw_here(
        self, points: NDArray[np.float64], arrangement: Arrangement
    ) -> NDArray[np.uint8]:
        # Checked again: another thread may have closed it meanwhile.
        if self._context is None:
            raise UsageError(CLOSED)
        self._context.make_current()
        eyes = eye_positions(points, self.semantics)
        drawn = self._arrange(arrangement)
        boxes = bounding_boxes(
            [arranged_vertices(mesh, self.movable, arrangement) for mesh in self.meshes]
        )
        rows, columns = self.semantics.view_height, self.semantics.view_width
        views = np.empty((len(points), VIEWS, rows, columns), np.uint8)
        for start in range(0, len(points), _BATCH):
            batch = slice(start, start + _BATCH)
            visible = in_frustum(boxes, eyes[batch], self.semantics) & drawn
            visible &= ~occluded(self._occluders, boxes, eyes[batch])[:, None, :]
            views[batch] = self._draw_batch(eyes[batch], visible)
        return views

    def _draw_batch(
        self, eyes: NDArray[np.float64], visible: NDArray[np.bool_]
    ) -> NDArray[np.uint8]:
        """[eye, 4, height, width] class ids; `visible` [eye, view, mesh]: meshes to draw."""
        rows, columns = self.semantics.view_height, self.semantics.view_width
        whole = mujoco.MjrRect(0, 0, VIEWS * columns, rows)
        views = np.empty((len(eyes), VIEWS, rows, columns), np.uint8)
        for index, eye in enumerate(eyes):
            # Always the same place in the buffer: elsewhere the viewport rounds differently, and a
            # # panorama would depend on the others in its batch.
            for view, (_, forward, up) in enumerate(self._axes):
                self._show(visible[index, view])
                for camera in self._scene.camera:
                    camera.pos, camera.forward, camera.up = eye, forward, up
                area = mujoco.MjrRect(view * columns, 0, columns, rows)
                mujoco.mjr_render(area, self._scene, self._drawing)
            mujoco.mjr_readPixels(self._buffer, None, whole, self._drawing)
            # OpenGL's row 0 is the lowest.
            tiles = self._buffer[::-1, :, 0].reshape(rows, VIEWS, columns)
            views[index] = tiles.transpose(1, 0, 2)
        return views

    def _show(self, visible: NDArray[np.bool_]) -> None:
        """Draw only these meshes."""
        for mesh in np.flatnonzero(visible != self._shown):
            self._geoms[mesh].segid = self._segments[mesh] if visible[mesh] else _NOT_DRAWN
        self._shown = visible

    def _arrange(self, arrangement: Arrangement) -> NDArray[np.bool_]:
        """Move the movable objects to their places; return which meshes are visible at all."""
        drawn = np.ones(len(self.meshes), np.bool_)
        for index, mesh in enumerate(self.meshes):
            if mesh.object is None:
                continue
            position, matrix = self._poses[index]
            if mesh.object == arrangement.hidden:
                if arrangement.placed is None:
                    drawn[index] = False
                    continue
                found = self.movable[mesh.object]
                position, matrix = moved_pose(position, matrix, found, arrangement.placed)
            self._geoms[index].pos, self._geoms[index].mat = position, matrix
        return drawn

    def _aim_cameras(self) -> None:
        half_width, half_height = half_extents(self.semantics)
        for camera in self._scene.camera:
            camera.frustum_center, camera.frustum_width = 0.0, NEAR * half_width
            camera.frustum_bottom, camera.frustum_top = -NEAR * half_height, NEAR * half_height
            camera.frustum_near, camera.frustum_far = NEAR, FAR


def _drawing_model(meshes: Sequence[MergedMesh], width: int, height: int) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.stat.extent = 1.0
    spec.visual.map.znear, spec.visual.map.zfar = NEAR, FAR
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.quality.offsamples = 0
    for index, mesh in enumerate(meshes):
        spec.add_mesh(
            name=str(index),
            uservert=mesh.vertices.astype(np.float32).ravel(),
            userface=mesh.faces.ravel(),
            # A panel or a pane has almost no volume, and MuJoCo rejects it as a solid.
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        )
        spec.worldbody.add_geom(
            name=str(index),
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=str(index),
            contype=0,
            conaffinity=0,
        )
    return spec.compile()


def _filled_scene(model: mujoco.MjModel) -> mujoco.MjvScene:
    """The abstract scene with every geom, none drawn, and flags set for segmentation."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    scene = mujoco.MjvScene(model, maxgeom=max(1, model.ngeom))
    everything = mujoco.mjtCatBit.mjCAT_ALL.value
    options, camera = mujoco.MjvOption(), mujoco.MjvCamera()
    mujoco.mjv_updateScene(model, data, options, None, camera, everything, scene)
    # All flags off: shadows and the like have no class, and both sides of a face are visible.
    scene.flags[:] = 0
    scene.flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = 1
    scene.flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = 1
    for geom in scene.geoms[: scene.ngeom]:
        geom.segid = _NOT_DRAWN
    return scene


def _segment(class_number: int) -> int:
    """The segment id whose red channel is the class: MuJoCo draws the id plus one."""
    return class_number - 1 if class_number else 255


def _close(renderer: weakref.ref[GlRenderer]) -> None:
    alive = renderer()
    if alive is not None:
        alive.close()
