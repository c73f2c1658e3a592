"""Headless OpenGL: which platforms work here, and contexts for them.

Each platform is tried once in a separate process, because a missing library or a broken driver
may kill a process rather than raise. `MUJOCO_GL` is honoured if it names a platform, and is never
set here.
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
from lcrl_bench.scenes.gl_setting import (
    CHOICES,
    GL_VARIABLES,
    SWITCHED_OFF,
    failure_reason,
    gl_environment_kept,
    gl_setting,
)

_PROBE_SECONDS: Final = 60
_SOFTWARE: Final = (
    *("llvmpipe", "softpipe", "swrast", "software", "swiftshader"),
    *("gdi generic", "basic render"),
)
"""Substrings, in lower case, of the names of drivers that draw on the CPU."""

_logger = logging.getLogger(__name__)


class Context(Protocol):
    """An OpenGL context as created by MuJoCo's modules."""

    def make_current(self) -> None:
        """Make it current in this thread."""

    def free(self) -> None:
        """Release it."""


@dataclass(frozen=True)
class GlDescription:
    """The headless OpenGL available on this machine."""

    backend: str | None
    """`"egl"`, `"osmesa"`, `"glfw"` or `"cgl"`; None if none works."""
    renderer: str
    """The driver's name (`GL_RENDERER`), such as `"llvmpipe (LLVM 15.0.6, 256 bits)"`."""
    software: bool
    """Whether the CPU draws rather than a graphics card."""
    error: str
    """Why none works, as a sentence; empty if one does."""


@lru_cache(maxsize=1)
def describe_gl() -> GlDescription:
    """Try each OpenGL platform, once per process (about half a second per platform)."""
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
    chosen = f", as chosen by MUJOCO_GL={setting}" if setting in CHOICES else ""
    return GlDescription(None, "", False, "; ".join(failures) + chosen + ".")


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
            # Left over from another project, it would rule out the platform found to work.
            os.environ.pop("PYOPENGL_PLATFORM", None)
            context = importlib.import_module(f"mujoco.{found.backend}").GLContext(width, height)
        context.make_current()
    except Exception as error:
        # PyOpenGL raises errors of any kind; another library may have bound it to a screen.
        reason = f"{found.backend} works in a fresh process but not in this one: {error!r}"
        raise EnvironmentMissingError(f"No OpenGL context: {reason}. {_ADVICE}") from error
    return context


_ADVICE: Final = (
    "Install Debian's libegl1 and libgl1, or libosmesa6, or use --renderer rays, which needs no "
    "OpenGL."
)


def load_second_compilers() -> None:
    """Load triton before any context, if it is installed (PyTorch's CUDA builds include it).

    Mesa's drivers load LLVM for the whole process, and triton bundles its own LLVM. If triton is
    loaded after a context is opened, it picks up symbols of Mesa's LLVM, and the process crashes
    with a segmentation fault when torch imports it. If it is loaded first, each uses its own.
    """
    if "triton" in sys.modules or importlib.util.find_spec("triton") is None:
        return
    try:
        importlib.import_module("triton")
    except Exception as error:
        # If it can't be imported, it does no harm, and its users will report it.
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
    """The driver's name, and the reason if there is none."""
    environment = {name: text for name, text in os.environ.items() if name not in GL_VARIABLES}
    command = [sys.executable, "-m", "lcrl_bench.scenes.panoramas.probe", backend]
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=_PROBE_SECONDS
        )
    except subprocess.TimeoutExpired:
        return "", f"no answer within {_PROBE_SECONDS} s"
    if done.returncode < 0:
        return "", f"the driver's process was killed by signal {-done.returncode}"
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        return "", failure_reason(lines[-1]) if lines else f"exit status {done.returncode}"
    return json.loads(done.stdout.splitlines()[-1])["renderer"], ""
