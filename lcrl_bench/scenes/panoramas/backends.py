"""Choice of the renderer: OpenGL if a graphics card draws it, else rays.

Rays give the same pixels and are two to three times as fast as OpenGL on the CPU. They also keep
the driver's compiler, LLVM, out of the process (see `context.load_second_compilers`).
"""

from __future__ import annotations

import importlib.util
import logging
from collections.abc import Sequence
from functools import lru_cache
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError, UnknownNameError
from lcrl_bench.forking import is_forked
from lcrl_bench.houses.classes import task_objects
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.scenes.panoramas.context import GlDescription, describe_gl
from lcrl_bench.scenes.panoramas.renderer import PanoramaRenderer
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

BACKENDS: Final = ("auto", "gl", "rays", "warp")
"""The renderers a user can choose."""

_logger = logging.getLogger(__name__)


def open_renderer(
    surfaces: Sequence[Surface],
    semantics: Semantics = DEFAULT_SEMANTICS,
    *,
    movable: Sequence[PlacedObject] = (),
    backend: str = "auto",
) -> PanoramaRenderer:
    """A renderer of one house's panoramas.

    Args:
        surfaces: Everything in the house, each object at its original place.
        semantics: Eye height, pitch, field of view and size of a view.
        movable: The objects an arrangement may hide or move, at their original places; see
            `movable_objects`.
        backend: `"gl"`, `"rays"`, `"warp"`, or `"auto"`: see `choose_backend`.

    Raises:
        UnknownNameError: If there is no such backend.
        EnvironmentMissingError: If the backend requested can't start here.
    """
    chosen = choose_backend(backend)
    if chosen == "gl":
        try:
            return _open_gl(surfaces, semantics, movable)
        except EnvironmentMissingError as error:
            if backend == "gl":
                raise
            _notice_fallback(str(error))
    if chosen == "warp":
        return _open_warp(surfaces, semantics, movable)
    return _open_rays(surfaces, semantics, movable)


def choose_backend(backend: str = "auto") -> str:
    """Resolve `backend` on this machine to `"gl"`, `"rays"` or `"warp"`.

    `"auto"`, which is never `"warp"`, follows `automatic_backend`, with a notice on stderr if no
    OpenGL works at all; in a forked process it is rays.

    Raises:
        UnknownNameError: If there is no such backend.
    """
    if backend not in BACKENDS:
        raise UnknownNameError("renderer", backend, BACKENDS)
    if backend != "auto":
        return backend
    if is_forked():
        # OpenGL inherited from a parent process hangs.
        return "rays"
    found = describe_gl()
    if found.backend is None:
        _notice_fallback(found.error)
    return automatic_backend(found)


def automatic_backend(found: GlDescription) -> str:
    """The meaning of `"auto"`: OpenGL if a graphics card draws it, else rays.

    Without Embree, OpenGL on the CPU is the fallback.
    """
    if found.backend is None:
        return "rays"
    has_rays = importlib.util.find_spec("embreex") is not None
    return "rays" if found.software and has_rays else "gl"


def movable_objects(house: House) -> tuple[PlacedObject, ...]:
    """The objects of a house that tasks may move: those of the 14 task classes."""
    classes = frozenset(task_objects())
    return tuple(thing for thing in house.objects if thing.label in classes)


def _open_gl(
    surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
) -> PanoramaRenderer:
    from lcrl_bench.scenes.panoramas.gl import GlRenderer

    return GlRenderer(surfaces, semantics, movable)


def _open_rays(
    surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
) -> PanoramaRenderer:
    try:
        from lcrl_bench.scenes.panoramas.rays import RayRenderer
    except ImportError as error:
        raise EnvironmentMissingError(
            f"Rays need Embree, which can't be imported ({error}). Run: pip install embreex"
        ) from error
    return RayRenderer(surfaces, semantics, movable)


def _open_warp(
    surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
) -> PanoramaRenderer:
    try:
        from lcrl_bench.scenes.panoramas.warp import WarpRenderer
    except ImportError as error:
        raise EnvironmentMissingError(
            f"The warp renderer needs MuJoCo Warp, which can't be imported ({error}). Run: "
            "pip install mujoco-warp (the extra [warp]), or use --renderer rays"
        ) from error
    return WarpRenderer(surfaces, semantics, movable)


@lru_cache(maxsize=1)
def _notice_fallback(reason: str) -> None:
    """Warn once per process."""
    _logger.warning("notice: rendering panoramas with rays, as OpenGL can't be used: %s", reason)
