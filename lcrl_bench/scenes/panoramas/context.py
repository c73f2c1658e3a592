"""Which OpenGL can be used without a screen, and contexts of it.

Each way is tried once in a process of its own, because a missing library or a broken driver can
end a process and not only raise. `MUJOCO_GL` is honoured where the user set it and is never set
here.
"""

from __future__ import annotations

import importlib
import json
import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Protocol

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.forking import refuse_opengl_if_forked

_PROBE_SECONDS: Final = 60
_SWITCHED_OFF: Final = frozenset({"disable", "disabled", "off", "false", "0"})
_NO_CHOICE: Final = frozenset({"", "enable", "enabled", "on", "true", "1"})
_KNOWN: Final = ("egl", "osmesa", "glfw", "cgl")
_SOFTWARE: Final = ("llvmpipe", "softpipe", "swrast", "software", "swiftshader")
_ENVIRONMENT: Final = ("MUJOCO_GL", "PYOPENGL_PLATFORM")


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
    chosen = os.environ.get("MUJOCO_GL", "").lower().strip()
    if chosen in _SWITCHED_OFF:
        return GlDescription(None, "", False, f"MUJOCO_GL={chosen} switches OpenGL off.")
    if chosen not in _NO_CHOICE and chosen not in _KNOWN:
        return GlDescription(None, "", False, f"MUJOCO_GL={chosen} is none of {', '.join(_KNOWN)}.")
    backends = _backends() if chosen in _NO_CHOICE else (chosen,)
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
    try:
        with _environment_kept():
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
    environment = {name: text for name, text in os.environ.items() if name not in _ENVIRONMENT}
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
        if lines and "'NoneType' object has no attribute" in lines[-1]:
            # PyOpenGL's way of saying that it found no such library.
            return "", "its library is not installed"
        return "", lines[-1].rstrip(".") if lines else f"exit status {done.returncode}"
    return json.loads(done.stdout.splitlines()[-1])["renderer"], ""


@contextmanager
def _environment_kept() -> Iterator[None]:
    """Undo what importing MuJoCo's context modules does to the environment of child processes."""
    before = {name: os.environ.get(name) for name in _ENVIRONMENT}
    try:
        yield
    finally:
        for name, text in before.items():
            if text is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = text
