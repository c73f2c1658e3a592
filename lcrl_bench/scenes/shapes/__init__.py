"""Meshes of furniture and objects: shapes for each class that fill a box of any size."""

from lcrl_bench.scenes.shapes.catalogue import (
    collision_parts,
    object_parts,
    shape_count,
    shaped_labels,
)
from lcrl_bench.scenes.shapes.primitives import Part

__all__ = ["Part", "collision_parts", "object_parts", "shape_count", "shaped_labels"]
