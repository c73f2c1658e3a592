"""MuJoCo, imported whatever `MUJOCO_GL` says. All of the library takes it from here.

    from lcrl_bench.scenes.mujoco_import import mujoco

MuJoCo's own import reads `MUJOCO_GL`, loads that OpenGL, and fails where the value is unknown or
its library is missing, although most of MuJoCo needs no OpenGL.
"""

from __future__ import annotations

import importlib
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

SWITCHED_OFF: Final = frozenset({"disable", "disabled", "off", "false", "0"})
"""Values of `MUJOCO_GL`, in lower case, that mean no OpenGL."""
NO_CHOICE: Final = frozenset({"", "enable", "enabled", "on", "true", "1"})
"""Values that leave the choice to the program."""
CHOICES: Final = {
    "egl": "egl",
    "osmesa": "osmesa",
    "glfw": "glfw",
    "glx": "glfw",
    "wgl": "glfw",
    "cgl": "cgl",
}
"""Values that choose a way to OpenGL → MuJoCo's module for it."""

GL_VARIABLES: Final = ("MUJOCO_GL", "PYOPENGL_PLATFORM")
"""Environment variables that choose a way to OpenGL."""

_logger = logging.getLogger(__name__)


def gl_setting() -> str:
    """What `MUJOCO_GL` asks for, in lower case; empty where it is unset or a value nobody knows."""
    setting = os.environ.get("MUJOCO_GL", "").lower().strip()
    known = SWITCHED_OFF | NO_CHOICE | frozenset(CHOICES)
    return setting if setting in known else ""


@contextmanager
def gl_environment_kept() -> Iterator[None]:
    """Undo what importing MuJoCo's OpenGL modules does to the environment of child processes."""
    before = {name: os.environ.get(name) for name in GL_VARIABLES}
    try:
        yield
    finally:
        for name, text in before.items():
            if text is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = text


def failure_reason(message: str) -> str:
    """An error of loading OpenGL in plain words; PyOpenGL raises whatever it stumbles on."""
    if "'NoneType' object has no attribute" in message:
        return "its library is not installed"
    return message.strip().rstrip(".")


def _import_mujoco() -> None:
    """Import MuJoCo, with `MUJOCO_GL` set aside and a notice where it makes that impossible."""
    setting = os.environ.get("MUJOCO_GL", "")
    with gl_environment_kept():
        try:
            importlib.import_module("mujoco")
            return
        except Exception as error:
            if not setting:
                raise
            reason = failure_reason(" ".join(str(error).split()))
    with gl_environment_kept():
        for name in GL_VARIABLES:
            os.environ.pop(name, None)
        importlib.import_module("mujoco")
    _logger.warning(
        "notice: MuJoCo is imported without MUJOCO_GL=%s (%s). Unset it, or set one of: %s, off.",
        setting,
        reason,
        ", ".join(CHOICES),
    )


if TYPE_CHECKING:
    import mujoco
else:
    _import_mujoco()
    import mujoco

__all__ = [
    "CHOICES",
    "GL_VARIABLES",
    "NO_CHOICE",
    "SWITCHED_OFF",
    "failure_reason",
    "gl_environment_kept",
    "gl_setting",
    "mujoco",
]
