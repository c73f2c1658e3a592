"""Panoramas by MuJoCo's segmentation cameras: the reference renderer.

The model is only for drawing: one mesh geom per merged mesh, nothing that moves or collides. The
abstract scene is filled once; after that, only the camera changes, a geom's segment id sets its
pixel value (or that it is not drawn), and the geoms of a movable object are moved to where an
arrangement places it. The four views are drawn side by side into one buffer and read at once.
Several arrangements are put together from layers: the static meshes are drawn once, and each object
at each of its places alone, in the views that may show it. All OpenGL calls happen in a thread of
the renderer's own, so any thread may use it.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import atexit
import weakref
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import ClassVar, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import UsageError
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
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
from lcrl_bench.scenes.panoramas.drawing_model import drawing_spec
from lcrl_bench.scenes.panoramas.drawing_thread import DrawingThread
from lcrl_bench.scenes.panoramas.drawn_still import DrawnStill
from lcrl_bench.scenes.panoramas.layers import Layer, StillHouse, joined
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


_Drawn = TypeVar("_Drawn")


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
        self._shape = (VIEWS, semantics.view_height, semantics.view_width)
        width, height = VIEWS * semantics.view_width, semantics.view_height
        model = _drawing_model(self.meshes, width, height)
        self._scene = _filled_scene(model)
        self._geoms = list(self._scene.geoms[: self._scene.ngeom])
        self._poses = [(geom.pos.copy(), geom.mat.copy()) for geom in self._geoms]
        self._segments = [_segment(mesh.class_id, k) for k, mesh in enumerate(self.meshes)]
        self._colors = np.empty((height, width, 3), np.uint8)
        self._depths = np.empty((height, width), np.float32)
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
        # As the driver has it, larger if nearer: turned round, it would lose bits.
        self._drawing.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR.value
        self._context = context

    def _free(self) -> None:
        if self._context is None:
            return
        # Freeing deletes by number in the current context, which must be this one.
        self._context.make_current()
        self._drawing.free()
        self._context.free()
        self._context = None

    @property
    def _objects(self) -> tuple[str, ...]:
        # At equal depths, the driver draws later meshes over earlier ones.
        return super()._objects[::-1]

    def _draw(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        eyes = eye_positions(points, self.semantics)
        return self._run(lambda: self._draw_arrangement(eyes, arrangement))

    def _draw_still(self, eyes: NDArray[np.float64]) -> DrawnStill:
        return self._run(lambda: self._draw_static_meshes(eyes))

    def _draw_layer(
        self,
        name: str,
        arrangement: Arrangement,
        eyes: NDArray[np.float64],
        still: StillHouse,
    ) -> Layer:
        assert isinstance(still, DrawnStill), "what `_draw_still` returned"
        return self._run(lambda: self._draw_object(name, arrangement, eyes, still))

    def _run(self, draw: Callable[[], _Drawn]) -> _Drawn:
        """Call a function in the context's thread."""

        def in_thread() -> _Drawn:
            # Checked again: another thread may have closed it meanwhile.
            if self._context is None:
                raise UsageError(CLOSED)
            self._context.make_current()
            return draw()

        if self._context is None:
            raise UsageError(CLOSED)
        return self._thread.run(in_thread)

    def _draw_arrangement(
        self, eyes: NDArray[np.float64], arrangement: Arrangement
    ) -> NDArray[np.uint8]:
        """[eye, 4, height, width] class ids."""
        drawn = self._arrange(arrangement)
        views = np.empty((len(eyes), *self._shape), np.uint8)
        for index, visible in enumerate(self._visible(eyes, arrangement, drawn)):
            self._draw_views(eyes[index], visible, range(VIEWS))
            views[index] = self._read()[0][..., 0]
        return views

    def _draw_static_meshes(self, eyes: NDArray[np.float64]) -> DrawnStill:
        self._arrange(AS_FOUND)
        static = np.array([mesh.object is None for mesh in self.meshes], np.bool_)
        colors = np.empty((len(eyes), *self._shape, 3), np.uint8)
        depths = np.empty((len(eyes), *self._shape), np.float32)
        for index, visible in enumerate(self._visible(eyes, AS_FOUND, static)):
            self._draw_views(eyes[index], visible, range(VIEWS))
            colors[index], depths[index] = self._read()
        pixels = int(np.prod(self._shape))
        return DrawnStill.of(colors.reshape(-1, pixels, 3), depths.reshape(-1, pixels))

    def _draw_object(
        self,
        name: str,
        arrangement: Arrangement,
        eyes: NDArray[np.float64],
        still: DrawnStill,
    ) -> Layer:
        self._arrange(arrangement)
        meshes = [mesh for mesh in self.meshes if mesh.object == name]
        places = [arranged_vertices(mesh, self.movable, arrangement) for mesh in meshes]
        covered = self._footprint([place for place in places if place is not None], eyes, still)
        size = self.semantics.view_height * self.semantics.view_width
        views = np.unique(covered // size)
        shown = np.array([mesh.object == name for mesh in self.meshes], np.bool_)
        visible = np.broadcast_to(shown, (VIEWS, len(shown)))
        parts = []
        for eye in np.unique(views // VIEWS):
            chosen = views[views // VIEWS == eye] % VIEWS
            self._draw_views(eyes[eye], visible, chosen)
            colors, depths = self._read()
            for view in chosen:
                first = int(eye * VIEWS + view) * size
                parts.append(still.in_front(first, colors[view], depths[view]))
        return joined(parts)

    def _visible(
        self, eyes: NDArray[np.float64], arrangement: Arrangement, drawn: NDArray[np.bool_]
    ) -> Iterator[NDArray[np.bool_]]:
        """For each eye, which of the meshes `drawn` each view may see: [4, mesh]."""
        boxes = bounding_boxes(
            [arranged_vertices(mesh, self.movable, arrangement) for mesh in self.meshes]
        )
        for start in range(0, len(eyes), _BATCH):
            batch = eyes[start : start + _BATCH]
            visible = in_frustum(boxes, batch, self.semantics) & drawn
            yield from visible & ~occluded(self._occluders, boxes, batch)[:, None, :]

    def _draw_views(
        self, eye: NDArray[np.float64], visible: NDArray[np.bool_], views: Iterable[int]
    ) -> None:
        """Draw the meshes `visible` [4, mesh] into the parts of the buffer for some views."""
        rows, columns = self._shape[1:]
        # Always the same place in the buffer: elsewhere the viewport rounds differently, and a
        # panorama would depend on the others in its batch.
        for view in views:
            self._show(visible[view])
            _, forward, up = self._axes[view]
            for camera in self._scene.camera:
                camera.pos, camera.forward, camera.up = eye, forward, up
            area = mujoco.MjrRect(int(view) * columns, 0, columns, rows)
            mujoco.mjr_render(area, self._scene, self._drawing)

    def _read(self) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Colors [4, height, width, 3] and depths [4, height, width] in the buffer."""
        views, rows, columns = self._shape
        whole = mujoco.MjrRect(0, 0, views * columns, rows)
        mujoco.mjr_readPixels(self._colors, self._depths, whole, self._drawing)
        # OpenGL's row 0 is the lowest.
        colors = self._colors[::-1].reshape(rows, views, columns, 3)
        depths = self._depths[::-1].reshape(rows, views, columns)
        return colors.swapaxes(0, 1), depths.swapaxes(0, 1)

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
    spec = drawing_spec(meshes)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.quality.offsamples = 0
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


def _segment(class_number: int, mesh: int) -> int:
    """The segment id whose red is the class, and green and blue the mesh.

    MuJoCo draws the id plus one.
    """
    return 256 * (mesh + 1) + class_number - 1


def _close(renderer: weakref.ref[GlRenderer]) -> None:
    alive = renderer()
    if alive is not None:
        alive.close()
