"""Panoramas: the four semantic views from a standing point, by OpenGL or by rays."""

from lcrl_bench.scenes.panoramas.backends import (
    BACKENDS,
    automatic_backend,
    choose_backend,
    movable_objects,
    open_renderer,
)
from lcrl_bench.scenes.panoramas.context import GlDescription, describe_gl
from lcrl_bench.scenes.panoramas.renderer import (
    RENDERER_VERSION,
    PanoramaRenderer,
    time_panoramas,
)

__all__ = [
    "BACKENDS",
    "RENDERER_VERSION",
    "GlDescription",
    "PanoramaRenderer",
    "automatic_backend",
    "choose_backend",
    "describe_gl",
    "movable_objects",
    "open_renderer",
    "time_panoramas",
]
