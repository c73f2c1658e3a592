"""Which OpenGL can be used without a screen, and contexts of it.

Each way is tried once in a process of its own, because a missing library or a broken driver can
end a process and not only raise. `MUJOCO_GL` is honoured where it names a way to OpenGL, and is
never set here.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import logging
import os
import platform
import subprocess
import sys
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Protocol

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.forking import refuse_opengl_if_forked
from lcrl_bench.scenes.mujoco_import import (
    CHOICES,
    GL_VARIABLES,
    SWITCHED_OFF,
    failure_reason,
    gl_environment_kept,
    gl_setting,
)

_PROBE_SECONDS: Final = 60
_SOFTWARE: Final = ("llvmpipe", "softpipe", "swrast", "software", "swiftshader")

_logger = logging.getLogger(__name__)


class Context(Protocol):
    """An OpenGL context as MuJoCo's modules make them."""

    def make_current(self) -> None:
        """Draw with it from now on, in this thread."""

    def free(self) -> None:
        """Give it back."""


@dataclass(frozen=True)
class GlDescription:
    """What OpenGL this machine offers without a screen."""

    backend: str | None
    """`"egl"`, `"osmesa"`, `"glfw"` or `"cgl"`; None if none works."""
    renderer: str
    """The driver's own name (`GL_RENDERER`), `"llvmpipe (LLVM 15.0.6, 256 bits)"`."""
    software: bool
    """Whether the processor draws and no graphics card does."""
    error: str
    """Why none works, a sentence; empty if one does."""


@lru_cache(maxsize=1)
def describe_gl() -> GlDescription:
    """Try each way to OpenGL, once a process (about half a second for each way tried)."""
    setting = gl_setting()
    if setting in SWITCHED_OFF:
        return GlDescription(None, "", False, f"MUJOCO_GL={setting} switches OpenGL off.")
    backends = (CHOICES[setting],) if setting in CHOICES else _backends()
    failures = []
    for backend in backends:
        renderer, failure = _probe(backend)
        if renderer:
            software = any(word in renderer.lower() for word in _SOFTWARE)
            return GlDescription(backend, renderer, software, "")
        failures.append(f"{backend}: {failure}")
    return GlDescription(None, "", False, "; ".join(failures) + ".")


def open_context(width: int, height: int) -> Context:
    """An offscreen context whose buffer has at least this many pixels, current in this thread.

    Raises:
        EnvironmentMissingError: If no OpenGL works here.
        UsageError: In a forked process, where OpenGL may hang.
    """
    refuse_opengl_if_forked()
    found = describe_gl()
    if found.backend is None:
        raise EnvironmentMissingError(f"No OpenGL context can be started ({found.error}) {_ADVICE}")
    load_second_compilers()
    try:
        with gl_environment_kept():
            context = importlib.import_module(f"mujoco.{found.backend}").GLContext(width, height)
        context.make_current()
    except Exception as error:
        # PyOpenGL raises whatever it stumbles on; another library may have bound it to a screen.
        reason = f"{found.backend} works in a fresh process but not in this one: {error!r}"
        raise EnvironmentMissingError(f"No OpenGL context: {reason}. {_ADVICE}") from error
    return context


_ADVICE: Final = (
    "Install Debian's libegl1 and libgl1, or libosmesa6, or use --renderer rays, which needs no "
    "OpenGL."
)


def load_second_compilers() -> None:
    """Load triton before a context, where it is installed: PyTorch's CUDA builds bring it.

    Mesa's drivers load LLVM for the whole process, and triton brings an LLVM of its own. Loaded
    after a context was opened, triton takes functions of Mesa's LLVM for its own, and the process
    ends with a segmentation fault when torch imports it. Loaded before, each keeps its own.
    """
    if "triton" in sys.modules or importlib.util.find_spec("triton") is None:
        return
    try:
        importlib.import_module("triton")
    except Exception as error:
        # One that can't be imported can do no harm, and whoever needs it will say so.
        _logger.debug("triton can't be imported: %r", error)


def _backends() -> tuple[str, ...]:
    system = platform.system()
    if system == "Darwin":
        return ("cgl",)
    if system == "Windows":
        return ("glfw",)
    has_screen = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return ("egl", "osmesa", "glfw") if has_screen else ("egl", "osmesa")


def _probe(backend: str) -> tuple[str, str]:
    """The driver's name, or else why there is none."""
    environment = {name: text for name, text in os.environ.items() if name not in GL_VARIABLES}
    command = [sys.executable, "-m", "lcrl_bench.scenes.panoramas.probe", backend]
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=_PROBE_SECONDS
        )
    except subprocess.TimeoutExpired:
        return "", f"no answer within {_PROBE_SECONDS} s"
    if done.returncode < 0:
        return "", f"the driver ended its process with signal {-done.returncode}"
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        return "", failure_reason(lines[-1]) if lines else f"exit status {done.returncode}"
    return json.loads(done.stdout.splitlines()[-1])["renderer"], ""
