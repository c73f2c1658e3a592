"""The MuJoCo model for drawing alone: a mesh geom per merged mesh; nothing moves or collides."""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.scenes.panoramas.camera import FAR, NEAR
from lcrl_bench.scenes.panoramas.merged import MergedMesh


def drawing_spec(meshes: Sequence[MergedMesh]) -> mujoco.MjSpec:
    """The model before compilation; geoms have the numbers of the meshes.

    Args:
        meshes: What can be seen.
    """
    spec = mujoco.MjSpec()
    spec.stat.extent = 1.0
    spec.visual.map.znear, spec.visual.map.zfar = NEAR, FAR
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
    return spec
