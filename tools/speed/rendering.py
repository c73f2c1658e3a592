"""Panoramas of a whole house, beside the loop that one would write with `mujoco.Renderer`.

The loop renders every tile in every arrangement: it moves the agent and the object, and draws the
segmentation of four cameras. Its time is proportional to the number of tiles, so it only visits
some of them, and its time is divided by their share; the suite's renderers draw all.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import importlib.util
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from typing import Final
from unittest.mock import patch

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.houses.classes import class_id
from lcrl_bench.panoramas import CLASSES
from lcrl_bench.scenes.agent import CAMERAS
from lcrl_bench.scenes.agent import NAME as AGENT
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.mjcf import VISUAL
from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.scenes.panoramas import (
    PanoramaRenderer,
    describe_gl,
    movable_objects,
    open_renderer,
)
from lcrl_bench.scenes.panoramas.camera import VIEWS, eye_positions
from lcrl_bench.scenes.panoramas.context import open_context
from lcrl_bench.scenes.scene import Scene
from tools.speed.timing import Comparison, Variant

NAME: Final = "panoramas of a house"
TILES: Final = 6
"""Tiles that the loop visits."""
PIXEL_LIMIT: Final = 0.05
"""Reached if one in 800 pixels differs; rays and OpenGL round differently at edges."""
OUT_OF_SIGHT: Final = (0.0, 0.0, -100.0)
"""Where the loop puts an object that is held."""


@contextmanager
def panorama_comparison(scene: Scene, arrangements: Sequence[Arrangement]) -> Iterator[Comparison]:
    """All panoramas of a house: by a loop over `mujoco.Renderer`, by OpenGL and by rays.

    What is made once per house (the model, the renderer) is made before the clock starts.

    Args:
        scene: The house.
        arrangements: Where the moved object is.

    Yields:
        The comparison, while its renderers are open.

    Raises:
        EnvironmentMissingError: If there is no OpenGL here, or no Embree.
    """
    points = scene.grid.points
    some = np.unique(np.linspace(0, len(points) - 1, TILES).astype(int))
    movable = movable_objects(scene.house)

    def by(renderer: PanoramaRenderer) -> Callable[[], Sequence[torch.Tensor]]:
        def compute() -> Sequence[torch.Tensor]:
            drawn = renderer.render_arrangements(points, arrangements)
            return [_signs(np.stack([views[some] for views in drawn]))]

        return compute

    def naive() -> Sequence[torch.Tensor]:
        drawn = [loop.render(points[some], arrangement) for arrangement in arrangements]
        return [_signs(np.stack(drawn))]

    with ExitStack() as opened:
        drawing, casting = (
            opened.enter_context(
                open_renderer(scene.surfaces, scene.semantics, movable=movable, backend=backend)
            )
            for backend in ("gl", "rays")
        )
        loop = opened.enter_context(closing(_Loop(scene)))
        variants = (
            Variant("mujoco.Renderer in a loop", naive, share=len(some) / len(points)),
            Variant("OpenGL", by(drawing)),
            Variant("rays", by(casting)),
        )
        # OpenGL may draw in threads of its own.
        yield Comparison(NAME, variants, PIXEL_LIMIT, clock=time.process_time)


def _signs(views: NDArray[np.uint8]) -> torch.Tensor:
    """Pixels as eight signs each, random per class, so that any two classes are equally far."""
    signs = np.random.default_rng(0).choice(np.array([-1, 1], np.int8), (CLASSES, 8))
    return torch.from_numpy(signs[views])


def cannot_render() -> str:
    """Why the comparison can't be made here; empty if it can."""
    found = describe_gl()
    if found.backend is None:
        return f"{NAME}: no OpenGL here ({found.error})"
    missing = importlib.util.find_spec("embreex") is None
    return f"{NAME}: embreex is not installed (pip install embreex)" if missing else ""


class _Loop:
    """`mujoco.Renderer` and the agent's four cameras in the full scene of a house."""

    def __init__(self, scene: Scene) -> None:
        self._semantics = scene.semantics
        self._model = scene.model
        self._data = mujoco.MjData(self._model)
        self._options = mujoco.MjvOption()
        self._options.geomgroup[:] = 0
        self._options.geomgroup[VISUAL] = 1
        # Otherwise the renderer looks for a screen.
        contexts = mujoco.rendering.classic.renderer.gl_context
        with patch.object(contexts, "GLContext", open_context, create=True):
            self._renderer = mujoco.Renderer(
                self._model, self._semantics.view_height, self._semantics.view_width
            )
        self._renderer.enable_segmentation_rendering()
        # Both sides of a face are visible, as in the suite's renderers.
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 0
        self._classes = _classes_of_geoms(scene, self._model)

    def close(self) -> None:
        """Free its context."""
        self._renderer.close()

    def render(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        """[point, 4, height, width] class ids."""
        semantics, data = self._semantics, self._data
        views = np.zeros(
            (len(points), VIEWS, semantics.view_height, semantics.view_width), np.uint8
        )
        with self._arranged(arrangement):
            for index, (east, north, _) in enumerate(eye_positions(points, semantics)):
                data.mocap_pos[self._mocap(AGENT)] = (east, north, 0.0)
                mujoco.mj_kinematics(self._model, data)
                mujoco.mj_camlight(self._model, data)
                for view, camera in enumerate(CAMERAS):
                    self._renderer.update_scene(data, camera, self._options)
                    views[index, view] = self._classes[self._renderer.render()[..., 0]]
        return views

    @contextmanager
    def _arranged(self, arrangement: Arrangement) -> Iterator[None]:
        """Move the object inside the block."""
        if arrangement.hidden is None:
            yield
            return
        number, data = self._mocap(arrangement.hidden), self._data
        kept = data.mocap_pos[number].copy(), data.mocap_quat[number].copy()
        data.mocap_pos[number] = OUT_OF_SIGHT
        if (placed := arrangement.placed) is not None:
            data.mocap_pos[number] = placed.position
            data.mocap_quat[number] = (math.cos(placed.yaw / 2), 0, 0, math.sin(placed.yaw / 2))
        yield
        data.mocap_pos[number], data.mocap_quat[number] = kept

    def _mocap(self, body: str) -> int:
        return int(self._model.body(body).mocapid[0])


def _classes_of_geoms(scene: Scene, model: mujoco.MjModel) -> NDArray[np.uint8]:
    """[geom + 1]: class of each geom; the last is for -1, nothing."""
    labels = {surface.name: surface.label for surface in house_surfaces(scene.house)}
    labels |= {thing.id: thing.label for thing in scene.house.objects}
    classes = np.zeros(model.ngeom + 1, np.uint8)
    for number in range(model.ngeom):
        geom = model.geom(number)
        label = labels.get(geom.name) or labels.get(model.body(geom.bodyid[0]).name)
        classes[number] = class_id(label) if label else 0
    return classes
