"""The value of `MUJOCO_GL`: which OpenGL MuJoCo may use. Read here, never set."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

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
"""Values that choose an OpenGL platform → MuJoCo's module for it."""

GL_VARIABLES: Final = ("MUJOCO_GL", "PYOPENGL_PLATFORM")
"""Environment variables that choose an OpenGL platform."""


def gl_setting() -> str:
    """The value of `MUJOCO_GL` in lower case; empty if it is unset or unknown."""
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
    """An error of loading OpenGL in plain words: PyOpenGL raises errors of any kind."""
    if "'NoneType' object has no attribute" in message:
        return "its library is not installed"
    return message.strip().rstrip(".")
