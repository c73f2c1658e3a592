"""Meshes of furniture and objects: what each of the classes looks like in a box of any size."""

from lcrl_bench.scenes.shapes.catalogue import (
    collision_parts,
    object_parts,
    shape_count,
    shaped_labels,
)
from lcrl_bench.scenes.shapes.primitives import Part

__all__ = ["Part", "collision_parts", "object_parts", "shape_count", "shaped_labels"]
