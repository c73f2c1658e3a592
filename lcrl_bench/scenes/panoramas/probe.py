"""Start one OpenGL context, draw a triangle mesh with it and print the renderer's name as JSON.

Run as `python -m lcrl_bench.scenes.panoramas.probe egl`, in a separate process: a broken driver
may kill it, and PyOpenGL can bind to only one platform per process.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import importlib
import json
import sys

from lcrl_bench.scenes.mujoco_import import mujoco

_SCENE = '<mujoco><worldbody><geom type="box" size="1 1 1"/></worldbody></mujoco>'


def main(backend: str) -> None:
    """Print `{"renderer": ...}`; any failure ends the process with a traceback."""
    context = importlib.import_module(f"mujoco.{backend}").GLContext(64, 64)
    context.make_current()
    model = mujoco.MjModel.from_xml_string(_SCENE)
    drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, drawing)
    scene = mujoco.MjvScene(model, maxgeom=1)
    mujoco.mjr_render(mujoco.MjrRect(0, 0, 64, 64), scene, drawing)
    if drawing.currentBuffer != mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value:
        raise RuntimeError("the driver has no offscreen buffers")
    # Imported late: PyOpenGL binds to the platform that the context's module chose.
    from OpenGL import GL

    name = GL.glGetString(GL.GL_RENDERER).decode()
    drawing.free()
    context.free()
    print(json.dumps({"renderer": name}))


if __name__ == "__main__":
    main(sys.argv[1])
